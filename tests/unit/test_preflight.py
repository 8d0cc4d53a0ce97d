"""Ports that cannot be had are found before anything is started."""

import socket

import pytest

from models.config.site import SITE_VERSION, BusConfig, CameraConfig, Site, TabletConfig
from models.errors import UserError
from services.supervisor.preflight import require_ports
from tests.ports import free_port


def site(page_host: str, page_port: int, bus_port: int) -> Site:
    return Site(
        version=SITE_VERSION,
        name="Test gym",
        calibration="rig.toml",
        cameras=[CameraConfig(name=name, kind="video", path=f"{name}.avi") for name in "ab"],
        bus=BusConfig(endpoint=f"tcp/127.0.0.1:{bus_port}"),
        tablet=TabletConfig(host=page_host, port=page_port),
    )


def test_ports_that_are_free_are_free_again_afterwards() -> None:
    page, bus = free_port(), free_port()
    for _ in range(2):
        require_ports(site("127.0.0.1", page, bus))


@pytest.mark.parametrize("page_host", ["127.0.0.1", "0.0.0.0"])  # noqa: S104 - as site files have it
def test_one_port_for_page_and_bus_is_refused_with_both_keys(page_host: str) -> None:
    port = free_port()
    with pytest.raises(UserError, match=rf"^port {port} is both .* change tablet\.port or bus\.endpoint in the site file$"):
        require_ports(site(page_host, port, port))


@pytest.mark.parametrize("host", ["nosuch.invalid", "192.0.2.99", "192.168..5"])
def test_a_page_whose_address_is_none_is_not_blamed_on_its_port(host: str) -> None:
    with pytest.raises(
        UserError, match=rf"^port of the page: '{host}' is no address of this machine \(.*\); change tablet\.host in"
    ):
        require_ports(site(host, free_port(), free_port()))


def test_a_port_that_is_taken_is_told_with_the_lines_that_name_another_one() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(
            UserError, match=rf"change tablet\.port in the site file \(\[tablet\], and below it port = {port + 1}\)$"
        ):
            require_ports(site("127.0.0.1", port, free_port()))
        endpoint = rf'"tcp/127\.0\.0\.1:{port + 1}"'
        with pytest.raises(UserError, match=rf"bus\.endpoint in the site file \(\[bus\], and below it endpoint = {endpoint}\)$"):
            require_ports(site("127.0.0.1", free_port(), port))


def test_a_bus_whose_port_somebody_else_has_is_not_blamed_on_the_page() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(UserError, match=rf"^port of the bus: {port} on 127\.0\.0\.1 cannot be used"):
            require_ports(site("127.0.0.2", port, port))
