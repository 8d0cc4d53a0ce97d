"""The box without clock and sockets, as benches run it: turns, delays and plans as the processes have them."""

from dataclasses import dataclass

import cv2
import numpy as np
import pytest

from edge.cameras.video import Schedule
from models.arrays import UInt8
from models.messages.observation import Observation
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick
from tests.bench.closed_loop import Event, Pace, watch
from tests.fake_networks import fake_networks
from tests.synthetic.gym import ring_rig

pytestmark = pytest.mark.slow

RIG = ring_rig(4)
START_NS = 1_000_000_000
PERIOD_NS = 1_000_000_000 // 30
TICKS = [Schedule(START_NS, 0, 30.0).t_ns(k) for k in range(30)]


@dataclass(frozen=True)
class Spot:
    """A picture with something bright in it."""

    camera: str
    index: int
    t_mid_ns: int
    size_px: tuple[int, int]
    epoch: int = 0

    def image(self, reduction: int = 1) -> UInt8:
        image = np.zeros((self.size_px[1], self.size_px[0], 3), np.uint8)
        cv2.circle(image, (self.size_px[0] // 2, self.size_px[1] // 2), 30, (255, 255, 255), -1)
        return image[::reduction, ::reduction]


def pictures(phases_ns: tuple[int, ...] = (0, 0, 0, 0)) -> list[Spot]:
    spots = [
        Spot(camera.name, k, TICKS[k] + phase, camera.size_px)
        for camera, phase in zip(RIG, phases_ns, strict=True)
        for k in range(30)
    ]
    return sorted(spots, key=lambda spot: spot.t_mid_ns)


def run(pace: Pace, spots: list[Spot]) -> list[Event]:
    return watch(RIG, spots, TICKS, fake_networks()[0], pace, PRESETS["default"])


def looked_at(events: list[Event], camera: str) -> list[int]:
    return [event.t_mid_ns for event in events if isinstance(event, Observation) and event.camera == camera]


def test_every_camera_is_looked_at_at_the_live_rate_and_in_its_turn() -> None:
    events = run(Pace(15.0, "thunder", START_NS), pictures())
    frames = {camera.name: [(t - START_NS) // PERIOD_NS for t in looked_at(events, camera.name)] for camera in RIG}
    assert all(14 <= len(numbers) <= 16 for numbers in frames.values())
    turns = list(frames.values())
    assert set(np.diff(turns[0])) == {2}
    assert not set(turns[0][1:]) & set(turns[1][1:]), "neighbours in the turn take different pictures"


def test_an_observation_reaches_fusion_after_its_delay_and_keeps_its_own_time() -> None:
    delay_ns = 60_000_000
    events = run(Pace(30.0, "thunder", START_NS, delay_ns), pictures((0, 3_000_000, 7_000_000, 20_000_000)))
    now_ns = 0
    for event in events:
        if isinstance(event, Tick):
            now_ns = event.t_ns
        else:
            assert now_ns <= event.t_mid_ns + delay_ns, "it came after a tick that should have had it"
            assert event.t_mid_ns + delay_ns <= now_ns + PERIOD_NS + 1, "it came before its time"
    assert [event.t_ns for event in events if isinstance(event, Tick)] == TICKS
    assert looked_at(events, RIG.names[1])[5] == TICKS[5] + 3_000_000


def test_what_arrives_after_the_last_tick_is_lost() -> None:
    events = run(Pace(30.0, "thunder", START_NS, 2_000_000_000), pictures())
    assert len(events) == len(TICKS)


def test_a_run_repeats_itself() -> None:
    pace = Pace(10.0, "thunder", START_NS, 40_000_000, ticks_a_plan=3)
    assert [repr(event) for event in run(pace, pictures())] == [repr(event) for event in run(pace, pictures())]
