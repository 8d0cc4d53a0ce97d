"""A site file that cannot be read says what to do about that very fault."""

import pytest

from models.camera.rig import decode_rig
from models.config.site import decode_site
from models.errors import UserError


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        ('version = 2\nname = "Gym\ncalibration = "rig.toml"\n', "a quote is not closed in that line, or before it; close it"),
        ('version = 2\nname = "Gym', "a quote is not closed in that line, or before it; close it"),
        ("version = 2\nname = 'Gym", "a quote is not closed in that line, or before it; close it"),
        (
            "version = 2\n[[cameras]\n",
            "it is no TOML there; look for a quote, bracket, value or equals sign that is missing, and correct it",
        ),
        (
            "version = 2\nname Gym\n",
            "it is no TOML there; look for a quote, bracket, value or equals sign that is missing, and correct it",
        ),
        ("version = 2\nname = 3\n", "see docs/configuration.md for every key"),
        ('version = "2"\n', "see docs/configuration.md for every key"),
    ],
)
def test_the_remedy_fits_the_fault(text: str, remedy: str) -> None:
    with pytest.raises(UserError) as error:
        decode_site(text.encode(), "site.toml")
    assert str(error.value).startswith("site file site.toml: ")
    assert str(error.value).endswith(f"; {remedy}")
    assert "\n" not in str(error.value)


NO_HOSTS = ["", ".", "192.168..5", "a" * 64, "a." * 150, "a\\u0000b", "ü" * 60]
"""As TOML writes them."""


@pytest.mark.parametrize("host", NO_HOSTS)
def test_a_page_s_host_that_nothing_could_be_looked_up_by_is_named_without_a_network(host: str) -> None:
    with pytest.raises(
        UserError, match=r"^site file site\.toml: tablet\.host is no name and no address of a machine: .*; correct it$"
    ):
        decode_site(f'{GOOD}[tablet]\nhost = "{host}"\n'.encode(), "site.toml")


@pytest.mark.parametrize("host", [host for host in NO_HOSTS if host])
def test_so_is_the_bus_s(host: str) -> None:
    with pytest.raises(UserError, match=r"^site file site\.toml: bus\.endpoint is no name and no address of a machine: "):
        decode_site(f'{GOOD}[bus]\nendpoint = "tcp/{host}:7447"\n'.encode(), "site.toml")


@pytest.mark.parametrize("host", ["::1", "fe80::1%eth0", "0.0.0.0", "gym-box.local", "gym-box.local.", "turnhalle-süd"])  # noqa: S104
def test_a_host_that_may_be_one_is_left_to_the_network(host: str) -> None:
    text = f'{GOOD}[tablet]\nhost = "{host}"\n[bus]\nendpoint = "tcp/[{host}]:7447"\n'
    assert decode_site(text.encode(), "site.toml").tablet.host == host


DIGITS = "9" * 5000
GOOD = 'version = 2\nname = "Gym"\ncalibration = "rig.toml"\n' + "".join(
    f'[[cameras]]\nname = "{name}"\nkind = "video"\npath = "{name}.avi"\n' for name in "ab"
)


def test_the_site_of_these_tests_is_good_but_for_what_they_change() -> None:
    assert decode_site(GOOD.encode(), "site.toml").name == "Gym"


@pytest.mark.parametrize(
    "text",
    [
        f"version = {DIGITS}\n",
        f"version = {DIGITS[:400]}\n",
        f"version = 2\n[tablet]\nport = {DIGITS}\n",
        f"{GOOD}[inference]\ncpu_target = {DIGITS[:400]}\n",
        f'{GOOD}[bus]\nendpoint = "tcp/127.0.0.1:{DIGITS}"\n',
    ],
)
def test_a_number_of_thousands_of_digits_is_an_error_like_any_other(text: str) -> None:
    with pytest.raises(UserError, match=r"^site file site\.toml: ") as error:
        decode_site(text.encode(), "site.toml")
    assert len(str(error.value)) < 1000


@pytest.mark.parametrize("digits", [400, 5000])
def test_so_is_one_in_a_calibration(digits: int) -> None:
    camera = (
        f'[[camera]]\nname = "a"\nsize_px = [640, 480]\nmatrix_px = [[{DIGITS[:digits]}, 0, 320], [0, 600, 240], [0, 0, 1]]\n'
        "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\ntranslation_m = [0, 0, 3]\n"
    )
    with pytest.raises(UserError, match=r"^calibration rig\.toml: "):
        decode_rig(f"version = 1\n{camera}".encode(), "rig.toml")


PATHS = {
    "calibration": GOOD.replace("rig.toml", "PATH"),
    "camera 'b': path": GOOD.replace("b.avi", "PATH"),
    "lessons.folder": f'{GOOD}[lessons]\nfolder = "PATH"\n',
    "evaluation.teaching": f'{GOOD}[evaluation]\nteaching = "PATH"\n',
}


@pytest.mark.parametrize("key", PATHS)
@pytest.mark.parametrize("path", ["\\u0000", "rigs/a\\u0000b.toml", "ü" * 128, "d/" * 3000], ids=["NUL", "in it", "name", "whole"])
def test_a_path_that_no_disk_could_have_is_named_by_its_key(key: str, path: str) -> None:
    with pytest.raises(UserError, match=rf"^site file site\.toml: {key} is no path: ") as error:
        decode_site(PATHS[key].replace("PATH", path).encode(), "site.toml")
    assert len(str(error.value)) < 200


@pytest.mark.parametrize("key", PATHS)
def test_a_path_in_any_script_may_be_one(key: str) -> None:
    decode_site(PATHS[key].replace("PATH", "/srv/校准/../ü/" + "d" * 255).encode(), "site.toml")


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ("rate_hz = 25", "leave out `rate_hz` - at"),
        ("shutter_delay_ms = 3", "leave out `shutter_delay_ms` - at"),
        ("rate_hz = 25\nshutter_delay_ms = 3", "leave out `rate_hz` and `shutter_delay_ms` - at"),
    ],
)
def test_of_a_simulated_camera_only_the_keys_that_it_has_are_named(keys: str, named: str) -> None:
    text = GOOD.replace('kind = "video"\npath = "a.avi"\n', f'kind = "simulated"\npath = "a"\n{keys}\n')
    with pytest.raises(UserError, match=named):
        decode_site(text.encode(), "site.toml")
