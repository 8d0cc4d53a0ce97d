"""The loop of an edge process over the in-memory bus, with fake networks and a real clock."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from edge.cameras.jpeg import JpegFrame
from edge.cameras.source import MonotonicClock
from edge.cameras.video import Schedule, Video, VideoSource
from edge.library import Library
from edge.process import EdgeLoop, main, stage_clock
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.config.site import SITE_VERSION, CameraConfig, Site
from models.errors import UserError
from models.messages import codec, topics
from models.messages.control import PoseNetwork, ViewControl
from models.messages.health import CameraHealth, Health
from models.messages.observation import Observation
from models.process import Delivery, ProcessContext, Resources, Subscription
from services.bus.memory import MemoryBus, MemoryRouter
from tests.fake_networks import FakeDetector, FakePose
from tests.small_video import spot_picture, video_of, write_video

NAMES = ("cam01", "cam02")
SECOND_NS = 1_000_000_000
DEADLINE_S = 60.0


def moving_spot(passes: int) -> Video:
    """A spot that crosses the picture in 20 pictures and back in 20 more, so many times."""
    there = [spot_picture(np.array((100 + 4.0 * k, 110)), 6.0, (320, 240)) for k in range(20)]
    return video_of((there + there[::-1]) * passes)


def played(context: ProcessContext, passes: int) -> VideoSource:
    return VideoSource(moving_spot(passes), Schedule(context.start_ns, 0, 30.0), MonotonicClock())


def context_for(bus: MemoryBus, data: Path, path: str = "cam01.avi", camera: str = "cam01") -> ProcessContext:
    one = Camera("cam01", (320, 240), np.diag((300.0, 300.0, 1.0)), np.zeros(5), np.eye(3), np.zeros(3), np.zeros(2))
    return ProcessContext(
        name=f"edge-{camera}",
        camera=camera,
        site=Site(
            version=SITE_VERSION,
            name="test",
            calibration="rig.toml",
            cameras=[CameraConfig(name=n, kind="video", path=path) for n in NAMES],
        ),
        rig=Rig(tuple(replace(one, name=name) for name in NAMES)),
        data=data,
        start_ns=time.monotonic_ns(),
        bus=bus,
        stop=threading.Event(),
        resources=lambda: Resources(0.25, 64.0),
    )


@dataclass
class Box:
    """A loop that runs, and a listener beside it."""

    context: ProcessContext
    control_bus: MemoryBus
    observations: Subscription
    healths: Subscription
    sequence: int = 0
    received: list[Observation] = field(default_factory=list)

    def next_observation(self) -> Observation:
        self.received.append(codec.decode(wait(self.observations).payload, Observation))
        return self.received[-1]

    def until(self, condition: Callable[[Observation], bool]) -> Observation:
        deadline = time.monotonic() + DEADLINE_S
        while time.monotonic() < deadline:
            if condition(self.next_observation()):
                return self.received[-1]
        pytest.fail("waited in vain")

    def health_until(self, condition: Callable[[Health, CameraHealth], bool], plan_hz: float | None = None) -> CameraHealth:
        """The first health that fulfils the condition, renewing a plan meanwhile."""
        deadline = time.monotonic() + DEADLINE_S
        while time.monotonic() < deadline:
            if plan_hz is not None:
                self.plan(plan_hz)
            health = codec.decode(wait(self.healths).payload, Health)
            assert health.camera is not None
            if condition(health, health.camera):
                return health.camera
        pytest.fail("waited in vain")

    def plan(self, rate_hz: float, network: PoseNetwork = "thunder", search: bool = True) -> None:
        self.sequence += 1
        now_ns = time.monotonic_ns()
        control = ViewControl("cam01", self.sequence, now_ns, rate_hz, self.context.start_ns, network, search, None)
        self.control_bus.publish(topics.control("cam01"), codec.encode(control))


def told(health: Health) -> set[str]:
    return {trouble.code for trouble in health.troubles}


def wait(subscription: Subscription) -> Delivery:
    delivery = subscription.receive(DEADLINE_S)
    assert delivery is not None, "nothing came"
    return delivery


@contextmanager
def running(tmp_path: Path, make_source: Callable[[ProcessContext], VideoSource] | None = None) -> Iterator[Box]:
    router = MemoryRouter()
    listener, own = router.open(), router.open()
    observations = listener.subscribe(topics.observation("cam01"), keep=100)
    healths = listener.subscribe(topics.health("edge-cam01"), keep=10)
    context = context_for(own, tmp_path)
    source = make_source(context) if make_source else played(context, passes=30)
    loop = EdgeLoop(context, source, Library(FakePose, FakeDetector, "thunder"), MonotonicClock())
    thread = threading.Thread(target=loop.run, daemon=True)
    thread.start()
    try:
        yield Box(context, listener, observations, healths)
    finally:
        context.stop.set()
        thread.join(DEADLINE_S)
        assert not thread.is_alive(), "the loop did not honour stop"


@pytest.mark.slow
def test_before_any_plan_the_camera_is_looked_at_ten_times_a_second_of_its_own_time(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        seen = [box.next_observation() for _ in range(8)]
    turns = [(observation.t_mid_ns - box.context.start_ns) * 10 // SECOND_NS for observation in seen]
    assert len(set(turns)) == len(turns)
    assert turns == sorted(turns)
    assert [observation.sequence for observation in seen] == list(range(8))
    assert all(observation.network == "thunder" and observation.t_published_ns > observation.t_mid_ns for observation in seen)
    assert any(observation.persons for observation in seen)


@pytest.mark.slow
def test_loops_are_epochs_and_frames_are_stamped_by_the_shared_start(tmp_path: Path) -> None:
    with running(tmp_path, lambda context: played(context, passes=1)) as box:
        box.plan(30.0)
        last = box.until(lambda observation: observation.epoch >= 1)
    assert last.persons == () or last.persons[0].track > 0
    for observation in box.received:
        picture = 40 * observation.epoch + observation.frame
        assert abs(observation.t_mid_ns - box.context.start_ns - picture * SECOND_NS / 30) <= 1


@dataclass
class ManualClock:
    """Time passes only while somebody sleeps, so no stall of the machine lets a picture be missed."""

    t_ns: int

    def now_ns(self) -> int:
        return self.t_ns

    def sleep_until(self, t_ns: int) -> None:
        self.t_ns = max(self.t_ns, t_ns)


class Ending(VideoSource):
    """Sets `stop` with the first picture of epoch 4."""

    def __init__(self, video: Video, schedule: Schedule, clock: ManualClock, stop: threading.Event) -> None:
        super().__init__(video, schedule, clock)
        self._stop = stop

    def grab(self, timeout_s: float) -> JpegFrame | None:
        frame = super().grab(timeout_s)
        if frame is not None and frame.epoch == 4:
            self._stop.set()
        return frame


def test_the_first_picture_of_an_epoch_is_looked_at_out_of_turn(tmp_path: Path) -> None:
    router = MemoryRouter()
    listener = router.open()
    observations = listener.subscribe(topics.observation("cam01"), keep=200)
    context = context_for(router.open(), tmp_path)
    clock = ManualClock(context.start_ns)
    spot = [spot_picture(np.array((100 + 4.0 * k, 110)), 6.0, (320, 240)) for k in range(20)]
    source = Ending(video_of(spot), Schedule(context.start_ns, 0, 30.0), clock, context.stop)
    loop = EdgeLoop(context, source, Library(FakePose, FakeDetector, "thunder", clock), clock)
    # One turn lasts 100 s, the run 2.7 s, less than a plan's life: only the run's first picture has its turn.
    plan = ViewControl("cam01", 1, context.start_ns, 0.01, context.start_ns, "thunder", True, None)
    listener.publish(topics.control("cam01"), codec.encode(plan))
    loop.run()
    seen = []
    while (delivery := observations.receive(0.0)) is not None:
        observation = codec.decode(delivery.payload, Observation)
        seen.append((observation.epoch, observation.frame))
    assert seen == [(epoch, 0) for epoch in range(5)]


@pytest.mark.slow
def test_a_plan_changes_the_rate_and_an_idle_one_stops_the_networks(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        box.health_until(lambda _, camera: camera.target_hz == 5.0, plan_hz=5.0)
        idle = box.health_until(lambda _, camera: camera.target_hz == 0.0 and camera.fresh_hz == 0.0, plan_hz=0.0)
    assert idle.source_hz > 0


@pytest.mark.slow
def test_a_plan_for_another_network_is_followed_without_a_gap(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        box.next_observation()
        box.plan(10.0, "lightning")
        box.until(lambda observation: observation.network == "lightning")
    assert [observation.sequence for observation in box.received] == list(range(len(box.received)))


@pytest.mark.slow
def test_a_message_that_is_no_plan_is_reported_and_does_no_harm(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        box.control_bus.publish(topics.control("cam01"), b"\x01\x03nonsense")
        box.health_until(lambda health, _: told(health) == {"plans_refused"})
        box.health_until(lambda health, _: health.state == "ok")


@pytest.mark.slow
def test_a_plan_that_cannot_be_read_is_counted_in_health_although_a_good_one_follows_at_once(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        for _ in range(20):
            box.control_bus.publish(topics.control("cam01"), b"nonsense")
            box.next_observation()  # The loop goes round, and takes it.
            box.plan(10.0)
            box.next_observation()
        box.health_until(lambda health, _: told(health) == {"plans_refused"}, plan_hz=10.0)


@pytest.mark.slow
def test_a_plan_that_waited_too_long_is_void_and_nothing_is_wrong(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        box.health_until(lambda _, camera: camera.target_hz == 5.0, plan_hz=5.0)
        old = ViewControl("cam01", 9, time.monotonic_ns() - 100 * SECOND_NS, 25.0, 0, "thunder", True, None)
        box.control_bus.publish(topics.control("cam01"), codec.encode(old))
        seen: list[tuple[float, set[str]]] = []

        def over(health: Health, camera: CameraHealth) -> bool:
            seen.append((camera.target_hz, told(health)))
            return camera.target_hz == 10.0  # the default, once fusion has fallen silent

        box.health_until(over)
    assert all(rate_hz != 25.0 and "plans_refused" not in codes for rate_hz, codes in seen)


@pytest.mark.slow
def test_health_names_the_camera_and_the_process_is_alive_until_it_leaves(tmp_path: Path) -> None:
    changes: list[tuple[str, bool]] = []
    with running(tmp_path) as box:
        box.control_bus.watch_alive(topics.ALL_ALIVE, lambda topic, alive: changes.append((topic, alive)))
        health = codec.decode(wait(box.healths).payload, Health)
        box.context.stop.set()
    assert changes == [(topics.alive("edge-cam01"), True)]
    camera = health.camera
    assert camera is not None
    assert (health.process, health.state, health.cpu_cores, health.rss_mib) == ("edge-cam01", "ok", 0.25, 64.0)
    assert (camera.camera, camera.network, camera.target_hz) == ("cam01", "thunder", 10.0)
    assert camera.source_hz > 0
    assert {"decode", "crop", "pose", "encode"} <= set(camera.stage_ms)


class Flawed(VideoSource):
    """Every third picture arrives damaged."""

    def grab(self, timeout_s: float) -> JpegFrame | None:
        frame = super().grab(timeout_s)
        return replace(frame, data=frame.data[:300]) if frame is not None and frame.index % 3 == 0 else frame


@pytest.mark.slow
def test_damaged_pictures_are_reported_and_the_others_are_used(tmp_path: Path) -> None:
    def flawed(context: ProcessContext) -> VideoSource:
        return Flawed(moving_spot(passes=30), Schedule(context.start_ns, 0, 30.0), MonotonicClock())

    with running(tmp_path, flawed) as box:
        box.plan(30.0)
        box.health_until(lambda health, _: health.state == "degraded" and told(health) == {"pictures_damaged"})
        assert box.next_observation().frame % 3 != 0


def test_with_onnxruntime_a_stage_is_not_charged_what_another_thread_spends_and_with_openvino_it_is() -> None:
    spent_ns = []

    def load() -> None:
        while time.thread_time_ns() < 50_000_000:
            pass
        spent_ns.append(time.thread_time_ns())

    clocks = [stage_clock("cpu"), stage_clock("openvino")]
    begins_ns = [clock() for clock in clocks]
    thread = threading.Thread(target=load)
    thread.start()
    thread.join()
    charged_ns, charged_openvino_ns = (clock() - begin_ns for clock, begin_ns in zip(clocks, begins_ns, strict=True))
    assert charged_ns < 0.5 * spent_ns[0]
    assert charged_openvino_ns > 0.9 * spent_ns[0]


def test_a_missing_file_ends_the_process_with_one_line_that_names_it(tmp_path: Path) -> None:
    bus = MemoryRouter().open()
    with pytest.raises(UserError, match=r"camera 'cam01'.*footage/none\.avi is missing"):
        main(context_for(bus, tmp_path, path="footage/none.avi"))
    assert bus.tokens == set()


def test_pictures_of_another_size_than_the_calibrated_end_the_process(tmp_path: Path) -> None:
    write_video(tmp_path / "cam01.avi", frames=3, size_px=(160, 96))
    with pytest.raises(UserError, match=r"camera 'cam01'.*cam01\.avi are 160x96, but the calibration is for 320x240"):
        main(context_for(MemoryRouter().open(), tmp_path))


def test_a_camera_that_the_site_does_not_know_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="camera 'cam09' is not in the site file"):
        main(context_for(MemoryRouter().open(), tmp_path, camera="cam09"))
