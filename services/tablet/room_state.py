"""What the page must know of the room: bus messages go in, a `Status` comes out.

Reads no clock: every method is told the time, so that each state can be tested by saying when what was heard.
"""

import math
from collections import deque
from typing import Literal

from models.messages.feedback import ANY
from models.messages.health import EvaluationHealth, Health, RecorderHealth, Restarts, SupervisorHealth
from models.messages.motion import JointState, Motion
from models.messages.trouble import CALIBRATION_CODES, MACHINE_CODES, CalibrationCode
from models.process import EDGE, EVALUATION, RECORDER, REPLAY, ROUTER, Playback, process_name
from services.support.machine_troubles import machine_troubles
from services.tablet.camera_state import SILENT_AFTER_NS, START_GRACE_NS, HeardHealth, camera_status, known
from services.tablet.messages import (
    CameraStatus,
    EvaluationStatus,
    Latency,
    MachineStatus,
    ProcessState,
    ProcessStatus,
    Recording,
    Replay,
    Status,
)
from services.tablet.presence import Presences

WINDOW_NS = 3_000_000_000
"""Rates and latencies are those of the last so many nanoseconds."""
MINIMUM_SPAN_NS = 500_000_000
"""A rate is not divided by less than this: the first two motions would otherwise read as any rate."""


class MotionMeter:
    """Rate and latency of the motions that arrived within the window."""

    def __init__(self) -> None:
        self._arrivals: deque[tuple[int, float]] = deque()

    def add(self, arrived_ns: int, latency_ms: float) -> None:
        """Count one motion."""
        self._arrivals.append((arrived_ns, latency_ms))
        self._forget(arrived_ns)

    def rate_hz(self, now_ns: int) -> float:
        """Motions a second: over the window, or since the first of a stream that is younger."""
        self._forget(now_ns)
        if not self._arrivals:
            return 0.0
        span_ns = min(max(now_ns - self._arrivals[0][0], MINIMUM_SPAN_NS), WINDOW_NS)
        return len(self._arrivals) * 1e9 / span_ns

    def latency(self, now_ns: int) -> Latency | None:
        """Percentiles by the nearest rank; None if nothing arrived."""
        self._forget(now_ns)
        ordered = sorted(latency_ms for _, latency_ms in self._arrivals)
        if not ordered:
            return None
        return Latency(p50_ms=_nearest_rank(ordered, 0.50), p95_ms=_nearest_rank(ordered, 0.95))

    def _forget(self, now_ns: int) -> None:
        while self._arrivals and now_ns - self._arrivals[0][0] > WINDOW_NS:
            self._arrivals.popleft()


class RoomState:
    """Everything heard so far.

    Args:
        room: the site's name.
        cameras: names of the site's cameras, in its order.
        wished_hz: motions a second that the site file asks for.
        started_ns: CLOCK_MONOTONIC at the server's start.
        playback: what is played in the place of a room; None in a room.
    """

    def __init__(
        self, room: str, cameras: tuple[str, ...], wished_hz: float, started_ns: int, playback: Playback | None = None
    ) -> None:
        self._room = room
        self._cameras = cameras
        self._wished_hz = wished_hz
        self._playback = playback
        self._evaluation: EvaluationHealth | None = None
        self._processes = {
            ROUTER,
            EVALUATION,
            RECORDER,
            REPLAY,
            "tablet",
            "supervisor",
            *(process_name(EDGE, name) for name in cameras),
        }
        self._health: dict[str, HeardHealth] = {}
        self._router = ROUTER if playback is None else REPLAY
        self._presences = Presences(self._router, started_ns)
        self._motion: Motion | None = None
        self._meter = MotionMeter()
        self.rejected_bus_messages = 0
        self.rejected_client_messages = 0

    def receive_motion(self, motion: Motion, now_ns: int) -> None:
        """A motion arrived."""
        self._motion = motion
        # The live figure may show an instant before its newest observation, or one that it foretells.
        self._meter.add(now_ns, max(now_ns - min(motion.t_ns, motion.t_newest_ns), 0) * 1e-6)

    def receive_health(self, health: Health, now_ns: int) -> None:
        """A process said how it is; one that the site does not have is refused, so that nothing grows."""
        if health.process not in self._processes:
            self.rejected_bus_messages += 1
            return
        self._health[health.process] = HeardHealth(health, now_ns)
        if health.process == EVALUATION:
            self._evaluation = health.evaluation or self._evaluation
        restarts = self._restarts(self._router)
        if health.process == "supervisor" and restarts is not None and restarts.given_up:
            self._presences.note_stand_in(now_ns)  # It would not be heard if it did not route.

    @property
    def asked(self) -> tuple[str, str, str] | None:
        """Which action pupils are to do, whose word that was, and who is up, as the evaluation last said; None if it never did."""
        evaluation = self._evaluation
        return (evaluation.activity, evaluation.chosen_by, evaluation.pupil) if evaluation is not None else None

    @property
    def restarted(self) -> bool:
        """Whether there was a page's server before this one since the box was started, as far as the supervisor has said."""
        restarts = self._restarts("tablet")
        return restarts is not None and restarts.count > 0

    def set_alive(self, process: str, alive: bool, now_ns: int) -> None:
        """A process joined or left the bus."""
        if process not in self._processes:
            return
        if alive and self._gone(process, now_ns):
            self._health.pop(process, None)  # what its predecessor said is no news of this one
        self._presences.note(process, alive, now_ns)

    def status(self, now_ns: int, clients: int, teaching: str = "") -> Status:
        """The room as it is at `now_ns` (CLOCK_MONOTONIC); `teaching` is the revision of the words."""
        fusion_health, motion, used = self._said(ROUTER, now_ns), self._motion, self._used(now_ns)
        fusion = fusion_health.fusion if fusion_health else None
        return Status(
            version=supervisor.version if (supervisor := self._supervisor()) else None,
            room=self._room,
            box_time_us=now_ns // 1000,
            epoch=motion.epoch if motion else None,
            live_hz=self._meter.rate_hz(now_ns),
            wished_hz=self._wished_hz,
            motion_age_ms=max(now_ns - motion.t_newest_ns, 0) * 1e-6 if motion else None,
            latency=self._meter.latency(now_ns),
            pupil=fusion.pupil if fusion else "unknown",
            cpu_load=known(fusion.cpu_load) if fusion else None,
            machine=self._machine(now_ns),
            calibration=_calibration(fusion_health),
            recording=self.recording(now_ns),
            nothing_recorded=self.nothing_recorded(now_ns),
            replay=self._replay(now_ns),
            evaluation=self._evaluates(now_ns),
            teaching=teaching,
            cameras=[self._camera(name, name in used, now_ns) for name in self._cameras],
            processes=[self._process(heard, now_ns) for _, heard in sorted(self._health.items())],
            clients=clients,
            rejected_bus_messages=self.rejected_bus_messages,
            rejected_client_messages=self.rejected_client_messages,
        )

    def _camera(self, name: str, used: bool, now_ns: int) -> CameraStatus:
        process = process_name(EDGE, name)
        presence, restarts = self._presences.of(process, now_ns), self._restarts(process)
        given_up = restarts is not None and bool(restarts.given_up)
        return camera_status(name, self._health.get(process), presence, given_up=given_up, used=used, now_ns=now_ns)

    def _gone(self, process: str, now_ns: int) -> bool:
        return self._presences.of(process, now_ns).alive is False

    def _used(self, now_ns: int) -> frozenset[str]:
        motion = self._motion
        if motion is None or now_ns - motion.t_newest_ns > WINDOW_NS or not (motion.states == JointState.SEEN).any():
            return frozenset()
        return frozenset(use.camera for use in motion.cameras if use.used)

    def _said(self, process: str, now_ns: int) -> Health | None:
        """What a process says of itself; None if it is silent or gone."""
        heard = self._health.get(process)
        if heard is None or now_ns - heard.arrived_ns > SILENT_AFTER_NS or self._gone(process, now_ns):
            return None
        return heard.health

    def recording(self, now_ns: int) -> Recording | None:
        """What is being recorded, as far as the recorder says so."""
        recorder = self._recorder(now_ns)
        if recorder is None or not recorder.lesson:
            return None
        return Recording(title=recorder.title, recorded_s=known(recorder.recorded_s), gaps=recorder.gaps)

    def nothing_recorded(self, now_ns: int) -> bool:
        """Whether nothing is being recorded for certain: a recorder that is not heard may go on, or go on with its lesson soon."""
        recorder = self._recorder(now_ns)
        return self._playback is not None or (recorder is not None and not recorder.lesson)

    def _recorder(self, now_ns: int) -> RecorderHealth | None:
        health = self._said(RECORDER, now_ns)
        return health.recorder if health else None

    def _replay(self, now_ns: int) -> Replay | None:
        # From the start, and not only once the replay process is heard of: what is played must never look live.
        if self._playback is None:
            return None
        health = self._said(REPLAY, now_ns)
        heard = health.replay if health else None
        return Replay(
            title=self._playback.title,
            began_ms=self._playback.began_wall_ns // 1_000_000,
            speed=self._playback.speed,
            position_s=known(heard.position_s) if heard else None,
            length_s=known(heard.length_s) if heard else None,
        )

    def _evaluates(self, now_ns: int) -> EvaluationStatus:
        # What was asked for stays so while the evaluation is started again, but what the pupil does is not known then.
        asked, health = self._evaluation, self._said(EVALUATION, now_ns)
        heard = health.evaluation if health else None
        unheard: Literal["starting", "unknown"] = "starting" if self._begins(EVALUATION, now_ns) else "unknown"
        return EvaluationStatus(
            activity=asked.activity if asked is not None and asked.activity != ANY else None,
            activity_chosen_by=asked.chosen_by if asked is not None else None,
            pupil=asked.pupil or None if asked is not None else None,
            state=heard.state if heard is not None else unheard,
        )

    def _begins(self, process: str, now_ns: int) -> bool:
        """Whether a process has yet to be heard, and may still come."""
        presence = self._presences.of(process, now_ns)
        young = now_ns - presence.since_ns < START_GRACE_NS
        return process not in self._health and presence.alive is not False and young

    def _process(self, heard: HeardHealth, now_ns: int) -> ProcessStatus:
        health, age_ns = heard.health, now_ns - heard.arrived_ns
        state: ProcessState = health.state
        # One that was given up is gone too, but that it does not come back is what a person must know.
        if self._gone(health.process, now_ns) and state != "failed":
            state = "gone"
        elif age_ns > SILENT_AFTER_NS:
            state = "unknown" if self._presences.of(health.process, now_ns).cut_off else "silent"
        return ProcessStatus(
            name=health.process,
            state=state,
            reason=health.reason,
            age_s=age_ns * 1e-9,
            cpu_cores=known(health.cpu_cores),
            rss_mib=known(health.rss_mib),
            restarts=self._restart_count(health.process),
        )

    def _supervisor(self) -> SupervisorHealth | None:
        # However old: which version runs, and what was started again, does not become untrue by silence.
        heard = self._health.get("supervisor")
        return heard.health.supervisor if heard else None

    def _restarts(self, process: str) -> Restarts | None:
        supervisor = self._supervisor()
        return next((restarts for restarts in supervisor.restarts if restarts.process == process), None) if supervisor else None

    def _restart_count(self, process: str) -> int | None:
        restarts = self._restarts(process)
        if restarts is not None:
            return restarts.count
        return 0 if self._supervisor() is not None else None

    def _machine(self, now_ns: int) -> MachineStatus | None:
        health = self._said("supervisor", now_ns)
        machine = health.machine if health else None
        if machine is None:
            return None
        found = {trouble.code for trouble in machine_troubles(machine)}
        return MachineStatus(
            used_cores=known(machine.used_cores),
            granted_cores=known(machine.granted_cores),
            memory_free_mib=known(machine.memory_free_mib),
            disk_free_mib=known(machine.disk_free_mib),
            temperature_c=None if machine.temperature_c is None else known(machine.temperature_c),
            clock_ms=(machine.wall_minus_monotonic_ns + now_ns) // 1_000_000,
            clock_step_ms=known(machine.clock_step_ms),
            troubles=[code for code in MACHINE_CODES if code in found],
        )

    def healths(self, now_ns: int) -> list[Health]:
        """What the processes that are heard say of themselves, by name."""
        said = (self._said(process, now_ns) for process in sorted(self._health))
        return [health for health in said if health is not None]


def _nearest_rank(ordered: list[float], share: float) -> float:
    return ordered[max(math.ceil(share * len(ordered)) - 1, 0)]


def _calibration(fusion: Health | None) -> CalibrationCode | None:
    found = {trouble.code for trouble in fusion.troubles} if fusion else set()
    return next((code for code in CALIBRATION_CODES if code in found), None)
