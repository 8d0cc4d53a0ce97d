"""Fusion's loop on a machine that stops it for moments at a time: what came in meanwhile is of now, and no camera is to blame."""

import threading
from pathlib import Path
from types import SimpleNamespace

import msgspec
import pytest

from models.messages import codec, topics
from models.messages.lesson import FusionLog, SegmentRequest
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from models.process import Delivery, Subscription
from services.bus.mailbox import Mailbox
from services.fusion import process
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, step
from services.support.cpu import CpuMeter
from tests.mutations.feed import FeedBus, context_of
from tests.mutations.samples import RIG, observation
from tests.synthetic.gym import T0_NS
from tests.virtual_clock import VirtualClock

MS = 1_000_000
LATENCY_NS = 40 * MS
EVERY_NS = 66 * MS
SECONDS = 4.0
STALLS = ((1500, 450), (2050, 450), (2600, 450), (3100, 300))
"""When fusion is stopped, and for how long, in milliseconds."""


class Machine:
    """The mailbox of fusion's loop, whose cameras go on while it is stopped itself."""

    def __init__(self, clock: VirtualClock, stop: threading.Event) -> None:
        self._clock = clock
        self._stop = stop
        self._mailbox = Mailbox(process.KEEP)
        taken = [
            (T0_NS + k * EVERY_NS + index * EVERY_NS // len(RIG), index, k)
            for k in range(round(SECONDS * 1e9 / EVERY_NS))
            for index in range(len(RIG))
        ]
        self._coming = [(t_ns + LATENCY_NS, observation(index, t_ns, k)) for t_ns, index, k in taken]
        self._stalls = [(T0_NS + at * MS, length * MS) for at, length in STALLS]
        self._mailbox.put(topics.segment_request(), codec.encode(SegmentRequest(T0_NS)))

    def receive(self, timeout_s: float) -> Delivery | None:
        delivery = self._arrived()
        if delivery is None:
            next_ns = self._coming[0][0] if self._coming else T0_NS + round(SECONDS * 1e9)
            self._clock.sleep_until(min(self._clock.t_ns + round(timeout_s * 1e9), next_ns))
            while self._stalls and self._stalls[0][0] <= self._clock.t_ns:
                self._clock.t_ns += self._stalls.pop(0)[1]
            delivery = self._arrived()
        if not self._coming and delivery is None:
            self._stop.set()
        return delivery

    def close(self) -> None:
        self._mailbox.close()

    def _arrived(self) -> Delivery | None:
        while self._coming and self._coming[0][0] <= self._clock.t_ns:
            _, seen = self._coming.pop(0)
            self._mailbox.put(topics.observation(seen.camera), codec.encode(seen))
        return self._mailbox.receive(0.0)


class MachineBus(FeedBus):
    """Keeps fusion's log."""

    def __init__(self, machine: Machine, stop: threading.Event) -> None:
        super().__init__((), stop)
        self._machine = machine
        self.log: list[FusionLog] = []

    def publish(self, topic: str, payload: bytes) -> None:
        super().publish(topic, payload)
        if topic == topics.fusion_log():
            self.log.append(codec.decode(payload, FusionLog))

    def subscribe(self, *_topics: str, keep: int) -> Subscription:
        assert keep == process.KEEP
        return self._machine


@pytest.fixture
def held_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> MachineBus:
    """What fusion has published on that machine."""
    clock, stop = VirtualClock(T0_NS), threading.Event()
    monkeypatch.setattr(process, "time", SimpleNamespace(monotonic_ns=clock.now_ns, thread_time_ns=clock.now_ns))
    bus = MachineBus(Machine(clock, stop), stop)
    process.FusionLoop(context_of("fusion", bus, stop, tmp_path), CpuMeter()).run()
    return bus


def test_no_camera_is_said_to_be_wrong_because_fusion_was_held_up(held_up: MachineBus) -> None:
    said = [health.fusion for health in held_up.healths if health.fusion is not None]
    assert len(said) >= 2
    assert [fusion.ignored for fusion in said] == [{}] * len(said)
    assert not [trouble for health in held_up.healths for trouble in health.troubles if trouble.code == "pictures_not_fused"]


def test_what_fusion_did_while_it_was_held_up_replays_to_the_last_bit(held_up: MachineBus) -> None:
    state, logged, again = initial_state(RIG), [], []
    for entry in (entry for part in held_up.log for entry in part.entries):
        if entry.kind == "motion":
            logged.append(codec.decode(entry.payload, Motion))
            continue
        event = Tick(entry.t_ns) if entry.kind == "tick" else codec.decode(entry.payload, Observation)
        state, output = step(state, event, PRESETS["default"])
        assert output.ignored is None
        again += [motion for motion in output.motions if motion.kind == "smooth"]
    assert len(logged) > 40
    assert (logged[-1].states == JointState.SEEN).all()
    assert [bare(motion) for motion in logged] == [bare(motion) for motion in again]


def bare(motion: Motion) -> bytes:
    """Without the time of publishing, which is the clock's."""
    return codec.encode(msgspec.structs.replace(motion, t_published_ns=0))
