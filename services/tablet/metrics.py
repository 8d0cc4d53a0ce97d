"""The room as Prometheus metrics, for whoever watches many boxes: `GET /metrics`.

Names follow Prometheus's conventions: base units, the unit in the name, `_total` on what only grows. What is not known has no
sample, so that nobody's graph shows a zero for it.
"""

import math
from collections.abc import Callable, Iterator
from typing import Protocol, TypeGuard, TypeVar, get_args

from prometheus_client import CollectorRegistry, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, InfoMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_0_0_4
from prometheus_client.registry import Collector

from models.messages.health import Health
from models.messages.trouble import MACHINE_CODES
from models.process import EVALUATION, RECORDER, ROUTER
from services.tablet.messages import CameraState, CameraStatus, MachineStatus, ProcessState, ProcessStatus, Status

CONTENT_TYPE = CONTENT_TYPE_PLAIN_0_0_4
_MIB = 2.0**20

StatusT = TypeVar("StatusT")
MemberT = TypeVar("MemberT", CameraStatus, ProcessStatus)
_Measures = tuple[tuple[str, str, Callable[[StatusT], float | None]], ...]
"""Name, description and value of each."""


class Room(Protocol):
    """What is measured."""

    def status(self) -> Status:
        """The room now."""

    def healths(self) -> list[Health]:
        """What each process that is heard says of itself."""


def render(room: Room) -> bytes:
    """All metrics in Prometheus's text format."""
    registry = CollectorRegistry()
    registry.register(RoomCollector(room))
    return generate_latest(registry)


class RoomCollector(Collector):
    """Collects from the room at every scrape; nothing is counted between two."""

    def __init__(self, room: Room) -> None:
        self._room = room

    def collect(self) -> Iterator[Metric]:
        """Every metric with its samples now."""
        status, healths = self._room.status(), self._room.healths()
        yield from _room(status)
        yield from _each("camera", get_args(CameraState), status.cameras, _CAMERA_GAUGES, _CAMERA_COUNTERS)
        yield from _stages(healths)
        yield from _fusion(_said_by(ROUTER, healths))
        yield from _each("process", get_args(ProcessState), status.processes, _PROCESS_GAUGES, _PROCESS_COUNTERS)
        yield from _machine(status.machine)
        yield from _recorder(_said_by(RECORDER, healths))
        yield from _evaluation(_said_by(EVALUATION, healths))


def _said_by(process: str, healths: list[Health]) -> Health | None:
    return next((health for health in healths if health.process == process), None)


def _gauge(name: str, text: str, value: float | None) -> Metric:
    metric = GaugeMetricFamily(f"kinebox_{name}", text)
    if _known(value):
        metric.add_metric([], value)
    return metric


def _known(value: float | None) -> TypeGuard[float]:
    return value is not None and math.isfinite(value)


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _room(status: Status) -> Iterator[Metric]:
    info = {"room": status.room, "version": status.version or ""}
    yield InfoMetricFamily("kinebox_box", "Which box this is, and which version of KineBox it runs.", info)
    yield _gauge("live_motion_hertz", "Live figures that arrived at the tablet server a second.", status.live_hz)
    yield _gauge("live_motion_target_hertz", "Live figures a second that the site file asks for.", status.wished_hz)
    latency = GaugeMetricFamily(
        "kinebox_motion_latency_seconds",
        "Age of the figures when the tablet server received them, over the last 3 seconds, since the instant that they show.",
        labels=["quantile"],
    )
    if status.latency is not None:
        latency.add_metric(["0.5"], status.latency.p50_ms * 1e-3)
        latency.add_metric(["0.95"], status.latency.p95_ms * 1e-3)
    yield latency
    yield _gauge("motion_age_seconds", "Age of the newest observation used in a figure.", _scaled(status.motion_age_ms, 1e-3))
    yield _gauge("epoch", "Which repetition of the sources is played; constant with live cameras.", status.epoch)
    yield _gauge("pupil_found", "1 if the pupil is chosen, 0 while the box searches.", _found(status))
    yield _gauge("clients", "Tablets and other clients that watch the live figure.", status.clients)
    rejected = CounterMetricFamily(
        "kinebox_rejected_messages", "Messages that the tablet server could not read, since its start.", labels=["source"]
    )
    rejected.add_metric(["bus"], status.rejected_bus_messages)
    rejected.add_metric(["client"], status.rejected_client_messages)
    yield rejected


def _found(status: Status) -> float | None:
    return None if status.pupil == "unknown" else float(status.pupil == "found")


def _each(
    what: str, states: tuple[str, ...], members: list[MemberT], gauges: _Measures[MemberT], counters: _Measures[MemberT]
) -> Iterator[Metric]:
    """The state of every camera or every process, and what is measured of it."""
    state = GaugeMetricFamily(f"kinebox_{what}_state", f"1 for the state in which the {what} is.", labels=[what, "state"])
    for member in members:
        for name in states:
            state.add_metric([member.name, name], float(member.state == name))
    yield state
    for kind, measures in ((GaugeMetricFamily, gauges), (CounterMetricFamily, counters)):
        for name, text, value_of in measures:
            metric = kind(f"kinebox_{what}_{name}", text, labels=[what])
            for member in members:
                if _known(value := value_of(member)):
                    metric.add_metric([member.name], value)
            yield metric


_CAMERA_GAUGES: _Measures[CameraStatus] = (
    ("source_hertz", "Pictures a second that the camera delivers.", lambda camera: camera.source_hz),
    ("inference_hertz", "Pose inferences a second on new pictures.", lambda camera: camera.fresh_hz),
    ("inference_target_hertz", "Pose inferences a second that the governor asks for.", lambda camera: camera.target_hz),
    ("backlog_seconds", "Age of the oldest picture when its turn came, in the last second.", lambda c: _scaled(c.backlog_ms, 1e-3)),
    ("used", "1 if the newest figure rests on this camera too.", lambda camera: float(camera.used)),
)


_CAMERA_COUNTERS: _Measures[CameraStatus] = (
    ("skipped_frames", "Pictures whose turn was missed, since the camera's process started.", lambda camera: camera.skipped),
)


def _stages(healths: list[Health]) -> Iterator[Metric]:
    stages = GaugeMetricFamily(
        "kinebox_camera_stage_cpu_seconds", "CPU time for each picture that is looked at, by stage.", labels=["camera", "stage"]
    )
    for health in healths:
        for stage, milliseconds in (health.camera.stage_ms if health.camera else {}).items():
            if health.camera and _known(milliseconds):
                stages.add_metric([health.camera.camera, stage], milliseconds * 1e-3)
    yield stages


def _fusion(health: Health | None) -> Iterator[Metric]:
    fusion = health.fusion if health else None
    yield _gauge("fusion_live_hertz", "Live figures a second that fusion made.", fusion.live_hz if fusion else None)
    yield _gauge("fusion_step_cpu_seconds", "CPU time of fusion for each figure.", fusion.step_ms * 1e-3 if fusion else None)
    yield _gauge(
        "fusion_rejected_messages", "Messages that fusion could not read in the last second.", fusion.rejected if fusion else None
    )
    ignored = GaugeMetricFamily(
        "kinebox_fusion_ignored_observations", "Observations in the last second that fusion could not use.", labels=["camera"]
    )
    for camera, count in (fusion.ignored if fusion else {}).items():
        ignored.add_metric([camera], count)
    yield ignored


_PROCESS_GAUGES: _Measures[ProcessStatus] = (
    ("health_age_seconds", "Time since the process last said how it is.", lambda process: process.age_s),
    ("cpu_cores", "CPU seconds a second that the process uses.", lambda process: process.cpu_cores),
    ("resident_memory_bytes", "Memory that the process holds.", lambda process: _scaled(process.rss_mib, _MIB)),
)


_PROCESS_COUNTERS: _Measures[ProcessStatus] = (
    ("restarts", "Times that the process was started again since the box was started.", lambda process: process.restarts),
)

_MACHINE_GAUGES: _Measures[MachineStatus] = (
    ("used_cores", "CPU seconds a second in use on the granted cores, by whomever.", lambda machine: machine.used_cores),
    ("granted_cores", "CPU seconds a second that the box may use.", lambda machine: machine.granted_cores),
    ("memory_free_bytes", "Memory that can be had without swapping.", lambda machine: _scaled(machine.memory_free_mib, _MIB)),
    ("disk_free_bytes", "Room where lessons and logs are kept.", lambda machine: _scaled(machine.disk_free_mib, _MIB)),
    ("temperature_celsius", "Temperature of the processor.", lambda machine: machine.temperature_c),
    ("clock_seconds", "The box's date and time, in seconds since 1970 in UTC.", lambda machine: machine.clock_ms * 1e-3),
    (
        "clock_step_seconds",
        "How far the clock was set in the last minute: the largest step.",
        lambda m: _scaled(m.clock_step_ms, 1e-3),
    ),
)


def _machine(machine: MachineStatus | None) -> Iterator[Metric]:
    for name, text, value_of in _MACHINE_GAUGES:
        yield _gauge(f"machine_{name}", text, value_of(machine) if machine else None)
    trouble = GaugeMetricFamily("kinebox_machine_trouble", "1 for everything that is wrong with the machine.", labels=["trouble"])
    for code in MACHINE_CODES if machine else ():
        trouble.add_metric([code], float(machine is not None and code in machine.troubles))
    yield trouble


def _recorder(health: Health | None) -> Iterator[Metric]:
    recorder = health.recorder if health else None
    running = recorder if recorder and recorder.lesson else None
    yield _gauge("recorder_recording", "1 while a lesson is recorded.", float(running is not None) if recorder else None)
    yield _gauge("recorder_safe_seconds", "Length of the lesson that is safe on disk.", running.recorded_s if running else None)
    yield _gauge("recorder_file_bytes", "Size of the lesson's file.", running.size_bytes if running else None)
    yield _gauge("recorder_gaps", "Interruptions since the lesson began.", running.gaps if running else None)


def _evaluation(health: Health | None) -> Iterator[Metric]:
    said = health.evaluation if health else None
    attempts = CounterMetricFamily("kinebox_evaluation_attempts", "Attempts that were found since the evaluation started.")
    if said is not None:
        attempts.add_metric([], said.attempts)
    yield attempts
    moving = float(said.state == "moving") if said is not None and said.state != "unknown" else None
    yield _gauge("evaluation_moving", "1 while an attempt seems to be under way, 0 between them.", moving)
    frame_s, attempt_s = (said.frame_ms * 1e-3, said.attempt_ms * 1e-3) if said is not None else (None, None)
    yield _gauge("evaluation_step_cpu_seconds", "CPU time of the evaluation for each figure, over the last second.", frame_s)
    yield _gauge("evaluation_attempt_cpu_seconds", "CPU time that the last attempt took.", attempt_s or None)
    yield _gauge("evaluation_missed_motions", "Figures of the last second that it missed.", said.missed if said else None)
