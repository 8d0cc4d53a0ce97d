"""A file plays like a camera: every picture at its time, the newest one to who comes late, a loop as a new epoch."""

import struct
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import pytest

from edge.cameras.jpeg import JpegFrame
from edge.cameras.source import PictureError
from edge.cameras.video import Schedule, VideoSource, load_video
from tests.small_video import SIZE_PX, plain_picture, video_of, write_video

START_NS = 5_000_000_000
FRAME_NS = 1_000_000_000 / 30


@dataclass
class FakeClock:
    now: int = START_NS
    late_ns: int = 0

    def now_ns(self) -> int:
        return self.now

    def sleep_until(self, t_ns: int) -> None:
        self.now = max(self.now, t_ns + self.late_ns)


def source(clock: FakeClock, frames: int = 5, offset_ns: int = 0, rate_hz: float = 30.0) -> VideoSource:
    video = video_of([plain_picture(k * 10 % 250) for k in range(frames)])
    return VideoSource(video, Schedule(START_NS, offset_ns, rate_hz), clock)


def grab(playing: VideoSource, timeout_s: float = 1.0) -> JpegFrame:
    frame = playing.grab(timeout_s)
    assert frame is not None
    return frame


def test_every_picture_is_shown_in_order_at_its_time() -> None:
    clock = FakeClock()
    playing = source(clock)
    for k in range(5):
        frame = grab(playing)
        assert (frame.epoch, frame.index) == (0, k)
        assert 0 <= frame.t_mid_ns - (START_NS + k * FRAME_NS) < 1
        assert clock.now >= frame.t_mid_ns
    assert playing.skipped == 0


def test_a_loop_is_a_new_epoch_without_a_gap_in_time() -> None:
    playing = source(FakeClock(), frames=2)
    seen = [grab(playing) for _ in range(5)]
    assert [(frame.epoch, frame.index) for frame in seen] == [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0)]
    gaps = [b.t_mid_ns - a.t_mid_ns for a, b in pairwise(seen)]
    assert all(abs(gap - FRAME_NS) <= 1 for gap in gaps)


def test_an_offset_delays_every_picture_and_a_rate_stretches_them() -> None:
    assert grab(source(FakeClock(), offset_ns=7_000_000)).t_mid_ns == START_NS + 7_000_000
    playing = source(FakeClock(), rate_hz=10.0)
    assert grab(playing).t_mid_ns + 100_000_000 == grab(playing).t_mid_ns


def test_who_comes_late_gets_the_newest_picture_and_the_missed_ones_are_counted() -> None:
    clock = FakeClock()
    playing = source(clock, frames=100)
    grab(playing)
    clock.now = START_NS + round(3.5 * FRAME_NS)
    assert grab(playing).index == 3
    assert playing.skipped == 2
    assert grab(playing).index == 4
    assert playing.skipped == 2


def test_a_sleep_that_lasts_too_long_is_coming_late() -> None:
    playing = source(FakeClock(late_ns=round(2.5 * FRAME_NS)), frames=100)
    assert [grab(playing).index for _ in range(3)] == [0, 3, 6]
    assert playing.skipped == 4


def test_pictures_shown_before_the_first_grab_were_not_missed() -> None:
    clock = FakeClock(now=START_NS + round(40.2 * FRAME_NS))
    playing = source(clock, frames=100)
    assert grab(playing).index == 40
    assert playing.skipped == 0


def test_a_timeout_gives_nothing_and_loses_nothing() -> None:
    clock = FakeClock(now=START_NS - 500_000_000)
    playing = source(clock)
    assert playing.grab(0.2) is None
    assert playing.grab(0.2) is None
    assert (grab(playing).index, playing.skipped) == (0, 0)


def test_a_picture_is_rgb_and_its_reduction_covers_it() -> None:
    picture = plain_picture(0, (161, 97))
    picture[:, :, 0] = 200
    frame = video_of([picture]).frame(0, 0, 0)
    assert frame.image().shape == (97, 161, 3)
    assert frame.image()[50, 50] == pytest.approx((200, 0, 0), abs=8)
    assert [frame.image(reduction).shape for reduction in (2, 4, 8)] == [(49, 81, 3), (25, 41, 3), (13, 21, 3)]


def test_a_damaged_picture_is_an_error_of_its_own_and_names_the_camera() -> None:
    frame = video_of([plain_picture(90)]).frame(0, 0, 0)
    broken = JpegFrame("cam07", 0, 12, 0, SIZE_PX, frame.data[: len(frame.data) // 2])
    with pytest.raises(PictureError, match=r"cam07.*picture 12"):
        broken.image()


@pytest.mark.parametrize(
    ("width", "height", "reduction"),
    [(40_000, 40_000, 1), (96, 8, 1), (3000, 128, 2), (1, 1, 4), (SIZE_PX[0] + 1, SIZE_PX[1], 1), (SIZE_PX[0] + 1, SIZE_PX[1], 4)],
)
def test_a_picture_whose_size_was_damaged_is_no_picture_and_ends_nobody(width: int, height: int, reduction: int) -> None:
    """A crop would be cut out of it at the wrong place; of the largest OpenCV makes an error of its own."""
    data = bytearray(video_of([plain_picture(90)]).frame(0, 0, 0).data)
    size_at = data.index(b"\xff\xc0") + 5
    data[size_at : size_at + 4] = struct.pack(">HH", height, width)
    with pytest.raises(PictureError, match=r"cam07.*picture 12 is damaged"):
        JpegFrame("cam07", 0, 12, 0, SIZE_PX, bytes(data)).image(reduction)


def test_a_file_written_and_loaded_shows_the_same_pictures(tmp_path: Path) -> None:
    video = load_video(write_video(tmp_path / "a.avi"), "cam01")
    levels = [float(frame.image().mean()) for frame in video.frames(30.0)]
    assert video.size_px == SIZE_PX
    assert levels == pytest.approx([20 * k for k in range(10)], abs=2)
