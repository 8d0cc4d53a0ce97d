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
from tests.virtual_clock import VirtualClock

SECOND_NS = 1_000_000_000
START_NS = 50 * SECOND_NS
VIDEO = video_of([spot_picture(np.array((20.0 + k, 20.0)), 5.0, (64, 48)) for k in range(40)])


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
    clock, shown, grabs = VirtualClock(START_NS), Shown(), 0

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
    return FaultConfig(camera="cam01", kind=kind, at_s=2.0, for_s=1.5, **more)  # type: ignore[arg-type]


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
    clock = VirtualClock(START_NS)
    source = FaultySource(VideoSource(VIDEO, Schedule(START_NS, 0, 30.0), clock), Script([fault("stall")], START_NS), clock)
    while clock.t_ns < START_NS + 5 * SECOND_NS:
        source.grab(GRAB_TIMEOUT_S)
    assert source.skipped == 0


def test_a_camera_whose_clock_stays_wrong_is_opened_again() -> None:
    shown = film([FaultConfig(camera="cam01", kind="jump", at_s=1.0, for_s=10.0)], 8.0)
    assert 3 <= shown.openings <= 12
    assert any("opened again" in problem for problem in shown.problems)


def pictures(faults: list[FaultConfig], seconds: float = 5.0, seed: int = 0) -> list[tuple[int, Frame]]:
    """What the faults let through, with the instant of its arrival, to whoever grabs all the time and refuses nothing."""
    clock, seen = VirtualClock(START_NS), list[tuple[int, Frame]]()
    source = FaultySource(VideoSource(VIDEO, Schedule(START_NS, 0, 30.0), clock), Script(faults, START_NS, seed), clock)
    while clock.t_ns < START_NS + seconds * SECOND_NS:
        if (frame := source.grab(GRAB_TIMEOUT_S)) is not None:
            seen.append((clock.t_ns, frame))
    return seen


def number(frame: Frame) -> int:
    return frame.epoch * len(VIDEO.pictures) + frame.index


def test_the_pictures_that_are_lost_are_the_same_in_every_run_of_a_seed_and_as_many_as_asked_for() -> None:
    lossy = fault("drop", share=0.3)
    kept = [number(frame) for _, frame in pictures([lossy])]
    again, other = pictures([lossy]), pictures([lossy], seed=1)
    lost = set(range(150)) - set(kept)
    assert kept == [number(frame) for _, frame in again]
    assert kept != [number(frame) for _, frame in other]
    assert lost <= set(range(60, 105)), "none but those that were taken while the fault was due"
    assert 5 <= len(lost) <= 23, "of 45"


def test_a_camera_that_loses_every_picture_shows_nothing_for_as_long_and_is_not_skipped() -> None:
    shown = {number(frame) for _, frame in pictures([fault("drop")])}
    assert shown & set(range(150)) == {*range(60), *range(105, 150)}


def test_late_pictures_arrive_exactly_so_much_later_at_full_rate_and_keep_their_times() -> None:
    for at_ns, frame in pictures([fault("late", by_s=0.25)]):
        late_ns = at_ns - frame.t_mid_ns
        if 60 <= number(frame) < 105:
            assert late_ns == pytest.approx(0.25 * SECOND_NS, abs=2)
        elif number(frame) < 60 or number(frame) > 113:
            assert late_ns <= 2
        assert frame.t_mid_ns == pytest.approx(START_NS + number(frame) * SECOND_NS / 30, abs=2)
    numbers = [number(frame) for _, frame in pictures([fault("late", by_s=0.25)])]
    assert numbers == sorted(numbers), "the order of a cable"


def test_a_picture_that_is_late_holds_up_those_behind_it() -> None:
    seen = pictures([fault("late", by_s=0.1, share=0.2)])
    assert [number(frame) for _, frame in seen[:60]] == list(range(60))
    assert all(earlier <= later for (earlier, _), (later, _) in pairwise(seen))


def test_a_clock_drifts_by_so_many_millionths_from_the_moment_that_it_begins_to() -> None:
    for _, frame in pictures([fault("drift", ppm=-400.0)]):
        truth_ns = START_NS + number(frame) * SECOND_NS / 30
        since_ns = truth_ns - START_NS - 2 * SECOND_NS if 60 <= number(frame) < 105 else 0
        assert frame.t_mid_ns - truth_ns == pytest.approx(-400e-6 * since_ns, abs=2)


def test_an_offset_and_a_drift_of_one_clock_add_up() -> None:
    both = [fault("jump", by_s=0.02), fault("drift", ppm=1000.0)]
    frame = next(frame for _, frame in pictures(both) if number(frame) == 90)
    assert frame.t_mid_ns - START_NS - 3 * SECOND_NS == pytest.approx(0.021 * SECOND_NS, abs=2)


def test_a_covered_lens_shows_black_pictures_of_the_same_size_at_the_same_rate() -> None:
    seen = pictures([fault("dark")])
    assert [number(frame) for _, frame in seen[:150]] == list(range(150))
    for _, frame in seen[50:70]:
        assert frame.image(2).shape == (24, 32, 3)
        assert (frame.image().max() == 0) == (number(frame) >= 60)


def test_pictures_cannot_arrive_before_they_are_taken() -> None:
    with pytest.raises(ValueError, match="late needs by_s"):
        fault("late", by_s=-0.1)


KINDS = st.sampled_from(["end", "stall", "repeat", "jump", "drift", "drop", "late", "dark"])


def _some_fault(kind: str, at_s: float, by_s: float, **more: float) -> FaultConfig:
    by_s = abs(by_s) + 0.01 if kind == "late" else by_s
    return FaultConfig(camera="cam01", kind=kind, at_s=at_s, by_s=by_s, **more)  # type: ignore[arg-type]


FAULTS = st.lists(
    st.builds(
        _some_fault,
        kind=KINDS,
        at_s=st.floats(0, 8),
        by_s=st.floats(-4.9, 4.9),
        for_s=st.floats(0.01, 3),
        every_s=st.sampled_from([0.0, 4.0]),
        share=st.floats(0.1, 1),
    ),
    max_size=4,
)


@pytest.mark.slow
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
    clock, tries = VirtualClock(START_NS), list[int]()
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
        WatchedSource(opened, "cam01", VirtualClock(START_NS))
