"""The governor: how often, and with which network, every camera is looked at, given the CPU there is.

Two cores cannot run the large network on four cameras at 30 Hz, and a school box is slower still. The governor walks a
ladder of levels, a rung at a time. It climbs to what it predicts to fit, from what an inference was measured to cost; it stays
by what it measures: it steps down at once when the cameras report that they fall behind, and when the CPU stays filled beyond
its share for some seconds. All cameras get the same rate, and places in the turn spread evenly, so that their inferences do not
collide.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from models.messages.control import PoseNetwork
from models.messages.health import CameraHealth
from services.fusion.inference_cost import InferenceCost, believable


@dataclass(frozen=True)
class Level:
    """One rung of the ladder."""

    rate_hz: float
    network: PoseNetwork


LADDER: Final = (
    Level(30.0, "thunder"),
    Level(15.0, "thunder"),
    Level(10.0, "thunder"),
    Level(15.0, "lightning"),
    Level(10.0, "lightning"),
    Level(7.5, "lightning"),
    Level(5.0, "lightning"),
)
"""Best first, and cheaper with every rung. A large network at 10 Hz beats a small one at 15: after smoothing, half the rate costs
13 % of accuracy, the small network's noise 60 % (measured on simulated throws; see docs/decisions/0003-governor.md)."""

START: Final = 2
_PATIENCE_S: Final = 5.0
_FIRST_PAUSE_S: Final = 15.0
_LONGEST_PAUSE_S: Final = 240.0
_PROVEN_S: Final = 60.0
"""A rung that failed before and now holds for so long is trusted again, and so are those below it."""
_SHORTFALL: Final = 0.85
_SETTLING_S: Final = 2.5
_STARTING_S: Final = 8.0
"""While everything loads, searches and detects at once, nothing is learnt about what comes after."""
_ROOM_TO_CLIMB: Final = 0.92
_ROOM_TO_STAY: Final = 1.05
"""Shares of the budget: near its limit the governor would swing if climbing and staying had the same one."""
_CROWDED_S: Final = 3
"""So many busy seconds in a row are more than an attempt that is judged, or a lesson that is opened: the rung is too dear."""


@dataclass(frozen=True)
class Load:
    """What was measured over the last second.

    Attributes:
        granted_cores: CPU that the box may use.
        used_cores: CPU in use on what is granted, by the box and by others, at whatever priority (docs/decisions/0003-governor.md).
        cameras: the newest word of every camera that is alive.
    """

    granted_cores: float
    used_cores: float
    cameras: Sequence[CameraHealth]


@dataclass(frozen=True)
class Pause:
    """How long a rung that was given up is left alone, and those above it.

    Attributes:
        length_s: its length; twice that, up to a limit, if the rung fails again before it has proven itself.
        until_ns: CLOCK_MONOTONIC of its end.
    """

    length_s: float
    until_ns: int


@dataclass(frozen=True)
class GovernorState:
    """Where on the ladder, since when, what inferences cost, and which rungs failed.

    Attributes:
        level: index into `LADDER`.
        started_ns: CLOCK_MONOTONIC of the first step.
        since_ns: of the last move.
        crowded_s: seconds in a row, up to now, in which the CPU was filled beyond what the level may fill.
        failed: the rungs that were given up and are not proven since, each with its own pause: one shortage can take several
            rungs within seconds, and says no more of any of them than a shortage that takes one.
        cost: of an inference.
    """

    level: int = START
    started_ns: int | None = None
    since_ns: int = 0
    crowded_s: int = 0
    failed: dict[int, Pause] = field(default_factory=dict)
    cost: InferenceCost = field(default_factory=InferenceCost)

    @property
    def started(self) -> bool:
        """Whether it has decided once."""
        return self.started_ns is not None

    @property
    def current(self) -> Level:
        """The rung in force."""
        return LADDER[self.level]


def step(state: GovernorState, load: Load, t_ns: int, max_rate_hz: float, cpu_target: float) -> GovernorState:
    """Decide anew, about once a second.

    Args:
        state: the last decision.
        load: what was measured since.
        t_ns: CLOCK_MONOTONIC now.
        max_rate_hz: rungs above this rate are never taken.
        cpu_target: share of `granted_cores` that may be filled.
    """
    load = replace(load, cameras=[camera for camera in load.cameras if believable(camera)])
    if state.started_ns is None:
        state = replace(state, started_ns=t_ns, level=_found_in_force(load.cameras))
    # Not simply the ladder's end: a rung with the small network may have a higher rate than one above it with the large.
    allowed = [rung for rung, level in enumerate(LADDER) if level.rate_hz <= max_rate_hz]
    if state.level not in allowed:
        return _move(state, _below(state.level, allowed), t_ns)
    settled_s = (t_ns - state.since_ns) * 1e-9
    started_s = (t_ns - (state.started_ns or 0)) * 1e-9
    if not load.cameras or settled_s < _SETTLING_S or started_s < _STARTING_S:
        return state
    return _reconsider(replace(state, cost=state.cost.learn(load.cameras)), load, t_ns, allowed, cpu_target)


def _found_in_force(cameras: Sequence[CameraHealth]) -> int:
    """The rung of most cameras: that of the fusion before this one, which was learnt on this box, or without one `START`."""
    rungs = {(level.rate_hz, level.network): index for index, level in enumerate(LADDER)}
    found = [rungs[key] for camera in cameras if (key := (camera.target_hz, camera.network)) in rungs]
    return max(found, key=lambda rung: (found.count(rung), rung), default=START)


def turn_offset_ns(position: int, cameras: int, rate_hz: float) -> int:
    """A camera's place in the turn: `ViewControl.offset_ns` for camera `position` of `cameras`."""
    return round(position / cameras / rate_hz * 1e9)


def _reconsider(state: GovernorState, load: Load, t_ns: int, allowed: Sequence[int], cpu_target: float) -> GovernorState:
    """Down, up or stay, once the last move has settled."""
    settled_s, budget = (t_ns - state.since_ns) * 1e-9, load.granted_cores * cpu_target
    # The rung in force is measured, not predicted: what inferences cost in the rush of the start would be held against it.
    crowded_s = state.crowded_s + 1 if load.used_cores > budget * _ROOM_TO_STAY else 0
    state = replace(state, crowded_s=crowded_s)
    if crowded_s >= _CROWDED_S or _falls_behind(state, load):
        return _give_up(state, t_ns, allowed)
    above = max((rung for rung in allowed if rung < state.level and not _paused(rung, state, t_ns)), default=None)
    if above is not None and settled_s >= _PATIENCE_S and predicted_cores(state, load, LADDER[above]) <= budget * _ROOM_TO_CLIMB:
        return _move(state, above, t_ns)
    if settled_s >= _PROVEN_S:
        return replace(state, failed={rung: pause for rung, pause in state.failed.items() if rung < state.level})
    return state


def predicted_cores(state: GovernorState, load: Load, level: Level) -> float:
    """CPU that would be in use on that rung: what is in use now, less today's inferences, plus that rung's."""
    now = sum(camera.fresh_hz * state.cost.of(camera.network) for camera in load.cameras) / 1e3
    then = len(load.cameras) * level.rate_hz * state.cost.of(level.network) / 1e3
    return max(load.used_cores - now, 0.0) + then


def _paused(rung: int, state: GovernorState, t_ns: int) -> bool:
    """Whether a rung is left alone, because it or one below it was given up a short time ago."""
    return any(rung <= failed and t_ns < pause.until_ns for failed, pause in state.failed.items())


def _below(level: int, allowed: Sequence[int]) -> int:
    """The next rung down; the lowest itself has none below."""
    return next((rung for rung in allowed if rung > level), allowed[-1])


def _falls_behind(state: GovernorState, load: Load) -> bool:
    wanted = state.current.rate_hz
    # A source that is itself slower than the plan is held to what it delivers; one that delivers nothing says nothing.
    judged = [camera for camera in load.cameras if camera.source_hz > 0 and camera.target_hz == wanted]
    slow = [camera for camera in judged if camera.fresh_hz < _SHORTFALL * min(wanted, camera.source_hz)]
    # One slow camera may have trouble of its own; the CPU is short when they are slow together.
    return bool(judged) and 2 * len(slow) >= len(judged)


def _give_up(state: GovernorState, t_ns: int, allowed: Sequence[int]) -> GovernorState:
    """One rung down, and this one is left alone for a while: longer each time, or it would be tried and given up for ever."""
    if state.level == allowed[-1]:
        return state
    before = state.failed.get(state.level)
    length_s = _FIRST_PAUSE_S if before is None else min(2 * before.length_s, _LONGEST_PAUSE_S)
    pause = Pause(length_s, t_ns + round(length_s * 1e9))
    return replace(_move(state, _below(state.level, allowed), t_ns), failed=state.failed | {state.level: pause})


def _move(state: GovernorState, level: int, t_ns: int) -> GovernorState:
    return replace(state, level=level, since_ns=t_ns, crowded_s=0)
