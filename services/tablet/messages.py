"""What the server and the page tell one another in JSON. The page's TypeScript types are generated from these models.

Texts for people are made on the page, from the codes given here, so that languages can follow; only a process's own reason,
meant for the technician, travels as text.
"""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from models.messages.feedback import Silence, Verdict
from models.messages.pupil import CODE, LONGEST
from models.messages.trouble import CalibrationCode, MachineCode

CameraState = Literal["starting", "ok", "slow", "lost", "unknown"]
ProcessState = Literal["starting", "ok", "degraded", "failed", "silent", "gone", "unknown"]
"""Unknown: nobody can be heard, because the bus is away."""
CameraReason = Literal[
    "none",
    "starting",  # not heard of yet, and the box has only just started
    "never_seen",  # not heard of since the box started
    "unheard",  # the bus is away, so that nobody is heard
    "given_up",  # its process failed too often, and is not started again
    "process_gone",  # its process ended
    "silent",  # its process is there and says nothing
    "failed",  # its process says that it failed; see `detail`
    "ended",  # its source ended, and is opened again and again
    "repeats",  # it sends the same picture again and again
    "clock",  # its pictures have impossible times
    "no_frames",  # the source delivers nothing
    "degraded",  # its process works less well than wished; see `detail`
    "behind",  # fewer inferences than the governor asked for
    "backlog",  # frames wait too long for their turn
    "sparse",  # the governor asks for too few inferences for fast movement
    "resting",  # the governor asks for none: other cameras see better
]


class _Model(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class CameraStatus(_Model):
    """One camera of the room, in the order of the site file. Null is: not known."""

    name: str
    state: CameraState
    reason: CameraReason
    detail: Annotated[str, Field(description="the process's own words, for the technician")]
    source_hz: float | None
    fresh_hz: Annotated[float | None, Field(description="pose inferences a second on new frames")]
    target_hz: Annotated[float | None, Field(description="what the governor asks for")]
    network: str | None
    backlog_ms: float | None
    skipped: int | None
    used: Annotated[bool, Field(description="part of the newest motion")]


class ProcessStatus(_Model):
    """One process of the box, as it last described itself. `age_s` is the age of that description. Null is: not known."""

    name: str
    state: ProcessState
    reason: str
    age_s: float
    cpu_cores: float | None
    rss_mib: float | None
    restarts: Annotated[int | None, Field(description="times that it had to be started again since the box was started")]


class MachineStatus(_Model):
    """The machine under the box. Null is: not known."""

    used_cores: float | None
    granted_cores: float | None
    memory_free_mib: float | None
    disk_free_mib: Annotated[float | None, Field(description="room where lessons and logs are kept")]
    temperature_c: float | None
    clock_ms: Annotated[int, Field(description="the box's date and time, milliseconds since 1970 in UTC")]
    clock_step_ms: Annotated[float | None, Field(description="how far that clock was set in the last minute: the largest step")]
    troubles: Annotated[list[MachineCode], Field(description="what is wrong, worst first")]


class Latency(_Model):
    """Age in milliseconds of the figure when the server received it: since the instant that it shows."""

    p50_ms: float
    p95_ms: float


class Recording(_Model):
    """A lesson that is being recorded."""

    title: str
    recorded_s: Annotated[float | None, Field(description="length of what is safe on disk")]
    gaps: Annotated[int, Field(description="interruptions since the lesson began")]


class Replay(_Model):
    """A lesson that is being played; then nothing on the page is live."""

    title: str
    began_ms: Annotated[int, Field(description="when the lesson was begun, milliseconds since 1970 in UTC")]
    speed: Annotated[float, Field(description="seconds of the lesson a second")]
    position_s: Annotated[float | None, Field(description="how far into the lesson the figure is")]
    length_s: float | None


class EvaluationStatus(_Model):
    """What pupils are to do, who is up, and whether somebody does it."""

    activity: Annotated[str | None, Field(description="the action that was chosen; null: whichever of them is recognised")]
    activity_chosen_by: Annotated[
        Literal["site", "tablet"] | None, Field(description="null: not known, since the evaluation has yet to say so")
    ]
    pupil: Annotated[
        str | None, Field(description="code of who is up; null: nobody who is named, or not known as `activity_chosen_by` says")
    ]
    state: Annotated[
        Literal["waiting", "moving", "unknown", "starting"],
        Field(
            description="moving: an attempt seems to be under way; unknown: no pupil is seen, or the evaluation is not heard; "
            "starting: it is not heard yet, and has not had long to begin"
        ),
    ]


class Status(_Model):
    """The room as a whole, about twice a second."""

    type: Literal["status"] = "status"
    version: Annotated[str | None, Field(description="of the KineBox that runs")]
    room: Annotated[str, Field(description="the site's name")]
    box_time_us: Annotated[int, Field(description="CLOCK_MONOTONIC of the box")]
    epoch: int | None
    live_hz: Annotated[float, Field(description="motions a second that arrived in the last seconds")]
    wished_hz: Annotated[float, Field(description="motions a second that the site file asks for")]
    motion_age_ms: Annotated[float | None, Field(description="age of the newest observation used in a motion")]
    latency: Latency | None
    pupil: Literal["unknown", "searching", "found"]
    cpu_load: Annotated[float | None, Field(description="share of the granted CPU that is in use, 0 to 1")]
    recording: Annotated[Recording | None, Field(description="null: nothing is recorded, or the recorder is not heard")]
    nothing_recorded: Annotated[bool, Field(description="for certain: not while the recorder is not heard")]
    replay: Replay | None
    evaluation: EvaluationStatus
    teaching: Annotated[str, Field(description="changes with what /api/teaching says, which is to be asked for again then")]
    machine: MachineStatus | None
    calibration: Annotated[
        CalibrationCode | None, Field(description="what speaks against the calibration, or against which camera is which")
    ]
    cameras: list[CameraStatus]
    processes: list[ProcessStatus]
    clients: int
    rejected_bus_messages: int
    rejected_client_messages: int


class Pong(_Model):
    """Answer to a `Ping`."""

    type: Literal["pong"] = "pong"
    id: int
    box_time_us: Annotated[int, Field(description="CLOCK_MONOTONIC of the box when it answered")]


class AttemptMeasure(_Model):
    """One measure of an attempt."""

    name: Annotated[str, Field(description="its title is in /api/teaching")]
    value: Annotated[float | None, Field(description="null: could not be measured")]
    sigma: Annotated[float | None, Field(description="one standard deviation; null together with the value")]
    unit: Annotated[str, Field(description="deg, cm, pct, m_s, s or deg_s")]
    verdict: Verdict
    low: Annotated[float | None, Field(description="below this it is not good any more; null: there is no such bound")]
    high: float | None


class Attempt(_Model):
    """An attempt that ended."""

    id: Annotated[int, Field(description="its replay is at /api/attempts/{id}/replay as long as the attempt is listed")]
    number: Annotated[
        int | None,
        Field(
            description="counts the attempts of the lesson, as its report does, and goes on after the recording; null: the lesson "
            "does not hold it"
        ),
    ]
    action: str
    by: Annotated[Literal["recognised", "chosen"], Field(description="how it is known what was tried")]
    handed: Literal["right", "left"]
    ended_ms: Annotated[int, Field(description="when it ended: milliseconds on the clock of `Status.box_time_us`")]
    duration_s: float
    score: Annotated[float | None, Field(description="0 to 100; null: too little was seen")]
    score_sigma: float | None
    cue: Annotated[str | None, Field(description="the fault to correct; its words are in /api/teaching")]
    cue_certainty: Annotated[float | None, Field(description="0 to 1; null without a cue")]
    praise: Annotated[str | None, Field(description="the fault whose point was good; its words are in /api/teaching")]
    silence: Annotated[
        Silence | None,
        Field(
            description="what it means that there is no cue; unseen: too little was seen, but for what is praised; null with a cue"
        ),
    ]
    measures: Annotated[list[AttemptMeasure], Field(description="at most three, in the order in which they are shown")]
    pupil: Annotated[str | None, Field(description="code of who was up when it began, or as corrected; null: nobody who is named")]


class AttemptList(_Model):
    """The newest attempts since the list began: sent to a page that connects, and to all when it changes. It is whole each time."""

    type: Literal["attempts"] = "attempts"
    attempts: Annotated[list[Attempt], Field(description="the oldest first")]
    earlier: Annotated[
        Literal["listed", "recorded", "lost"],
        Field(
            description="those from before the server was started again: they are listed like all others; recorded: some are not, "
            "but the lesson holds them; lost: some are not and nobody has them, or whether there were any is not known"
        ),
    ]


Words = Annotated[dict[str, str], Field(description="the same in every language, by its code")]


class FaultWords(_Model):
    """What is said about a fault."""

    cue: Annotated[Words, Field(description="what to do")]
    praise: Annotated[Words, Field(description="what is said when just this was good")]


class MeasureWords(_Model):
    """What a measure is called."""

    title: Words
    unit: str


class ActionWords(_Model):
    """The words of one action."""

    title: Words
    faults: dict[str, FaultWords]
    measures: dict[str, MeasureWords]


class Teaching(_Model):
    """Everything that is said about attempts, in all languages, and what can be chosen."""

    languages: Annotated[list[str], Field(description="codes; the site's own language is the first")]
    actions: Annotated[dict[str, ActionWords], Field(description="by the action's name")]


class Choose(_Model):
    """What pupils shall do from now on."""

    type: Literal["choose"]
    activity: Annotated[
        Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,47}$")] | None, Field(description="an action; null: whichever it is")
    ]


PupilCode = Annotated[str, Field(pattern=f"^{CODE}$", max_length=LONGEST)]


class Turn(_Model):
    """Who is up from now on."""

    type: Literal["turn"]
    pupil: Annotated[PupilCode | None, Field(description="code; null: nobody who is named")]


class Correction(_Model):
    """Whose an attempt was after all."""

    type: Literal["correction"]
    attempt: Annotated[int, Field(ge=0, lt=2**53, description="its id")]
    pupil: Annotated[PupilCode | None, Field(description="code; null: nobody who is named")]


class Anew(_Model):
    """The list of attempts shall begin anew, on all pages. Not while a lesson is recorded: its numbers are those of the report."""

    type: Literal["anew"]


class Ping(_Model):
    """The page measures the way to the box and back; only the newest is answered."""

    type: Literal["ping"]
    id: Annotated[int, Field(ge=0, lt=2**53)]


class Ack(_Model):
    """What the page has dealt with since it connected: motions drawn (or dropped as too old), and states shown."""

    type: Literal["ack"]
    motions: Annotated[int, Field(ge=0, lt=2**53)]
    statuses: Annotated[int, Field(ge=0, lt=2**53)]


Wish = Choose | Turn | Correction | Anew
"""What somebody at a page wants of the box."""
ClientMessage = Annotated[Ack | Ping | Wish, Field(discriminator="type")]

CLIENT_MESSAGE: TypeAdapter[Ack | Ping | Wish] = TypeAdapter(ClientMessage)
