"""A room without cameras: the real tablet process on the bus in memory, and a person who walks because the test says so."""

import threading
import time
from dataclasses import dataclass, field, replace
from typing import Literal

import msgspec
import numpy as np

from models.camera.rig import Rig
from models.config.site import SITE_VERSION, CameraConfig, Site, TabletConfig
from models.messages import codec, topics
from models.messages.attempts import REMEMBERED, AttemptsBegin, FeedbackRequest
from models.messages.feedback import ANY, ActivityRequest, Feedback
from models.messages.health import (
    CameraHealth,
    EvaluationHealth,
    FusionHealth,
    Health,
    MachineHealth,
    RecorderHealth,
    ReplayHealth,
    Restarts,
    SupervisorHealth,
)
from models.messages.motion import CameraUse, JointState, Motion
from models.messages.pupil import NOBODY, PupilCorrections, PupilTurn
from models.messages.trouble import Trouble
from models.process import Bus, Delivery, Playback, ProcessContext, Resources
from models.skeleton import coco
from services.bus.memory import MemoryBus, MemoryRouter
from services.evaluation.memory import Memory
from services.tablet import process
from services.tablet.page import PAGE
from tests.browser.attempts import ending
from tests.integration.waiting import until
from tests.ports import free_port
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

CAMERAS = ("cam0", "cam1", "cam2", "cam3")
LIVE_HZ = 15.0
"""Half the rate of a box: software draws each of them."""
MACHINE = MachineHealth(2.9, 4.0, 3100.0, 41_000.0, 63.0, 1_700_000_000_000_000_000, 0.0)


@dataclass
class Scene:
    """What the synthetic fusion and cameras say from now on.

    Attributes:
        speed: of the person's time against the clock; 0 stands still and goes on being published.
        publishing: whether motions are sent at all.
        states: (17,) state of each joint.
        lost: cameras whose processes are gone.
        given_up: processes, by their names on the bus, that the supervisor starts no more.
        restarted: processes that the supervisor has started again.
        fresh_hz: inferences a second of every camera.
        pupil: what fusion says about the pupil.
        troubles: what fusion says is wrong.
        machine: what the supervisor measured of the machine.
        evaluating: what the evaluation sees the pupil do; None while there is none.
        recorded_s: length of the lesson that is being recorded; None while none is.
        recorder: whether the recorder says so; it may be hung, or dead, and go on later.
        replayed_s: how far the player is in a lesson that is played.
    """

    speed: float = 1.0
    publishing: bool = True
    states: dict[int, JointState] = field(default_factory=dict)
    lost: frozenset[str] = frozenset()
    given_up: frozenset[str] = frozenset()
    restarted: frozenset[str] = frozenset()
    fresh_hz: float = 14.6
    pupil: str = "found"
    troubles: tuple[Trouble, ...] = ()
    machine: MachineHealth = MACHINE
    evaluating: Literal["waiting", "moving", "unknown"] | None = "waiting"
    recorded_s: float | None = None
    recorder: bool = True
    replayed_s: float = 0.0


_OF_ATTEMPTS = (topics.feedback(), topics.attempts_begin(), topics.feedback_request(), topics.pupil_corrections())


@dataclass
class _Lesson:
    """What is being recorded."""

    began_ns: int
    attempts: list[int] = field(default_factory=list)

    def said(self, recorded_s: float) -> RecorderHealth:
        """As the recorder says it."""
        newest = tuple(self.attempts[-REMEMBERED:])
        return RecorderHealth("2026-11-22-7b", "7b, throwing", recorded_s, 2_500_000, 0, self.began_ns, len(self.attempts), newest)


class Room:
    """Bus, publishers and server of one synthetic room; `page` is where it is to be seen.

    Args:
        port: of the page; None for one that is free.
        person: who is in the room.
        playback: the lesson that is played in the place of a room, if one is.
    """

    def __init__(self, port: int | None = None, person: Person | None = None, playback: Playback | None = None) -> None:
        self.scene = Scene()
        self.played: Scene | None = None
        """The scene that was played last."""
        self.port = port or free_port()
        self.playback = playback
        self.person = person or Person(height_m=1.6, radius_m=0.7)
        self._router = MemoryRouter()
        self._fusion = self._router.open()
        self._evaluation: MemoryBus | None = None
        self._activity: tuple[str, Literal["site", "tablet"]] = (ANY, "site")
        self._turn = PupilTurn(NOBODY, 0)
        self._memory = Memory()
        self._lesson: _Lesson | None = None
        self._corrections = self._fusion.subscribe(topics.pupil_corrections(), keep=100)
        self._said_of_evaluation: object = None
        self._edges: dict[str, MemoryBus] = {}
        self._stop = threading.Event()
        self._server: _Server | None = None
        self._publisher = threading.Thread(target=self._publish, name="synthetic-room", daemon=True)

    @property
    def page(self) -> str:
        """Address of the page."""
        return f"http://127.0.0.1:{self.port}/"

    def __enter__(self) -> "Room":
        self._fusion.declare_alive(topics.alive("fusion"))
        self._publisher.start()
        self.start_server()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop_server()
        self._stop.set()
        self._publisher.join()
        self._fusion.close()

    def join_bus(self) -> MemoryBus:
        """One more bus of this room, as of another process."""
        return self._router.open()

    def start_server(self) -> None:
        """Have the tablet process listen."""
        self._server = _Server(self._router, self.port, self.playback)

    def stop_server(self) -> None:
        """End the tablet process, as when its box loses power."""
        if self._server is not None:
            self._server.stop()
            self._server = None

    def attempt(self, made: Feedback, ago_s: float = 0.4) -> int:
        """Let an attempt of whoever is up have ended so long ago; returns its id."""
        own = msgspec.structs.replace(made, pupil=made.pupil or self._turn.pupil)
        feedback = ending(own, time.monotonic_ns() - round(ago_s * 1e9))
        self._fusion.publish(topics.feedback(), codec.encode(feedback))
        return feedback.id

    @property
    def activity(self) -> str:
        """What the synthetic evaluation was asked for; empty for any action."""
        return self._activity[0]

    @property
    def pupil(self) -> str:
        """Who is up as the synthetic evaluation was told; empty for nobody."""
        return self._turn.pupil

    def corrections(self) -> list[PupilCorrections]:
        """What was corrected since this was asked last, for the lesson."""
        found = []
        while (delivery := self._corrections.receive(0.0)) is not None:
            found.append(codec.decode(delivery.payload, PupilCorrections))
        return found

    def _publish(self) -> None:
        asked = self._fusion.subscribe(topics.activity_request(), keep=4)
        called = self._fusion.subscribe(topics.pupil_turn(), keep=100)
        told = self._fusion.subscribe(*_OF_ATTEMPTS, keep=100)
        sequence, t_person_s, healthy_ns = 0, 0.0, 0
        while not self._stop.wait(1 / LIVE_HZ):
            scene = self.scene
            now_ns = time.monotonic_ns()
            t_person_s += scene.speed / LIVE_HZ
            if scene.publishing:
                motion = self._motion(scene, sequence, t_person_s, now_ns)
                self._fusion.publish(topics.motion("live"), codec.encode(motion))
                sequence += 1
            self._keep_edges(scene)
            while (request := asked.receive(0.0)) is not None:
                self._activity = codec.decode(request.payload, ActivityRequest).activity, "tablet"
            while (call := called.receive(0.0)) is not None:
                turn = codec.decode(call.payload, PupilTurn)
                self._turn = turn if turn.t_ns > self._turn.t_ns else self._turn
            self._keep_lesson(scene, now_ns)
            while (delivery := told.receive(0.0)) is not None:
                self._keep_attempts(delivery)
            self._keep_evaluation(scene, now_ns)
            if now_ns - healthy_ns > 1_000_000_000:
                healthy_ns = now_ns
                self._publish_health(scene, now_ns)
            self.played = scene

    def _motion(self, scene: Scene, sequence: int, t_person_s: float, now_ns: int) -> Motion:
        states = np.full(coco.COUNT, JointState.SEEN, np.uint8)
        for joint, state in scene.states.items():
            states[joint] = state
        known = states[:, None] != JointState.UNKNOWN
        joints_m = np.where(known, self.person.joints(t_person_s), 0.0).astype(np.float32)
        t_newest_ns = now_ns - 95_000_000
        return Motion(
            kind="live",
            sequence=sequence,
            epoch=0,
            t_ns=t_newest_ns - 20_000_000,
            t_newest_ns=t_newest_ns,
            t_published_ns=now_ns,
            joints_m=joints_m,
            covariance_m2=np.tile(np.eye(3, dtype=np.float32) * np.float32(1.2e-4), (coco.COUNT, 1, 1)),
            states=states,
            views=np.where(states == JointState.SEEN, 0b1111, 0).astype(np.uint32),
            cameras=tuple(CameraUse(camera, camera not in scene.lost, 40.0) for camera in CAMERAS),
        )

    def _keep_edges(self, scene: Scene) -> None:
        for camera in CAMERAS:
            if camera in scene.lost and camera in self._edges:
                self._edges.pop(camera).close()
            elif camera not in scene.lost and camera not in self._edges:
                self._edges[camera] = self._router.open()
                self._edges[camera].declare_alive(topics.alive(f"edge-{camera}"))

    def _keep_evaluation(self, scene: Scene, now_ns: int) -> None:
        if scene.evaluating is None:
            if self._evaluation is not None:
                self._evaluation.close()
                self._evaluation = None
                # It knows of nothing when it is started again.
                self._turn, self._memory, self._activity = PupilTurn(NOBODY, 0), Memory(), (ANY, "site")
            return
        if self._evaluation is None:
            self._evaluation = self._router.open()
            self._evaluation.declare_alive(topics.alive("evaluation"))
        # Said at once when it changes, and else about once a second.
        memory = self._memory
        listed = (memory.since_ns, memory.count, memory.newest)
        news = (*self._activity, self._turn, scene.evaluating, *listed, now_ns // 1_000_000_000)
        if news == self._said_of_evaluation:
            return
        self._said_of_evaluation = news
        turn = self._turn
        health = EvaluationHealth(*self._activity, scene.evaluating, 0, 0.4, 31.0, 0, 0, turn.pupil, turn.t_ns, *listed)
        self._say(self._evaluation, Health("evaluation", 97, now_ns, "ok", (), 0.05, 150.0, evaluation=health))

    def _keep_attempts(self, delivery: Delivery) -> None:
        """The evaluation remembers and the recorder writes what was published."""
        memory = self._memory
        if delivery.topic == topics.feedback():
            feedback = codec.decode(delivery.payload, Feedback)
            memory.note(feedback)
            if self._lesson is not None:
                self._lesson.attempts.append(feedback.id)
        elif self._evaluation is None:
            return
        elif delivery.topic == topics.attempts_begin():
            memory.begin(codec.decode(delivery.payload, AttemptsBegin))
        elif delivery.topic == topics.pupil_corrections():
            memory.correct(codec.decode(delivery.payload, PupilCorrections).corrections)
        else:
            answer = memory.before(codec.decode(delivery.payload, FeedbackRequest).before)
            self._evaluation.publish(topics.remembered_feedback(), codec.encode(answer))

    def _keep_lesson(self, scene: Scene, now_ns: int) -> None:
        if scene.recorded_s is None:
            self._lesson = None
        elif self._lesson is None:
            self._lesson = _Lesson(now_ns)

    def _publish_health(self, scene: Scene, now_ns: int) -> None:
        for index, (camera, bus) in enumerate(self._edges.items()):
            rates = CameraHealth(camera, 30.0, scene.fresh_hz - 0.3 * index, 15.0, 12 + 7 * index, 21.0 + 3 * index, "thunder", {})
            self._say(bus, Health(f"edge-{camera}", 100 + index, now_ns, "ok", (), 0.36, 214.0, camera=rates))
        restarts = (
            *(Restarts(name, 5, now_ns, "was ended by SIGKILL", "ended 6 times") for name in sorted(scene.given_up)),
            *(Restarts(name, 1, now_ns, "was ended by SIGKILL", "") for name in sorted(scene.restarted)),
        )
        supervisor = SupervisorHealth("0.1.0", now_ns, restarts)
        for name in scene.given_up:
            self._say(self._fusion, Health(name, 98, now_ns, "failed", (Trouble("given_up", "ended 6 times"),), 0.0, 0.0))
        said = Health("supervisor", 98, now_ns, "ok", (), 0.01, 30.0, machine=scene.machine, supervisor=supervisor)
        self._say(self._fusion, said)
        fusion = FusionHealth(29.8, 4.2, 0.83, 0, {}, "found" if scene.pupil == "found" else "searching")
        lesson = self._lesson
        recorder = RecorderHealth("", "", 0.0, 0, 0) if lesson is None else lesson.said(scene.recorded_s or 0.0)
        if scene.recorder:
            self._say(self._fusion, Health("recorder", 98, now_ns, "ok", (), 0.01, 60.0, recorder=recorder))
        if self.playback is not None:
            played = ReplayHealth(scene.replayed_s, 60.0, 1.0)
            self._say(self._fusion, Health("replay", 96, now_ns, "ok", (), 0.2, 180.0, replay=played))
        if "fusion" not in scene.given_up:
            self._say(
                self._fusion,
                Health("fusion", 99, now_ns, "degraded" if scene.troubles else "ok", scene.troubles, 0.21, 186.0, fusion=fusion),
            )

    def _say(self, bus: MemoryBus, health: Health) -> None:
        bus.publish(topics.health(health.process), codec.encode(health))


def tablet_context(bus: Bus, port: int, stop: threading.Event) -> ProcessContext:
    """What the tablet process of such a room is given."""
    return ProcessContext(
        name="tablet",
        camera=None,
        site=_site(port),
        rig=_rig(),
        data=PAGE,
        start_ns=time.monotonic_ns(),
        bus=bus,
        stop=stop,
        resources=lambda: Resources(0.03, 61.0),
    )


class _Server:
    """The tablet process in a thread of its own."""

    def __init__(self, router: MemoryRouter, port: int, playback: Playback | None) -> None:
        self._bus = router.open()
        self._stop = threading.Event()
        context = replace(tablet_context(self._bus, port, self._stop), playback=playback)
        self._thread = threading.Thread(target=process.main, args=(context,), name="tablet-server", daemon=True)
        self._thread.start()
        _wait_until_joined(router, self._thread)

    def stop(self) -> None:
        self._stop.set()
        self._thread.join()
        self._bus.close()


def _rig() -> Rig:
    return ring_rig(len(CAMERAS))


def _site(port: int) -> Site:
    cameras = [CameraConfig(name=name, kind="video", path=f"{name}.mp4") for name in CAMERAS]
    return Site(
        version=SITE_VERSION,
        name="Gym of the village school",
        calibration="calibration.toml",
        cameras=cameras,
        tablet=TabletConfig(host="127.0.0.1", port=port),
    )


def _wait_until_joined(router: MemoryRouter, thread: threading.Thread) -> None:
    # It listens earlier than it subscribes: nobody would hear what is said in between.
    deadline_s = time.monotonic() + 30
    while time.monotonic() < deadline_s and thread.is_alive():
        if topics.alive("tablet") in router.tokens():
            return
        time.sleep(0.02)
    raise RuntimeError("the tablet process does not join the bus")


def with_scene(room: Room, **changes: object) -> None:
    """Change what the room says, in one step, and wait until it has said so: the next change may undo this one."""
    room.scene = scene = replace(room.scene, **changes)  # type: ignore[arg-type]
    until(lambda: room.played is scene, "the room to play its new scene")
