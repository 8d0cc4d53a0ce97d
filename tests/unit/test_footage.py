"""The built-in footage is prepared once, whole, and found out when somebody touched it."""

import io
import zipfile
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from edge.cameras.shape import read_avi_shape
from edge.cameras.video import load_video
from edge.footage import prepare as footage
from edge.footage.index import Index
from edge.footage.sets import CALIBRATION, CAMERAS, FOOTAGES, Footage
from edge.footage.transcode import SIZE_PX, picture_rows, transcode
from models.arrays import UInt8
from models.errors import UserError

FRAMES = 3


def barred_picture(width: int = 540, height: int = 960, bar: int = 20) -> UInt8:
    picture = np.full((height, width, 3), 120, np.uint8)
    picture[:bar] = picture[height - bar :] = 4
    picture[bar : bar + 10] = 250
    return picture


def video_bytes(picture: UInt8, frames: int = FRAMES) -> bytes:
    sink = io.BytesIO()
    with av.open(sink, "w", format="mp4") as container:
        stream = container.add_stream("mpeg4", rate=Fraction(60))
        stream.width, stream.height, stream.bit_rate = picture.shape[1], picture.shape[0], 8_000_000
        for _ in range(frames):
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="bgr24")))
        container.mux(stream.encode())
    return sink.getvalue()


class Registry:
    """Stands in for the package registry and counts what is fetched."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.fetched = 0
        self.cameras = list(CAMERAS)
        self.video = video_bytes(barred_picture())
        monkeypatch.setattr("models.networks.build.registry.fetch_pypi", self.fetch)

    def fetch(self, package: str, version: str, suffix: str, sha256: str, folder: Path) -> Path:
        assert (package, version, len(sha256)) == ("pose2sim", "0.10.49", 64)
        self.fetched += 1
        wheel = folder / f"{package}-{version}{suffix}"
        with zipfile.ZipFile(wheel, "w") as archive:
            for demo in (made.demo for made in FOOTAGES.values()):
                archive.writestr(f"{demo}/calibration/{CALIBRATION}", "<calibration/>")
                for camera in self.cameras:
                    archive.writestr(f"{demo}/videos/{camera}.mp4", self.video)
        return wheel


@pytest.fixture
def registry(monkeypatch: pytest.MonkeyPatch) -> Registry:
    return Registry(monkeypatch)


@pytest.mark.parametrize("made", FOOTAGES.values(), ids=FOOTAGES)
def test_what_is_prepared_can_be_played_and_beside_it_stays_what_was_fetched(
    registry: Registry, tmp_path: Path, made: Footage
) -> None:
    folder = footage.prepare(tmp_path, made)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["downloads", made.name]
    assert sorted(path.name for path in folder.iterdir()) == sorted(
        ["Calib.qca.txt", *[f"{c}.avi" for c in CAMERAS], "installed.json"]
    )
    video = load_video(folder / "cam02.avi", "cam02")
    assert (video.size_px, len(video.pictures)) == (SIZE_PX, FRAMES)
    assert video.shape(folder / "cam02.avi") == read_avi_shape(folder / "cam02.avi")
    assert registry.fetched == 1


@pytest.mark.usefixtures("registry")
def test_bars_are_cut_off_and_the_picture_fills_the_frame(tmp_path: Path) -> None:
    video = load_video(footage.prepare(tmp_path) / "cam01.avi", "cam01")
    rows = video.frame(0, 0, 0).image().mean(axis=(1, 2))
    assert rows[:8].mean() > 200
    assert rows[-8:] == pytest.approx(np.full(8, 120), abs=12)


@pytest.mark.usefixtures("registry")
def test_the_second_footage_keeps_its_whole_pictures_since_its_calibration_knows_of_their_edges(tmp_path: Path) -> None:
    assert footage.main(["--data", str(tmp_path), "--name", "footage2"]) == 0
    rows = load_video(tmp_path / "footage2/cam01.avi", "cam01").frame(0, 0, 0).image().mean(axis=(1, 2))
    assert rows[:8].mean() < 30
    assert rows[-8:].mean() < 30


def test_bars_are_found_to_the_row_and_a_picture_without_bars_stays_whole() -> None:
    assert picture_rows(barred_picture(bar=7)) == slice(7, 953)
    assert picture_rows(np.full((50, 40, 3), 90, np.uint8)) == slice(0, 50)


def test_both_footages_are_made_of_one_download(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    registry = Registry(monkeypatch)
    fetch = registry.fetch
    folders: list[Path] = []

    def fetch_unless_there(package: str, version: str, suffix: str, sha256: str, folder: Path) -> Path:
        folders.append(folder)
        there = folder / f"{package}-{version}{suffix}"
        return there if there.is_file() else fetch(package, version, suffix, sha256, folder)

    monkeypatch.setattr("models.networks.build.registry.fetch_pypi", fetch_unless_there)
    for made in FOOTAGES.values():
        footage.prepare(tmp_path, made)
    assert registry.fetched == 1
    assert set(folders) == {tmp_path / "downloads"}


def test_a_second_call_finds_everything_in_place(registry: Registry, tmp_path: Path) -> None:
    footage.prepare(tmp_path)
    footage.prepare(tmp_path)
    assert registry.fetched == 1


@pytest.mark.usefixtures("registry")
@pytest.mark.parametrize("damage", ["truncated", "changed", "missing", "no index", "torn index", "older recipe"])
def test_damage_is_found_and_mended(tmp_path: Path, damage: str) -> None:
    folder = footage.prepare(tmp_path)
    assert footage.is_ready(tmp_path)
    file, index = folder / "cam03.avi", folder / "installed.json"
    data = file.read_bytes()
    match damage:
        case "truncated":
            file.write_bytes(data[:-100])
        case "changed":
            file.write_bytes(data[:-1] + b"!")
        case "missing":
            file.unlink()
        case "no index":
            index.unlink()
        case "torn index":
            index.write_text(index.read_text()[:40])
        case "older recipe":
            index.write_text(index.read_text().replace("recipe 1", "recipe 0"))
    assert not footage.is_ready(tmp_path)
    footage.prepare(tmp_path)
    assert footage.is_ready(tmp_path)
    assert file.read_bytes() == data


def test_the_damaged_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"one")
    (tmp_path / "b").write_bytes(b"two")
    index = Index.of("r", [tmp_path / "a", tmp_path / "b"])
    (tmp_path / "b").write_bytes(b"TWO")
    assert index.damaged(tmp_path) == ["b"]


def test_a_package_without_a_video_is_one_line_and_leaves_no_index(
    registry: Registry, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    registry.cameras.remove("cam04")
    assert footage.main(["--data", str(tmp_path)]) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert "videos/cam04.mp4" in message
    assert not footage.is_ready(tmp_path)


def test_a_folder_that_cannot_be_used_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "footage").write_text("a file where a folder should be")
    assert footage.main(["--data", str(tmp_path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("footage: ")
    assert "File exists" in line


def test_a_video_that_cannot_be_read_names_its_camera_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="footage: cam02: "):
        transcode(b"no video at all" * 100, tmp_path / "cam02.avi", "cam02", fitted=True)
    assert list(tmp_path.iterdir()) == []
