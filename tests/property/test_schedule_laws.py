"""Laws of when pictures are due and whose turn it is."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from edge.cameras.video import Schedule
from edge.turns import default_control, is_due, missed_turns, turn
from models.messages.control import ViewControl

instants = st.integers(min_value=0, max_value=10**16)
rates = st.sampled_from([5.0, 10.0, 15.0, 24.0, 25.0, 29.97, 30.0, 59.94, 60.0, 120.0])


@given(start=instants, offset=st.integers(-(10**9), 10**9), rate=rates, number=st.integers(0, 10**7))
def test_a_picture_is_the_newest_from_its_instant_until_the_next_ones(start: int, offset: int, rate: float, number: int) -> None:
    schedule = Schedule(start, offset, rate)
    assert schedule.newest(schedule.t_ns(number)) == number
    assert schedule.newest(schedule.t_ns(number + 1) - 1) == number


def plan(rate_hz: float, offset_ns: int) -> ViewControl:
    return ViewControl("cam01", 1, 0, rate_hz, offset_ns, "thunder", True, None)


@pytest.mark.slow
@given(start=instants, rate=st.sampled_from([30.0, 15.0, 10.0, 5.0]), number=st.integers(0, 10**6), position=st.integers(0, 3))
def test_a_source_of_30_hz_is_inferred_exactly_at_the_rate_of_the_plan(start: int, rate: float, number: int, position: int) -> None:
    schedule = Schedule(start, 0, 30.0)
    control = plan(rate, start + round(position * 1e9 / (4 * rate)))
    inferred: int | None = None
    count = 0
    for k in range(number, number + 300):
        if is_due(schedule.t_ns(k), inferred, control):
            inferred = schedule.t_ns(k)
            count += 1
    assert abs(count - 10 * rate) <= 1


@given(start=instants, k=st.integers(0, 10**6))
def test_without_fusion_the_cameras_take_turns_within_a_tenth_of_a_second(start: int, k: int) -> None:
    plans = [default_control(f"cam0{i}", i, 4, start, 30.0) for i in range(4)]
    beginnings = {(control.offset_ns - start) % 100_000_000 for control in plans}
    assert beginnings == {0, 25_000_000, 50_000_000, 75_000_000}
    t_ns = start + k * 33_333_333
    assert all(turn(t_ns + 100_000_000, control) == turn(t_ns, control) + 1 for control in plans)


@given(t=instants)
def test_an_idle_camera_is_never_due_and_misses_nothing(t: int) -> None:
    assert not is_due(t, None, plan(0.0, 0))
    assert missed_turns(t + 10**9, t, 29, plan(0.0, 0)) == 0


@pytest.mark.parametrize(
    ("rate", "gap_ns", "skipped", "missed"), [(30, 100_000_000, 2, 2), (10, 100_000_000, 2, 0), (10, 350_000_000, 9, 2)]
)
def test_a_missed_turn_is_one_that_had_a_picture(rate: float, gap_ns: int, skipped: int, missed: int) -> None:
    assert missed_turns(1_000_000_000 + gap_ns, 1_000_000_000, skipped, plan(rate, 0)) == missed
    assert missed_turns(1_000_000_000 + gap_ns, 1_000_000_000, 0, plan(rate, 0)) == 0


def test_the_site_files_limit_holds_before_any_plan_has_come() -> None:
    assert default_control("cam01", 0, 4, 0, 5.0).rate_hz == 5.0
