"""Laws of the governor on a simulated box, whatever else the box has to do: no CPU idles, nothing piles up, nothing swings."""

import itertools

from hypothesis import given, settings
from hypothesis import strategies as st

from services.fusion.governor import LADDER, GovernorState
from tests.governed_box import CPU_TARGET, Box, run

CORES = st.sampled_from([1.0, 2.0, 4.0])
SLOWNESS = st.floats(0.6, 3.0)
HISTORIES = st.lists(st.tuples(st.integers(1, 90), st.floats(0.0, 1.0)), max_size=6)
"""Seconds, and the share of all cores that others take meanwhile."""
WEATHER = st.lists(st.tuples(st.integers(1, 40), st.floats(0.0, 1.0)), min_size=1, max_size=8)
"""The same, again and again."""
LOWEST = len(LADDER) - 1
PAUSE_S = 240
"""The longest one."""
CLIMB_S = 60
"""From the lowest rung to the highest, or down again."""
FILLED, IDLE = 1.06 * CPU_TARGET, 0.87 * CPU_TARGET
"""Shares of the cores: nothing settles above the first, and what would stay below the second is not left out. The governor means
1.05 and 0.92, but knows only about what the other network would cost."""


def live_through(box: Box, pieces: list[tuple[int, float]], states: list[GovernorState]) -> list[GovernorState]:
    """All states so far, when the CPU that others take has been that of the pieces, one after the other."""
    for seconds, share in pieces:
        box.base_cores = share * box.cores
        states = states + run(box, seconds, states[-1], len(states) - 1)[1:]
    return states


def cores_at(box: Box, level: int) -> float:
    """What would be in use if the cameras got what the level asks of them."""
    return box.base_cores + box.wanted_cores(LADDER[level])


@settings(max_examples=40)
@given(CORES, SLOWNESS, HISTORIES)
def test_no_cpu_idles_for_long_whatever_went_before(cores: float, slowness: float, history: list[tuple[int, float]]) -> None:
    box = Box(cores, slowness=slowness)
    states = live_through(box, [*history, (PAUSE_S + CLIMB_S, 0.1)], [GovernorState()])
    level = states[-1].level
    assert level == 0 or cores_at(box, level - 1) > IDLE * cores


@settings(max_examples=40)
@given(CORES, SLOWNESS, HISTORIES, st.floats(0.0, 1.0))
def test_cameras_are_never_asked_for_more_than_the_cpu_gives_for_long(
    cores: float, slowness: float, history: list[tuple[int, float]], share: float
) -> None:
    box = Box(cores, slowness=slowness)
    states = live_through(box, [*history, (CLIMB_S, share)], [GovernorState()])
    level = states[-1].level
    assert level == LOWEST or cores_at(box, level) <= FILLED * cores


@settings(max_examples=20)
@given(CORES, SLOWNESS, st.floats(0.0, 0.5), WEATHER)
def test_no_rung_is_tried_again_and_again_whatever_the_load_does(
    cores: float, slowness: float, contention: float, weather: list[tuple[int, float]]
) -> None:
    box = Box(cores, slowness=slowness, contention=contention)
    states, whole_s = [GovernorState()], 900
    while len(states) <= whole_s:
        states = live_through(box, weather, states)
    climbs = [(second, b.level) for second, (a, b) in enumerate(itertools.pairwise(states[: whole_s + 1])) if b.level < a.level]
    for rung in range(LOWEST):
        at_s = [second for second, level in climbs if level == rung]
        assert all(b - a >= 15 for a, b in itertools.pairwise(at_s))
        # A pause is doubled unless the rung has held a minute: with 60 + 15 + 3 + 30 seconds, two climbs are the most.
        assert len(at_s) <= 3 + whole_s / 50
