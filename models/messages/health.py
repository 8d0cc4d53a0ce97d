"""How a process is (everyone -> supervisor, governor, tablet)."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from models.messages.attempts import REMEMBERED
from models.messages.pupil import NOBODY, Count, PupilCodeOrNone
from models.messages.trouble import Trouble, one_line

State = Literal["starting", "ok", "degraded", "failed"]


class CameraHealth(msgspec.Struct, frozen=True):
    """What an edge process measured over the last second.

    Attributes:
        source_hz: frames a second that the source delivered.
        fresh_hz: pose inferences a second on new frames.
        target_hz: what the governor asked for.
        skipped: due frames, since the start, that were dropped because a newer one was already there.
        backlog_ms: age of a frame when its turn came; of the oldest one in the second.
        network: pose network in use.
        stage_ms: CPU milliseconds a processed frame by stage ("decode", "detect", "crop", "pose", ...).
    """

    camera: str
    source_hz: float
    fresh_hz: float
    target_hz: float
    skipped: int
    backlog_ms: float
    network: str
    stage_ms: dict[str, float]


class FusionHealth(msgspec.Struct, frozen=True):
    """What the fusion process measured over the last second.

    Attributes:
        live_hz: live motions published a second.
        step_ms: CPU milliseconds of the core for each tick, observations and the check that cameras agree included.
        cpu_load: share (0 to 1) of the CPU granted to the box that is in use.
        rejected: messages that could not be read.
        ignored: observations that were read but not fused, by camera.
        pupil: whether the pupil is chosen.
    """

    live_hz: float
    step_ms: float
    cpu_load: float
    rejected: int
    ignored: dict[str, int]
    pupil: Literal["searching", "found"]


class RecorderHealth(msgspec.Struct, frozen=True, omit_defaults=True):
    """What the recorder does.

    Attributes:
        lesson: the running lesson's name, by which `kinebox replay` finds it; empty while nothing is recorded.
        title: what people call it.
        recorded_s: length of what is safe on disk.
        size_bytes: of the file.
        gaps: interruptions since the lesson began.
        began_ns: CLOCK_MONOTONIC of its begin; 0 while nothing is recorded.
        attempts: how many it holds, as `kinebox report` counts them.
        newest: `Feedback.id` of the last of them, in their order: the last one is number `attempts`.
        asked_ns: `LessonRequest.t_ns` of the request that began it; 0 if it began by itself, or goes on after the recorder died.
    """

    lesson: str
    title: str
    recorded_s: float
    size_bytes: int
    gaps: int
    began_ns: Count = 0
    attempts: Count = 0
    newest: Annotated[tuple[Count, ...], Meta(max_length=REMEMBERED)] = ()
    asked_ns: Count = 0

    def __post_init__(self) -> None:
        if len(self.newest) > self.attempts:
            raise ValueError(f"{len(self.newest)} of {self.attempts} attempts have names")


class ReplayHealth(msgspec.Struct, frozen=True):
    """How far the replay process is in its lesson.

    Attributes:
        position_s: how far into the lesson the figure is.
        length_s: of the lesson.
        speed: seconds of the lesson a second.
    """

    position_s: float
    length_s: float
    speed: float


class EvaluationHealth(msgspec.Struct, frozen=True, omit_defaults=True):
    """What the evaluation process does.

    Attributes:
        activity: the action that pupils are to do; empty if whatever they do is recognised.
        chosen_by: whose word that was: the site file's, or a tablet's.
        state: "moving" while the pupil moves, in an attempt or on his way back; "waiting" while he stands; "unknown" if he is lost.
        attempts: found since the process started.
        frame_ms: CPU milliseconds a smooth motion over the last second, those in which an attempt ended included.
        attempt_ms: CPU milliseconds that the last attempt took; 0 before the first.
        missed: smooth motions of the last second that fusion published and that were not taken in.
        rejected: messages of the last second that could not be read.
        pupil: code of who is up; `NOBODY` for nobody who is named.
        pupil_since_ns: CLOCK_MONOTONIC of that turn, as in `PupilTurn`; 0 before the first.
        list_since_ns: since when attempts are listed, as in `AttemptsBegin`; 0 if no server has said so yet.
        list_count: attempts published since.
        list_newest: `Feedback.id` of the last one that is remembered; 0 if none is.
        failures: of how many of the attempts nothing could be said, by a mistake of KineBox that is in its log.
    """

    activity: str
    chosen_by: Literal["site", "tablet"]
    state: Literal["waiting", "moving", "unknown"]
    attempts: int
    frame_ms: float
    attempt_ms: float
    missed: int
    rejected: int
    pupil: PupilCodeOrNone = NOBODY
    pupil_since_ns: Count = 0
    list_since_ns: Count = 0
    list_count: Count = 0
    list_newest: Count = 0
    failures: Count = 0


class MachineHealth(msgspec.Struct, frozen=True):
    """The machine under the box (said by the supervisor).

    Attributes:
        used_cores, granted_cores: CPU in use, by whomever, and what the box may use.
        memory_free_mib: memory that can be had without swapping.
        disk_free_mib: room where lessons and logs are kept.
        temperature_c: of the processor; None where the machine does not say.
        wall_minus_monotonic_ns: CLOCK_REALTIME less CLOCK_MONOTONIC.
        clock_step_ms: how far the wall clock was set in the last minute, forwards positive: the largest step; 0 if it was not.
        throttled: the processor was slowed down, for its heat or for want of power, in the last minute.
    """

    used_cores: float
    granted_cores: float
    memory_free_mib: float
    disk_free_mib: float
    temperature_c: float | None
    wall_minus_monotonic_ns: int
    clock_step_ms: float
    throttled: bool = False


class Restarts(msgspec.Struct, frozen=True):
    """How often one process had to be started again since the box was started.

    Attributes:
        last_ns: CLOCK_MONOTONIC of the last time.
        reason: what became of it then, as a verb ("was ended by SIGKILL", "hung").
        given_up: why it is not started any more; empty as long as it is.
    """

    process: str
    count: int
    last_ns: int
    reason: str
    given_up: str


class SupervisorHealth(msgspec.Struct, frozen=True):
    """What the supervisor holds together.

    Attributes:
        version: of the KineBox that runs.
        started_ns: CLOCK_MONOTONIC of the box's start.
        restarts: one entry for every process that ended since; empty if none did.
    """

    version: str
    started_ns: int
    restarts: tuple[Restarts, ...]


class Health(msgspec.Struct, frozen=True):
    """State of one process, published about once a second on its own topic.

    Attributes:
        process: "edge-<camera>", "fusion", "evaluation", "tablet", "recorder", "supervisor", or "replay" in the place of the
            cameras and fusion.
        state: "starting" (its loop has yet to begin; for up to ten minutes it is not taken for hung), "ok", "degraded" (works, less
            than wished), "failed" (does not work any more).
        troubles: why it is not "ok"; empty if and only if it is.
        cpu_cores: CPU seconds a second of this process.
    """

    process: str
    pid: int
    t_ns: int
    state: State
    troubles: tuple[Trouble, ...]
    cpu_cores: float
    rss_mib: float
    camera: CameraHealth | None = None
    fusion: FusionHealth | None = None
    recorder: RecorderHealth | None = None
    machine: MachineHealth | None = None
    replay: ReplayHealth | None = None
    supervisor: SupervisorHealth | None = None
    evaluation: EvaluationHealth | None = None

    def __post_init__(self) -> None:
        if (self.state == "ok") == bool(self.troubles):
            raise ValueError(f"state '{self.state}' with {len(self.troubles)} troubles")

    @property
    def reason(self) -> str:
        """The troubles in one line for the teacher or the technician; empty when ok. Programs go by the codes."""
        return one_line(self.troubles)
