"""The governor on a simulated box: it must find the best rate that the CPU carries, keep it, and never swing."""

import itertools

import msgspec
import pytest

from models.messages.health import CameraHealth
from services.fusion import governor
from services.fusion.governor import LADDER, GovernorState, Load
from services.fusion.inference_cost import InferenceCost
from tests.governed_box import Box, run

RUNNING = GovernorState(started_ns=0)


@pytest.mark.parametrize(
    ("cores", "slowness", "expected"),
    [
        (8.0, 1.0, (30.0, "thunder")),
        (3.0, 1.0, (15.0, "thunder")),
        (2.0, 1.0, (10.0, "thunder")),
        (2.0, 1.4, (15.0, "lightning")),
        (1.0, 1.0, (10.0, "lightning")),
        (1.0, 1.6, (7.5, "lightning")),
        (2.0, 3.0, (10.0, "lightning")),
        (1.0, 3.0, (5.0, "lightning")),
    ],
)
def test_the_best_rate_that_fits_is_found_and_kept(cores: float, slowness: float, expected: tuple[float, str]) -> None:
    states = run(Box(cores, slowness=slowness), 600)
    last = [(state.current.rate_hz, state.current.network) for state in states[-120:]]
    assert set(last) == {expected}


@pytest.mark.parametrize("slowness", [0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.6, 2.0, 3.0])
@pytest.mark.parametrize("cores", [1.0, 2.0, 4.0])
def test_a_box_that_gets_slower_when_it_is_busy_does_not_swing(cores: float, slowness: float) -> None:
    states = run(Box(cores, slowness=slowness, contention=0.5), 1800)
    climbs = [b for a, b in itertools.pairwise(states[600:]) if b.level < a.level]
    assert len(climbs) <= 1200 / 120


def test_the_rush_of_the_start_neither_lowers_the_rate_nor_spoils_the_plan_for_later() -> None:
    states = [GovernorState()]
    for second in range(1, 9):
        slow = CameraHealth("cam", 30.0, 4.0, 10.0, 9, 200.0, "thunder", {"pose": 75.0, "detect": 40.0})
        states.append(governor.step(states[-1], Load(2.0, 2.0, [slow] * 4), second * 10**9, 30.0, 0.85))
    assert {state.level for state in states} == {governor.START}
    assert run(Box(2.0), 120, states[-1], 8)[-1].level == governor.START


@pytest.mark.parametrize("rush_s", [20, 40])
@pytest.mark.parametrize("cores", [1.0, 2.0, 4.0])
def test_a_rush_that_takes_several_rungs_at_once_is_soon_forgotten(cores: float, rush_s: int) -> None:
    # Everything that starts takes the whole CPU; half of a core then idled for two minutes.
    best = run(Box(cores), 300)[-1].level
    rushed = run(Box(cores, base_cores=cores), rush_s)[-1]
    after = run(Box(cores), 120, rushed, rush_s)
    assert rushed.level > best
    assert {state.level for state in after[45:]} == {best}


def test_the_rung_in_force_is_not_given_up_for_what_its_inferences_once_cost() -> None:
    rushed = GovernorState(level=4, started_ns=0, cost=InferenceCost({"lightning": 25.0}, other_ms=8.0))
    states = run(Box(1.0), 120, rushed)
    assert {state.level for state in states} == {4}


def test_a_busy_second_every_now_and_then_is_no_reason_to_step_down() -> None:
    class Judging(Box):
        """Every fourth second an attempt is judged."""

        seconds = 0

        def second(self, state: GovernorState) -> Load:
            self.seconds += 1
            self.base_cores = 0.5 if self.seconds % 4 == 0 else 0.25
            return super().second(state)

    states = run(Judging(1.0), 300)
    assert {LADDER[state.level] for state in states[60:]} == {governor.Level(10.0, "lightning")}


def test_what_a_network_cost_in_a_bad_minute_is_not_held_against_it_for_ever() -> None:
    bad = run(Box(2.0, slowness=3.0), 60)[-1]
    assert LADDER[bad.level].network == "lightning"
    assert run(Box(2.0), 300, bad, 60)[-1].level == governor.START


def test_a_box_that_becomes_busy_steps_down_and_climbs_again_when_it_is_free() -> None:
    calm = run(Box(2.0), 60)
    busy = run(Box(2.0, base_cores=1.5), 60, calm[-1], 60)
    free = run(Box(2.0), 300, busy[-1], 120)
    assert LADDER[busy[-1].level].network == "lightning"
    assert free[-1].level == calm[-1].level


def test_a_rung_that_failed_is_tried_less_and_less_often() -> None:
    # The prediction is too hopeful here: the box says that it has more CPU than it has.
    class Boastful(Box):
        def second(self, state: GovernorState) -> Load:
            load = super().second(state)
            return Load(4.0, load.used_cores, load.cameras)

    states = run(Boastful(1.6), 1200)
    climbs = [second for second, (a, b) in enumerate(itertools.pairwise(states)) if b.level < a.level]
    assert len(climbs) <= 12
    gaps = [b - a for a, b in itertools.pairwise(climbs)]
    assert gaps[-1] > 4 * gaps[0]


@pytest.mark.parametrize("max_rate_hz", [5.0, 7.5, 10.0, 15.0, 30.0])
@pytest.mark.parametrize("in_force", [*LADDER, None], ids=str)
def test_the_rate_never_exceeds_what_the_site_allows(max_rate_hz: float, in_force: governor.Level | None) -> None:
    # The box is idle, then busy, then idle again, so that the ladder is walked down and up.
    state = GovernorState(level=LADDER.index(in_force or LADDER[governor.START]))
    states = run(Box(16.0), 60, state, max_rate_hz=max_rate_hz)
    states += run(Box(1.0, slowness=1.6), 60, states[-1], 60, max_rate_hz=max_rate_hz)
    states += run(Box(16.0), 600, states[-1], 120, max_rate_hz=max_rate_hz)
    assert all(state.current.rate_hz <= max_rate_hz for state in states[1:])
    assert states[-1].current == next(level for level in LADDER if level.rate_hz <= max_rate_hz)


def test_a_slow_box_steps_down_past_the_rungs_that_the_site_forbids() -> None:
    states = run(Box(2.0, slowness=1.4), 120, max_rate_hz=10.0)
    assert states[-1].current == governor.Level(10.0, "lightning")
    assert {state.current.network for state in states[1:]} == {"thunder", "lightning"}


def test_one_slow_camera_does_not_slow_the_others() -> None:
    state = RUNNING
    load = Box(2.0).second(state)
    ill = CameraHealth("cam", 30.0, 2.0, 10.0, 50, 90.0, "thunder", {"pose": 28.0})
    moved = governor.step(state, Load(2.0, 1.4, [*load.cameras[:3], ill]), 10**10, 30.0, 0.85)
    assert moved.level == state.level


def test_a_slow_source_is_not_taken_for_a_short_cpu() -> None:
    slow = CameraHealth("cam", 8.0, 8.0, 10.0, 0, 5.0, "thunder", {"pose": 28.0})
    moved = governor.step(RUNNING, Load(2.0, 1.4, [slow] * 4), 10**10, 10.0, 0.85)
    assert moved.level == governor.START


@pytest.mark.parametrize("source_hz", [0.0, 5.0])
def test_a_dead_or_slow_source_does_not_hide_that_the_others_fall_behind(source_hz: float) -> None:
    behind = CameraHealth("cam", 30.0, 3.0, 10.0, 50, 90.0, "thunder", {"pose": 28.0})
    ill = CameraHealth("ill", source_hz, min(source_hz, 3.0), 10.0, 0, 5.0, "thunder", {"pose": 28.0})
    moved = governor.step(RUNNING, Load(4.0, 1.4, [behind, behind, behind, ill]), 10**10, 30.0, 0.85)
    assert moved.level == governor.START + 1


def test_no_camera_alive_changes_nothing() -> None:
    assert governor.step(RUNNING, Load(2.0, 0.1, []), 10**10, 30.0, 0.85) == RUNNING


def test_the_cameras_take_turns_evenly() -> None:
    offsets = [governor.turn_offset_ns(position, 4, 10.0) for position in range(4)]
    assert offsets == [0, 25_000_000, 50_000_000, 75_000_000]


def test_a_fusion_that_takes_over_goes_on_with_the_plan_that_is_in_force() -> None:
    obeying = CameraHealth("cam", 30.0, 10.0, 10.0, 0, 5.0, "lightning", {})
    state = governor.step(GovernorState(), Load(2.0, 1.9, [obeying] * 4), 10**9, 30.0, 0.85)
    assert state.current == governor.Level(10.0, "lightning")


def test_cameras_with_a_plan_of_no_rung_make_a_start_as_always() -> None:
    odd = CameraHealth("cam", 30.0, 3.0, 3.0, 0, 5.0, "thunder", {})
    assert governor.step(GovernorState(), Load(2.0, 1.9, [odd] * 4), 10**9, 30.0, 0.85).level == governor.START


@pytest.mark.parametrize(
    "nonsense",
    [
        {"network": "\x00"},
        {"fresh_hz": float("nan")},
        {"source_hz": float("-inf")},
        {"stage_ms": {"pose": float("nan")}},
        {"stage_ms": {"pose": -5.0}},
        {"stage_ms": {"pose": 24.0, "x": 1e308, "y": 1e308}},
    ],
)
def test_what_no_camera_can_have_measured_changes_nothing(nonsense: dict[str, object]) -> None:
    box = Box(4.0)
    state = run(box, 40)[-1]
    load = box.second(state)
    mad = msgspec.structs.replace(load.cameras[0], **nonsense)
    after = governor.step(state, Load(load.granted_cores, load.used_cores, [*load.cameras, mad]), 41 * 10**9, 30.0, 0.85)
    assert after == governor.step(state, load, 41 * 10**9, 30.0, 0.85)
