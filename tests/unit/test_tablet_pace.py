"""A client is read at a bounded pace, and whoever keeps to it is never held up."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.tablet.pace import Pace


def test_whoever_keeps_to_the_pace_never_waits() -> None:
    pace = Pace(hz=50, burst=10)
    assert [pace.wait_s(7.0 + count / 49) for count in range(500)] == [0.0] * 500


@pytest.mark.parametrize("now_s", [0.0, 100.0], ids=["as the machine starts", "later"])
def test_a_burst_is_read_at_once_and_what_follows_at_the_pace(now_s: float) -> None:
    pace = Pace(hz=50, burst=10)
    waits = [pace.wait_s(now_s) for _ in range(20)]
    assert waits[:10] == [0.0] * 10
    assert waits[10:] == pytest.approx([(count + 1) / 50 for count in range(10)])


@given(st.lists(st.floats(0, 0.2), max_size=200))
def test_whoever_waits_as_told_is_never_read_faster(pauses_s: list[float]) -> None:
    pace, now_s, read_s = Pace(hz=50, burst=10), 1000.0, []
    for pause_s in pauses_s:
        now_s += pause_s
        read_s.append(now_s)
        now_s += pace.wait_s(now_s)
    for first, from_s in enumerate(read_s):
        for last in range(first, len(read_s)):
            assert last - first + 1 <= 10 + 1 + 50 * (read_s[last] - from_s) + 1e-6
