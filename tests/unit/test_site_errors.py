"""A site file that cannot be read says what to do about that very fault."""

import tomllib

import pytest
from msgspec.structs import fields

from models.camera.rig import decode_rig
from models.config.site import Section, Site, decode_site
from models.config.wrong_key import wrong_key
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
        ("rate_hz = 25", "leave out `rate_hz`$"),
        ("shutter_delay_ms = 3", "leave out `shutter_delay_ms`$"),
        ("rate_hz = 25\nshutter_delay_ms = 3", "leave out `rate_hz` and `shutter_delay_ms`$"),
    ],
)
def test_of_a_simulated_camera_only_the_keys_that_it_has_are_named(keys: str, named: str) -> None:
    text = GOOD.replace('kind = "video"\npath = "a.avi"\n', f'kind = "simulated"\npath = "a"\n{keys}\n')
    with pytest.raises(UserError, match=named):
        decode_site(text.encode(), "site.toml")


CAMERA_B = 'name = "b"\nkind = "video"\npath = "b.avi"\n'
CORRECT = "correct it, or see docs/configuration.md for every key"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (f"{GOOD}[inferense]\n", f"inferense: there is no such key (the nearest is 'inference'); {CORRECT}"),
        (f"{GOOD}[logs]\nmax_flies = 3\n", f"[logs] max_flies: there is no such key (the nearest is 'max_files'); {CORRECT}"),
        (
            GOOD.replace(CAMERA_B, f"{CAMERA_B}fps = 30\n"),
            '[[cameras]] no. 2 ("b") fps: there is no such key (there are name, kind, path, rate_hz, shutter_delay_ms); ' + CORRECT,
        ),
        (
            GOOD.replace(CAMERA_B, f"{CAMERA_B}rate_hz = 500\n"),
            '[[cameras]] no. 2 ("b") rate_hz: found 500, but allowed is a number of more than 0 and at most 240; correct it',
        ),
        (
            GOOD.replace('path = "b.avi"\n', ""),
            "[[cameras]] no. 2 (\"b\") key 'path' is missing; add it (allowed is text in quotes, not empty)",
        ),
        (
            f'{GOOD}[tablet]\nport = "80"\n',
            '[tablet] port: found "80", but allowed is a whole number of at least 1 and at most 65535; correct it',
        ),
        (
            f'{GOOD}[evaluation]\nlanguage = "fr"\n',
            '[evaluation] language: found "fr", but allowed is "de", "en", "es" or "zh"; correct it',
        ),
        (
            f'{GOOD}[bus]\nendpoint = "udp/a"\n',
            '[bus] endpoint: found "udp/a", but allowed is "tcp/ADDRESS:PORT", as "tcp/127.0.0.1:7447"; correct it',
        ),
        (
            GOOD.replace('"a"', '"Cam A"'),
            '[[cameras]] no. 1 ("Cam A") name: found "Cam A", but allowed is a name of 1 to 32 lower-case letters, digits, - '
            "and _, which begins with a letter or digit; correct it",
        ),
        (f'{GOOD}[lessons]\nautomatic = "yes"\n', '[lessons] automatic: found "yes", but allowed is true or false; correct it'),
        ("version = 2\nname = 3\n", "name: found 3, but allowed is text of 1 to 80 characters; correct it"),
        ('version = "2"\n', 'version: found "2", but allowed is a whole number of at least 1; correct it'),
        ('name = "Gym"\n', "key 'version' is missing; add it (allowed is a whole number of at least 1)"),
        (f"tablet = 3\n{GOOD}", "tablet: found 3, but allowed is a table [tablet]; correct it"),
        (
            f'{GOOD}[[faults]]\ncamera = "a"\nkind = "late"\nat_s = 1\nfor_s = 2\nby_s = 9\n',
            "[[faults]] no. 1: a fault of kind late needs by_s of more than 0 and at most 5; correct it",
        ),
    ],
)
def test_a_wrong_key_is_told_in_the_words_of_the_file(text: str, line: str) -> None:
    with pytest.raises(UserError) as error:
        decode_site(text.encode(), "site.toml")
    assert str(error.value) == f"site file site.toml: {line}"


@pytest.mark.parametrize("value", ["0x" + "f" * 5000, '"' + "x" * 500 + '"', "2026-11-23", "nan", "[1, 2]", "{a = 1}"])
def test_whatever_toml_can_hold_is_told_shortly(value: str) -> None:
    with pytest.raises(UserError, match=r"\[tablet\] port: found .*, but allowed is a whole number") as error:
        decode_site(f"{GOOD}[tablet]\nport = {value}\n".encode(), "site.toml")
    assert len(str(error.value)) < 200


SECTIONS = [section for section in fields(Site) if isinstance(section.default, Section)]
KEYS = [(section.name, field.name) for section in SECTIONS for field in fields(type(section.default))]


@pytest.mark.parametrize(("section", "key"), KEYS, ids=".".join)
def test_no_key_is_without_words_for_what_it_may_be(section: str, key: str) -> None:
    words = wrong_key(tomllib.loads(GOOD) | {section: {key: [[]]}}, Site)
    assert words.startswith(f"[{section}] {key}: found a list of 1, but allowed is ")
    assert f"a table [{key}]" not in words
