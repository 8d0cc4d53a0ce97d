"""Everything that can be checked before a process is started, so that nothing is ever half started."""

import socket
from collections.abc import Callable, Iterable
from pathlib import Path

from models.camera.rig import Rig
from models.config.site import Site
from models.errors import UserError
from services.support.site_files import read_site

Check = Callable[[Site, Rig, Path], None]


def check_everything(site_file: Path, data: Path, checks: Iterable[Check]) -> Site:
    """Read the site and check what it needs: what the parts say, then the ports.

    Args:
        site_file: the site file.
        data: folder with networks and footage.
        checks: what the parts want checked; each raises UserError.

    Raises:
        UserError: the first fault found.
    """
    site, rig = read_site(site_file)
    for check in checks:
        check(site, rig, data)
    require_free(site.tablet.host, site.tablet.port, "port of the page", "tablet.port")
    require_free(*_host_and_port(site.bus.endpoint), "port of the bus", "bus.endpoint")
    return site


def require_free(host: str, port: int, what: str, key: str) -> None:
    """Raise UserError unless `port` can be listened on at `host`; `key` of the site file is what to change."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except OSError as error:
        raise UserError(
            f"{what}: '{host}' is no address of this machine ({error.strerror}); change {key} in the site file"
        ) from error
    with socket.socket(family, kind, protocol) as probe:
        # As the servers do it: connections that are only closing do not count.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(address)
        except OSError as error:
            raise UserError(
                f"{what}: {port} on {host} cannot be used ({error.strerror}); stop what uses it, perhaps another KineBox, "
                f"or change {key} in the site file"
            ) from error


def _host_and_port(endpoint: str) -> tuple[str, int]:
    host, _, port = endpoint.removeprefix("tcp/").rpartition(":")
    if not 0 < int(port) < 2**16:
        raise UserError(f"port of the bus: {port} is no port (1 to 65535); change bus.endpoint in the site file")
    return host.strip("[]"), int(port)
