"""A camera that falls ill on demand, and the watch that must refuse what it then shows and have it back soon after."""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edge.cameras.faulty import FaultySource, Script
from edge.cameras.source import Frame, Source, SourceError
from edge.cameras.video import Schedule, Video, VideoSource
from edge.cameras.watched import AHEAD_NS, BEHIND_NS, WatchedSource
from edge.process import GRAB_TIMEOUT_S
from models.config.site import FaultConfig
from models.errors import UserError
from tests.small_video import spot_picture, video_of

SECOND_NS = 1_000_000_000
START_NS = 50 * SECOND_NS
VIDEO = video_of([spot_picture(np.array((20.0 + k, 20.0)), 5.0, (64, 48)) for k in range(40)])


@dataclass
class VirtualClock:
    """Time passes only while somebody waits."""

    t_ns: int = START_NS

    def now_ns(self) -> int:
        return self.t_ns

    def sleep_until(self, t_ns: int) -> None:
        self.t_ns = max(self.t_ns, t_ns)


@dataclass
class Shown:
    """What a watched camera showed: instant of receipt and picture; and what was said when nothing came."""

    frames: list[tuple[float, Frame]] = field(default_factory=list)
    problems: set[str] = field(default_factory=set)
    codes: set[str] = field(default_factory=set)
    openings: int = 0

    def between(self, from_s: float, to_s: float) -> int:
        return sum(from_s <= at_s < to_s for at_s, _ in self.frames)


def film(faults: list[FaultConfig], seconds: float, video: Video = VIDEO) -> Shown:
    """Grab for so long as an edge process does."""
    clock, shown, grabs = VirtualClock(), Shown(), 0

    def opened() -> Source:
        shown.openings += 1
        source = VideoSource(video, Schedule(START_NS, 0, 30.0), clock)
        return FaultySource(source, Script(faults, START_NS), clock)

    source = WatchedSource(opened, "cam01", clock)
    while clock.t_ns < START_NS + seconds * SECOND_NS:
        frame, grabs = source.grab(GRAB_TIMEOUT_S), grabs + 1
        if frame is None:
            shown.problems.add(source.problem.words if source.problem else "")
            shown.codes |= {source.problem.code} if source.problem else set()
        else:
            shown.frames.append(((clock.t_ns - START_NS) / SECOND_NS, frame))
            clock.t_ns += 1_000_000  # the loop's own work
    source.close()
    assert grabs < 250 * seconds, "a loop that does not wait takes all the CPU"
    return shown


def fault(kind: str, **more: float) -> FaultConfig:
    made = {"end": "end", "stall": "stall", "repeat": "repeat", "jump": "jump"}[kind]
    return FaultConfig(camera="cam01", kind=made, at_s=2.0, for_s=1.5, **more)  # type: ignore[arg-type]


def test_a_healthy_camera_is_not_interfered_with() -> None:
    shown = film([], 5.0)
    assert len(shown.frames) >= 149
    assert shown.problems == set()
    assert shown.openings == 1


@pytest.mark.parametrize(
    ("ill", "said"),
    [
        (fault("end"), "camera 'cam01' has ended; it is opened again"),
        (fault("stall"), ""),
        (fault("repeat"), "camera 'cam01': it shows the same picture again"),
        (fault("jump"), "camera 'cam01': its clock is 5.0 s ahead"),
        (fault("jump", by_s=-30.0), "camera 'cam01': its clock is 30.0 s behind"),
    ],
)
def test_an_ill_camera_shows_nothing_says_why_and_is_back_when_it_is_well(ill: FaultConfig, said: str) -> None:
    shown = film([ill], 7.0)
    assert shown.between(0.0, 2.0) >= 59
    assert shown.between(2.05, 3.5) <= 1  # the picture that a repeating camera froze
    assert shown.between(4.6, 6.6) >= 59
    assert said in shown.problems


def test_a_camera_that_repeats_its_picture_for_long_is_opened_again_and_its_clock_is_not_blamed() -> None:
    shown = film([FaultConfig(camera="cam01", kind="repeat", at_s=1.0, for_s=12.0)], 15.0)
    assert shown.codes == {"camera_repeats"}
    assert 2 <= shown.openings <= 4
    assert shown.between(1.1, 13.0) <= shown.openings - 1, "one picture at each opening"
    assert shown.between(14.1, 15.0) >= 25


def test_a_fault_comes_again_as_often_as_it_is_asked_for() -> None:
    shown = film([FaultConfig(camera="cam01", kind="stall", at_s=1.0, for_s=0.5, every_s=2.0)], 7.0)
    for k in range(3):
        assert shown.between(1.1 + 2 * k, 1.5 + 2 * k) == 0
        assert shown.between(1.8 + 2 * k, 2.9 + 2 * k) >= 30


def test_a_stall_is_not_counted_as_pictures_that_this_process_missed() -> None:
    clock = VirtualClock()
    source = FaultySource(VideoSource(VIDEO, Schedule(START_NS, 0, 30.0), clock), Script([fault("stall")], START_NS), clock)
    while clock.t_ns < START_NS + 5 * SECOND_NS:
        source.grab(GRAB_TIMEOUT_S)
    assert source.skipped == 0


def test_a_camera_whose_clock_stays_wrong_is_opened_again() -> None:
    shown = film([FaultConfig(camera="cam01", kind="jump", at_s=1.0, for_s=10.0)], 8.0)
    assert 3 <= shown.openings <= 12
    assert any("opened again" in problem for problem in shown.problems)


KINDS = st.sampled_from(["end", "stall", "repeat", "jump"])
FAULTS = st.lists(
    st.builds(
        FaultConfig,
        camera=st.just("cam01"),
        kind=KINDS,
        at_s=st.floats(0, 8),
        for_s=st.floats(0.01, 3),
        every_s=st.sampled_from([0.0, 4.0]),
        by_s=st.floats(-5, 5),
    ),
    max_size=4,
)


@settings(max_examples=40, deadline=None)
@given(FAULTS)
def test_whatever_a_camera_does_what_is_passed_on_is_new_and_of_a_possible_time(faults: list[FaultConfig]) -> None:
    shown = film(faults, 10.0)
    times_ns = [frame.t_mid_ns for _, frame in shown.frames]
    assert all(earlier < later for earlier, later in pairwise(times_ns))
    for at_s, frame in shown.frames:
        assert -BEHIND_NS <= frame.t_mid_ns - (START_NS + at_s * SECOND_NS) <= AHEAD_NS + 1000


@pytest.mark.parametrize("error", [SourceError("camera 'cam01' is unplugged"), UserError("camera 'cam01': film.avi is missing")])
def test_a_camera_that_cannot_be_opened_again_is_tried_for_ever_with_growing_pauses(error: Exception) -> None:
    clock, tries = VirtualClock(), list[int]()
    inner = FaultySource(VideoSource(VIDEO, Schedule(START_NS, 0, 30.0), clock), Script([fault("end")], START_NS), clock)

    def opened() -> Source:
        tries.append(clock.t_ns)
        if len(tries) > 1:
            raise error
        return inner

    source = WatchedSource(opened, "cam01", clock)
    while clock.t_ns < START_NS + 30 * SECOND_NS:
        source.grab(GRAB_TIMEOUT_S)
    assert source.problem is not None
    assert source.problem.code == "camera_ended"
    assert str(error) in source.problem.words
    pauses_s = np.diff(tries[1:]) / SECOND_NS
    assert (np.diff(pauses_s) >= -1e-3).all()
    assert pauses_s[-1] == pytest.approx(1.0, abs=0.01)


def test_a_camera_that_cannot_be_opened_at_the_start_is_the_persons_business() -> None:
    def opened() -> Source:
        raise UserError("camera 'cam01': film.avi is missing")

    with pytest.raises(UserError):
        WatchedSource(opened, "cam01", VirtualClock())
