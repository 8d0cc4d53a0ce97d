"""The box without clock and sockets, so that a run repeats to the last bit: pictures go in, what fusion consumed comes out.

The edge's `observe` and fusion's `step` are the functions that the processes call. The loop between them is closed as the processes
close it: fusion tells every camera where it expects the pupil, a camera looks when it is its turn, and its observation reaches
fusion some time after the picture was taken.
"""

import heapq
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count
from typing import Final

from edge.cameras.source import Frame
from edge.observe import EdgeConfig, EdgeState, Networks, Stages, observe
from edge.turns import is_due
from models.camera.rig import Rig
from models.messages.control import PoseNetwork, ViewControl
from models.messages.observation import Observation
from services.fusion.config import FusionConfig
from services.fusion.governor import turn_offset_ns
from services.fusion.pipeline import FusionState, Tick, initial_state, predict_views, step

Event = Observation | Tick
_PICTURE, _ARRIVAL, _TICK = range(3)
"""What comes first of several at the same instant."""
_EDGE: Final = EdgeConfig()


@dataclass(frozen=True)
class Pace:
    """How the box runs.

    Attributes:
        rate_hz: inferences a second of each camera, in turns.
        network: pose network.
        start_ns: from which the turns count.
        delay_ns: from mid-exposure until fusion has the observation: transfer, waiting, decoding, network, bus.
        ticks_a_plan: ticks from one plan for the cameras to the next; the box has `services.fusion.process.CONTROL_EVERY_TICKS`.
    """

    rate_hz: float
    network: PoseNetwork
    start_ns: int
    delay_ns: int = 0
    ticks_a_plan: int = 1


@dataclass
class _Camera:
    """What is remembered of one camera."""

    control: ViewControl
    state: EdgeState = field(default_factory=EdgeState)
    t_inferred_ns: int | None = None


def watch(
    rig: Rig,
    pictures: Iterable[Frame],
    ticks_ns: Sequence[int],
    networks: Networks,
    pace: Pace,
    config: FusionConfig,
    shown: Callable[[int], None] = lambda _: None,
) -> list[Event]:
    """Run the box over pictures.

    Args:
        rig: calibration; only pictures of its cameras may come.
        pictures: of all cameras, in the order of their time.
        ticks_ns: when fusion's output is due, ascending. Whatever arrives after the last one is lost.
        networks: what to run.
        pace: rates and delays.
        config: of fusion.
        shown: is told the instant of each tick.

    Returns:
        What fusion consumed, in its order: observations as they arrived, and the ticks.
    """
    plans, fusion = _Plans(rig, pace), initial_state(rig)
    events: list[Event] = []
    cameras = {name: _Camera(plans.first(name)) for name in rig.names}
    stages = Stages(time.thread_time_ns)
    for kind, t_ns, what in _timeline(
        pictures, ticks_ns, pace, lambda frame: _look(cameras[frame.camera], frame, networks, stages)
    ):
        if kind == _ARRIVAL and isinstance(what, Observation):
            events.append(what)
            fusion, _ = step(fusion, what, config)
        elif kind == _TICK:
            events.append(Tick(t_ns))
            fusion, output = step(fusion, Tick(t_ns), config)
            for name, control in plans.after_tick(fusion, output.searching, t_ns):
                cameras[name].control = control
            shown(t_ns)
    return events


class _Plans:
    """Writes the cameras' plans, as fusion's process does."""

    def __init__(self, rig: Rig, pace: Pace) -> None:
        self._rig, self._pace = rig, pace
        self._searching = dict.fromkeys(rig.names, True)
        self._ticks = count()

    def first(self, name: str) -> ViewControl:
        """Before fusion has said anything: everybody is looked for."""
        pace, position = self._pace, self._rig.index(name)
        offset_ns = pace.start_ns + turn_offset_ns(position, len(self._rig), pace.rate_hz)
        return ViewControl(name, 0, pace.start_ns, pace.rate_hz, offset_ns, pace.network, True, None)

    def after_tick(self, fusion: FusionState, searching: dict[str, bool], t_ns: int) -> Iterator[tuple[str, ViewControl]]:
        """The plans that are due after a tick."""
        self._searching = searching or self._searching
        number = next(self._ticks)
        if number % self._pace.ticks_a_plan:
            return
        predictions = predict_views(fusion, t_ns)
        for name in self._rig.names:
            first = self.first(name)
            search, prediction = self._searching.get(name, True), predictions[name]
            yield (
                name,
                ViewControl(name, number, t_ns, first.rate_hz, first.offset_ns, first.network, search, prediction),
            )


def _look(camera: _Camera, frame: Frame, networks: Networks, stages: Stages) -> Observation | None:
    """What the edge process does with a picture that it grabbed."""
    if not is_due(frame.t_mid_ns, camera.t_inferred_ns, camera.control):
        return None
    camera.t_inferred_ns = frame.t_mid_ns
    camera.state, observation = observe(camera.state, frame, networks, camera.control, _EDGE, stages)
    return observation


def _timeline(
    pictures: Iterable[Frame], ticks_ns: Sequence[int], pace: Pace, look: Callable[[Frame], Observation | None]
) -> Iterator[tuple[int, int, Observation | None]]:
    """Arrivals and ticks in the order of time; a picture is looked at, at its own instant, with what is known then."""
    numbers = count()
    waiting: list[tuple[int, int, int, Observation | None]] = [(t_ns, _TICK, next(numbers), None) for t_ns in ticks_ns]
    heapq.heapify(waiting)
    for frame in pictures:
        while waiting and waiting[0][:2] < (frame.t_mid_ns, _PICTURE):
            t_ns, kind, _, what = heapq.heappop(waiting)
            yield kind, t_ns, what
        observation = look(frame)
        if observation is not None:
            heapq.heappush(waiting, (frame.t_mid_ns + pace.delay_ns, _ARRIVAL, next(numbers), observation))
    last_ns = ticks_ns[-1] if ticks_ns else 0
    while waiting:
        t_ns, kind, _, what = heapq.heappop(waiting)
        if t_ns <= last_ns:
            yield kind, t_ns, what
