"""What is wrong with a site is said in one line before anything is started: the real `kinebox run`, the edge's real checks."""

import re
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from models.config.site import SITE_VERSION
from tests.integration.box import CAMERA, ROOT, fake_parts
from tests.integration.house import CALIBRATED_PX, House, build_house, describe, replace_text
from tests.small_video import write_video

pytestmark = pytest.mark.slow


@pytest.fixture
def house(tmp_path: Path) -> House:
    return build_house(tmp_path)


def _truncate(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-10])


def _longer_video(house: House) -> None:
    write_video(house.videos / "b.avi", frames=4, size_px=CALIBRATED_PX)
    describe(house)


def _smaller_video(house: House) -> None:
    write_video(house.videos / "b.avi", frames=3, size_px=(320, 240))
    describe(house)


def _undescribed_smaller_video(house: House) -> None:
    _smaller_video(house)
    (house.videos / "installed.json").unlink()


def _folder_in_place_of(file: Path) -> None:
    file.unlink()
    file.mkdir()


def _undescribed_garbage(house: House) -> None:
    (house.videos / "installed.json").unlink()
    (house.videos / "a.avi").write_bytes(b"no video at all" * 100)


FAULTS: dict[str, tuple[Callable[[House], object], str]] = {
    "the site file is missing": (lambda house: house.site.unlink(), r"site file .*site\.toml does not exist; correct"),
    "the site file is no TOML": (
        lambda house: house.site.write_text("name = "),
        r"site file .*site\.toml: .*it is no TOML there; look for",
    ),
    "a key is unknown": (
        lambda house: replace_text(house.site, "[tablet]\n", "[tablet]\nspeling = 1\n"),
        r"site file .*tablet.*speling.*see docs/configuration",
    ),
    "a value is out of bounds": (
        lambda house: replace_text(house.site, "[tablet]\n", "[inference]\ncpu_target = 7.0\n[tablet]\n"),
        r"site file .*cpu_target: found 7\.0, but allowed is a number of more than 0\.1 and at most 0\.95; correct it",
    ),
    "the site is of a newer version": (
        lambda house: replace_text(house.site, f"version = {SITE_VERSION}", "version = 99"),
        r"site file .*version 99 is for a newer KineBox .*'kinebox version'.*update KineBox, or put back .*site\.toml\.bak-",
    ),
    "the site is of an older version": (
        lambda house: replace_text(house.site, f"version = {SITE_VERSION}", "version = 1"),
        r"site file .*version 1 is from an older KineBox; run 'kinebox config migrate .*site\.toml'",
    ),
    "the calibration is missing": (lambda house: house.rig.unlink(), r"calibration .*rig\.toml does not exist; correct"),
    "the calibration lacks a camera": (
        lambda house: replace_text(house.rig, 'name = "b"', 'name = "z"'),
        r"camera 'b' is not in the calibration, which knows a, z; calibrate it or correct",
    ),
    "the calibration names an unknown camera": (
        lambda house: house.rig.write_text(house.rig.read_text() + CAMERA.format(name="z", x_m=2.0)),
        r"calibration .*rig\.toml: camera 'z' is not in the site file .*, which has a, b; add it",
    ),
    "a rotation is none": (
        lambda house: replace_text(house.rig, "rotation = [[1.0,", "rotation = [[1.1,"),
        r"calibration .*rig\.toml: camera 'a': rotation is not a rotation matrix .*calibrate this camera again",
    ),
    "a rotation mirrors": (
        lambda house: replace_text(house.rig, "rotation = [[1.0,", "rotation = [[-1.0,"),
        r"calibration .*rig\.toml: camera 'a': rotation is not a rotation matrix .*det -1",
    ),
    "a video is missing": (lambda house: (house.videos / "b.avi").unlink(), r"camera 'b': .*b\.avi is missing; correct"),
    "a video is truncated": (
        lambda house: _truncate(house.videos / "b.avi"),
        r"camera 'b': .*b\.avi has \d+ bytes instead of \d+; delete .*installed\.json and run `make footage SOURCE=footage DATA=",
    ),
    "a video is none": (_undescribed_garbage, r"camera 'a': .*a\.avi is not a video that can be read .*copy or prepare it again"),
    "a video lasts longer than the others": (
        _longer_video,
        r"camera 'b': .*b\.avi lasts 0\.133 s \(4 pictures at 30 Hz\), but .* camera 'a', .*a\.avi, 0\.100 s .*; cut the videos",
    ),
    "a video is played at another rate": (
        lambda house: replace_text(house.site, 'path = "footage/b.avi"\n', 'path = "footage/b.avi"\nrate_hz = 25.0\n'),
        r"camera 'b': .*b\.avi lasts 0\.120 s \(3 pictures at 25 Hz\), .*0\.100 s .*correct `rate_hz`",
    ),
    "a video has pictures of another size": (
        _smaller_video,
        r"camera 'b': the pictures of .*b\.avi are 320x240, but the calibration is for 640x480; scale",
    ),
    "a video that nobody described has pictures of another size": (
        _undescribed_smaller_video,
        r"camera 'b': the pictures of .*b\.avi are 320x240, but the calibration is for 640x480; scale",
    ),
    "a video's path cannot even be looked up": (
        lambda house: replace_text(house.site, "footage/b.avi", f"{'b' * 300}.avi"),
        r"site file .*site\.toml: camera 'b': path is no path: .*; shorten it",
    ),
    "the list of networks cannot be read": (
        lambda house: _folder_in_place_of(house.networks / "installed.json"),
        r"network movenet-thunder: .*installed\.json cannot be read \(Is a directory\); delete .* and run `make networks DATA=",
    ),
    "no network is installed": (
        lambda house: shutil.rmtree(house.networks),
        r"network movenet-thunder: .*run `make networks DATA=",
    ),
    "a network is missing": (
        lambda house: (house.networks / "nanodet.onnx").unlink(),
        r"network nanodet: .*nanodet\.onnx is missing; delete .* and run `make networks DATA=",
    ),
    "a network has a wrong hash": (
        lambda house: (house.networks / "movenet-lightning.onnx").write_bytes(b"other"),
        r"network movenet-lightning: .*movenet-lightning\.onnx is damaged .*delete .* and run `make networks DATA=",
    ),
    "the page's address is none": (
        lambda house: replace_text(house.site, 'host = "127.0.0.1"', 'host = "192.0.2.99"'),
        r"port of the page: .*192\.0\.2\.99.* is no address of this machine .*change tablet\.host",
    ),
    "the page's address can be none": (
        lambda house: replace_text(house.site, 'host = "127.0.0.1"', 'host = "192.168..5"'),
        r"site file .*site\.toml: tablet\.host is no name and no address of a machine: .*; correct it",
    ),
    "the bus's address can be none": (
        lambda house: replace_text(house.site, "tcp/127.0.0.1:", "tcp/.:"),
        r"site file .*site\.toml: bus\.endpoint is no name and no address of a machine: .*; correct it",
    ),
    "the bus has no port": (
        lambda house: replace_text(house.site, f"tcp/127.0.0.1:{house.bus_port}", "tcp/127.0.0.1:99999"),
        r"port of the bus: 99999 is no port .*change bus\.endpoint",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_the_fault_is_named_with_what_to_do_and_nothing_is_started(house: House, fault: str) -> None:
    break_it, line = FAULTS[fault]
    break_it(house)
    require_refusal(house, line)


@pytest.mark.parametrize(("what", "key"), [("page", r"tablet\.port"), ("bus", r"bus\.endpoint")])
def test_a_port_that_is_taken_is_named_and_nothing_is_started(house: House, what: str, key: str) -> None:
    port = house.page_port if what == "page" else house.bus_port
    with socket.create_server(("127.0.0.1", port)):
        require_refusal(
            house, rf"port of the {what}: {port} on 127\.0\.0\.1 cannot be used \(.*in use\); stop what .* change {key}"
        )


def require_refusal(house: House, line: str) -> None:
    """The run says exactly one line, which matches, leaves with code 2 and has started nothing."""
    result = house.run()
    assert re.fullmatch(rf"kinebox: .*{line}.*\n", result.stderr), result.stderr
    assert result.stdout == ""
    assert result.returncode == 2
    assert not (house.data / "starts").exists()
    assert not (house.data / "logs").exists()


def test_without_a_fault_the_same_house_starts(house: House) -> None:
    """Else every refusal above might be for another reason than the one it names."""
    command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(house.site), "--data", str(house.data)]
    environment = fake_parts(house.folder, check="edge.check:check")
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT) as box:
        assert box.stdout is not None
        assert any("Test gym is running" in line for line in box.stdout)
        box.terminate()
        assert box.wait(60.0) == 0
