"""The fusion process: observations in; motion, view control and health out. Thin: all thinking is in `pipeline` and `governor`."""

import time
from dataclasses import dataclass, field

import msgspec
import structlog

from models.messages import codec, topics
from models.messages.addressed import read_health, read_observation
from models.messages.control import ViewControl
from models.messages.feedback import Feedback
from models.messages.health import CameraHealth, FusionHealth
from models.messages.lesson import SegmentRequest
from models.messages.motion import Motion
from models.messages.observation import Observation
from models.messages.pupil import PupilCorrections
from models.messages.trouble import Trouble, messages_refused
from models.process import Delivery, ProcessContext
from services.fusion import governor
from services.fusion.agreement import Agreement, Disagreement
from services.fusion.config import PRESETS
from services.fusion.governor import GovernorState, Load
from services.fusion.log import SegmentLog
from services.fusion.pipeline import FusionOutput, Ignored, Tick, initial_state, predict_views, step
from services.fusion.warm_up import warm_up
from services.support.cpu import CpuMeter
from services.support.health import HealthReporter

KEEP = 2
"""Unread messages of each topic; older ones would only show the past."""
CONTROL_EVERY_TICKS = 3
SECOND_NS = 1_000_000_000
CAMERA_SILENT_NS = 3 * SECOND_NS
"""A camera whose health is older than this takes no part in the governor's plan."""

_LATE_AT_SEAM = 2
_EPOCHS = "the cameras count their films' loops differently: start the box anew; if it stays so, cut the films to one length"
_CLOCK = "its clock is wrong: unplug it and plug it in again"
_IGNORED: dict[Ignored, Trouble] = {
    "not_calibrated": Trouble("pictures_not_fused", "are of a camera that is not in the calibration", "calibrate it"),
    "of_the_future": Trouble("pictures_not_fused", "are from the future", _CLOCK),
    "of_a_lone_epoch": Trouble("epochs_differ", "are of an epoch that no other camera shows", _EPOCHS),
    "beyond_its_epoch": Trouble("epochs_differ", "are beyond their epoch's end", _EPOCHS),
    "of_a_past_epoch": Trouble("epochs_differ", "are of a past epoch", _EPOCHS),
}
"""What is said of a camera whose pictures are not fused."""

log = structlog.get_logger()


def prepare() -> None:
    """Have every kernel ready, before anybody waits for a figure."""
    warm_up()


def main(context: ProcessContext) -> None:
    """Serve until told to stop."""
    FusionLoop(context, CpuMeter()).run()


@dataclass
class _Second:
    """Counted between two health messages."""

    began_ns: int
    live: int = 0
    ticks: int = 0
    spent_ns: int = 0
    rejected: int = 0
    ignored_before: dict[tuple[str, Ignored], int] = field(default_factory=dict)

    def ignored(self, total: dict[tuple[str, Ignored], int]) -> dict[tuple[str, Ignored], int]:
        """Observations that were not fused since the second began, by camera and reason."""
        new = {key: count - self.ignored_before.get(key, 0) for key, count in total.items()}
        return {key: count for key, count in new.items() if count}


class FusionLoop:
    """The loop of `main`, with everything from outside passed in."""

    def __init__(self, context: ProcessContext, cpu: CpuMeter) -> None:
        self._context = context
        self._bus = context.bus
        self._cpu = cpu
        self._config = PRESETS[context.site.fusion.preset]
        self._state = initial_state(context.rig)
        self._log = SegmentLog()
        self._agreement = Agreement(context.rig, self._config.sighting)
        self._governor = GovernorState()
        self._names = context.rig.names
        self._observations = {topics.observation(name) for name in self._names}
        self._searching: dict[str, bool] = {}
        self._found = False
        self._cameras: dict[str, tuple[int, CameraHealth]] = {}
        self._ticks = 0
        self._controls = 0
        self._reporter = HealthReporter(context.name, context.bus, context.resources)
        self._began_ns = time.monotonic_ns()
        self._second = _Second(self._began_ns)

    def run(self) -> None:
        """Take observations as they come and tick at the live rate.

        Of ticks that were missed only the newest is made up for, and before anything is taken in: seen from a tick that is long
        past, what came in while this process was held up would be of the future.
        """
        self._bus.declare_alive(topics.alive(self._context.name))
        heard = (topics.ALL_HEALTH, topics.feedback(), topics.pupil_corrections(), topics.segment_request())
        subscription = self._bus.subscribe(*sorted(self._observations), *heard, keep=KEEP)
        period_ns = round(SECOND_NS / self._context.site.fusion.live_hz)
        tick_ns = time.monotonic_ns()
        try:
            while not self._context.stop.is_set():
                self._context.beat()
                delivery = subscription.receive(max((tick_ns - time.monotonic_ns()) * 1e-9, 0.0))
                now_ns = time.monotonic_ns()
                if now_ns >= tick_ns:
                    tick_ns += (now_ns - tick_ns) // period_ns * period_ns
                    self._tick(tick_ns, now_ns)
                    tick_ns += period_ns
                if delivery is not None:
                    self._receive(delivery)
        finally:
            subscription.close()

    def _tick(self, tick_ns: int, now_ns: int) -> None:
        self._step(Tick(tick_ns))
        # A first plan would be made up: cameras that run already go on with their last one meanwhile.
        if self._governor.started and self._ticks % CONTROL_EVERY_TICKS == 0:
            self._control(now_ns)
        if (part := self._log.part(now_ns)) is not None:
            self._bus.publish(topics.fusion_log(), codec.encode(part))
        self._ticks += 1
        if now_ns - self._second.began_ns >= SECOND_NS:
            self._second_passed(now_ns)

    def _receive(self, delivery: Delivery) -> None:
        now_ns = time.monotonic_ns()
        try:
            if delivery.topic in self._observations:
                observation = read_observation(delivery.topic, delivery.payload)
                self._log.add("observation", now_ns, delivery.payload)
                self._step(observation)
                return
            if delivery.topic == topics.feedback():
                codec.decode(delivery.payload, Feedback)  # A lesson holds nothing that cannot be read.
                self._log.add("feedback", now_ns, delivery.payload)
                return
            if delivery.topic == topics.pupil_corrections():
                codec.decode(delivery.payload, PupilCorrections)
                self._log.add("corrections", now_ns, delivery.payload)
                return
            if delivery.topic == topics.segment_request():
                self._answer(codec.decode(delivery.payload, SegmentRequest), now_ns)
                return
            camera = read_health(delivery.topic, delivery.payload).camera
            self._log.add("health", now_ns, delivery.payload)
        except codec.CodecError as error:
            if self._second.rejected == 0:  # one a second says enough, and fills no disk
                log.warning("message refused", topic=delivery.topic, reason=str(error))
            self._second.rejected += 1
            return
        if camera is not None and camera.camera in self._names:
            self._cameras[camera.camera] = (now_ns, camera)

    def _answer(self, request: SegmentRequest, now_ns: int) -> None:
        """Publish what the recorder has missed; forget all if a segment begins: it must be replayed from a known state."""
        answer = self._log.ask(request, now_ns)
        for part in answer.again:
            self._bus.publish(topics.fusion_log(), codec.encode(part))
        if answer.begins:
            self._state = initial_state(self._context.rig)
            self._second.ignored_before = {}
            self._searching = {}

    def _step(self, event: Observation | Tick) -> None:
        began_ns = time.thread_time_ns()
        self._state, output = step(self._state, event, self._config)
        # One that was refused may be of a time that never comes: all that its camera sees from then on would be taken for older.
        if isinstance(event, Observation) and output.ignored is None:
            self._agreement.observe(event)
        self._second.spent_ns += time.thread_time_ns() - began_ns
        self._found = output.found
        if isinstance(event, Tick):
            self._second.ticks += 1
            self._log.add("tick", event.t_ns)
            self._publish(output)

    def _publish(self, output: FusionOutput) -> None:
        if output.searching:
            self._searching = output.searching
        for motion in output.motions:
            self._second.live += motion.kind == "live"
            now_ns = time.monotonic_ns()
            stamped: Motion = msgspec.structs.replace(motion, t_published_ns=now_ns)
            payload = codec.encode(stamped)
            self._bus.publish(topics.motion(motion.kind), payload)
            if motion.kind == "smooth":
                self._log.add("motion", now_ns, payload)

    def _control(self, now_ns: int) -> None:
        """Tell every camera its rate, its network, its place in the turn, and where to look."""
        level = self._governor.current
        predictions = predict_views(self._state, now_ns)
        self._controls += 1
        for position, name in enumerate(self._names):
            control = ViewControl(
                camera=name,
                sequence=self._controls,
                t_ns=now_ns,
                rate_hz=level.rate_hz,
                offset_ns=self._context.start_ns + governor.turn_offset_ns(position, len(self._names), level.rate_hz),
                network=level.network,
                search=self._searching.get(name, True),
                prediction=predictions[name],
            )
            self._bus.publish(topics.control(name), codec.encode(control))

    def _second_passed(self, now_ns: int) -> None:
        second, seconds = self._second, (now_ns - self._second.began_ns) * 1e-9
        ignored = second.ignored(self._state.ignored)
        self._second = _Second(now_ns, ignored_before=dict(self._state.ignored))
        alive = {name: camera for name, (t_ns, camera) in self._cameras.items() if now_ns - t_ns < CAMERA_SILENT_NS}
        used_cores = self._cpu.used_cores()
        if alive or self._governor.started or now_ns - self._began_ns > CAMERA_SILENT_NS:
            self._govern(Load(self._cpu.granted_cores, used_cores, tuple(alive.values())), now_ns)
        judging_ns = time.thread_time_ns()
        disagreement = self._agreement.judge()
        self._second.spent_ns += time.thread_time_ns() - judging_ns
        troubles = _troubles([name for name in self._names if name not in alive], ignored, second.rejected, disagreement)
        fusion = FusionHealth(
            live_hz=second.live / seconds,
            step_ms=second.spent_ns * 1e-6 / max(second.ticks, 1),
            cpu_load=used_cores / self._cpu.granted_cores,
            rejected=second.rejected,
            ignored={camera: sum(n for (name, _), n in ignored.items() if name == camera) for camera, _ in ignored},
            pupil="found" if self._found else "searching",
        )
        self._reporter.report("degraded" if troubles else "ok", troubles, fusion=fusion)

    def _govern(self, load: Load, now_ns: int) -> None:
        inference, before = self._context.site.inference, self._governor
        self._governor = governor.step(before, load, now_ns, float(inference.max_rate_hz), inference.cpu_target)
        if self._governor.level != before.level:
            level = self._governor.current
            log.info("governor", rate_hz=level.rate_hz, network=level.network, used_cores=round(load.used_cores, 2))


def _troubles(
    missing: list[str], ignored: dict[tuple[str, Ignored], int], rejected: int, disagreement: Disagreement | None = None
) -> tuple[Trouble, ...]:
    """What is wrong. A few observations are late at every seam."""
    found = [Trouble("camera_unheard", f"no word from {', '.join(missing)}")] if missing else []
    found += [_not_fused(camera, reason) for (camera, reason), n in ignored.items() if n > _LATE_AT_SEAM]
    found += [disagreement.trouble] if disagreement is not None else []
    found += [messages_refused(rejected)] if rejected else []
    return tuple(found)


def _not_fused(camera: str, reason: Ignored) -> Trouble:
    trouble = _IGNORED[reason]
    return Trouble(trouble.code, f"{camera} is not fused: its pictures {trouble.words}", trouble.remedy)
