"""A file that cannot be played is named together with its camera, before anything is started."""

from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

from edge.cameras.video import load_video
from models.errors import UserError
from tests.small_video import write_video


def test_missing(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"camera 'cam03'.*none\.avi is missing"):
        load_video(tmp_path / "none.avi", "cam03")


def test_a_folder_is_no_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"camera 'cam03'.*missing"):
        load_video(tmp_path, "cam03")


def test_a_path_that_cannot_be_looked_up(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"camera 'cam03'.*can be read \(\[Errno \d+\] File name too long"):
        load_video(tmp_path / ("a" * 300), "cam03")


def test_empty(tmp_path: Path) -> None:
    (tmp_path / "cam.avi").touch()
    with pytest.raises(UserError, match=r"camera 'cam03'.*cam\.avi is empty"):
        load_video(tmp_path / "cam.avi", "cam03")


def test_not_a_video(tmp_path: Path) -> None:
    (tmp_path / "cam.avi").write_text("this is no video " * 100)
    with pytest.raises(UserError, match=r"camera 'cam03'.*cam\.avi is not a video"):
        load_video(tmp_path / "cam.avi", "cam03")


@pytest.mark.parametrize("kept", [0.3, 0.6, 0.95])
def test_truncated(tmp_path: Path, kept: float) -> None:
    data = write_video(tmp_path / "whole.avi", frames=12).read_bytes()
    (tmp_path / "cam.avi").write_bytes(data[: int(kept * len(data))])
    with pytest.raises(UserError, match=r"camera 'cam03'.*cam\.avi is (truncated|not a video)"):
        load_video(tmp_path / "cam.avi", "cam03")


def test_a_hole_in_the_middle(tmp_path: Path) -> None:
    data = bytearray(write_video(tmp_path / "cam.avi", frames=12).read_bytes())
    begin = data.index(b"\xff\xd8", len(data) // 2)
    data[begin : begin + 4] = b"\0\0\0\0"
    (tmp_path / "cam.avi").write_bytes(data)
    with pytest.raises(UserError, match="11 of 12 pictures are whole"):
        load_video(tmp_path / "cam.avi", "cam03")


def test_a_codec_whose_pictures_do_not_stand_alone_is_named(tmp_path: Path) -> None:
    path = tmp_path / "cam.mp4"
    with av.open(str(path), "w") as sink:
        stream = sink.add_stream("mpeg4", rate=Fraction(30))
        stream.width, stream.height = 160, 96
        for _ in range(3):
            sink.mux(stream.encode(av.VideoFrame.from_ndarray(np.zeros((96, 160, 3), np.uint8), format="rgb24")))
        sink.mux(stream.encode())
    with pytest.raises(UserError, match=r"camera 'cam03'.*mpeg4; only Motion JPEG"):
        load_video(path, "cam03")


def test_sound_without_pictures(tmp_path: Path) -> None:
    path = tmp_path / "cam.wav"
    with av.open(str(path), "w") as sink:
        stream = sink.add_stream("pcm_s16le", rate=8000)
        frame = av.AudioFrame.from_ndarray(np.zeros((1, 800), np.int16), format="s16", layout="mono")
        frame.sample_rate = 8000
        sink.mux(stream.encode(frame))
        sink.mux(stream.encode())
    with pytest.raises(UserError, match=r"camera 'cam03'.*contains no video"):
        load_video(path, "cam03")
