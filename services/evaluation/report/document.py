"""Schema of a report: what its JSON file holds, and all that the other forms are made of. docs/report.md is written from it.

What is not known is null. A number that was measured never stands without its sigma, one standard deviation.
"""

from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta

from models.messages.feedback import Silence, Verdict
from models.motions.motion import Handed
from models.teaching.measure import Phase
from models.teaching.schema import Language

FORMAT: Final = "kinebox-report"
VERSION: Final = 1

Source = Literal["recorded", "evaluated"]


class Table(msgspec.Struct, frozen=True, kw_only=True):
    """Base of every object of the file."""


class Keyframes(Table, frozen=True, kw_only=True):
    """When an attempt's keyframes were, in seconds since the lesson began."""

    start: Annotated[float, Meta(description="the first movement that belongs to it")]
    exertion: Annotated[float, Meta(description="the main effort begins")]
    peak: Annotated[float, Meta(description="the decisive moment: release, highest point, hit")]
    end: Annotated[float, Meta(description="stands again, or has landed and is still")]
    sigma: Annotated[float, Meta(description="one standard deviation of each of them that was seen")]
    unseen: Annotated[
        tuple[Phase, ...],
        Meta(
            description="those around which the pupil was not seen: their times are only where the standard has them, and no sigma "
            "is known. Empty, too, in lessons from before this was said"
        ),
    ] = ()


class Praise(Table, frozen=True, kw_only=True):
    """What was good, to be said first."""

    point: Annotated[str, Meta(description="the point that was good: the name of the fault that was not made")]
    text: Annotated[str | None, Meta(description="in the report's language; null if it is not taught any more")]


class Cue(Table, frozen=True, kw_only=True):
    """The one thing to correct."""

    fault: Annotated[str, Meta(description="name of the fault")]
    text: Annotated[str | None, Meta(description="in the report's language; null if it is not taught any more")]
    certainty: Annotated[float, Meta(description="how likely it is that this fault was made, 0 to 1")]


class Measure(Table, frozen=True, kw_only=True):
    """A number that was measured in an attempt."""

    name: Annotated[str, Meta(description="of the measure, as in the action's teaching file")]
    title: Annotated[str | None, Meta(description="in the report's language; null if it is not taught any more")]
    shown: Annotated[bool, Meta(description="whether the tablet shows it after the attempt")]
    value: Annotated[float | None, Meta(description="in `unit`; null if it could not be measured")]
    sigma: Annotated[float | None, Meta(description="one standard deviation of it; null together with it")]
    unit: Annotated[str, Meta(description="deg, cm, pct (of the pupil's stature), m_s, s or deg_s")]
    verdict: Annotated[Verdict, Meta(description="good, fair, poor, or unknown if it is not sure enough")]
    low: Annotated[float | None, Meta(description="good begins there; null without such a bound")]
    high: Annotated[float | None, Meta(description="good ends there; null without such a bound")]


class Judgement(Table, frozen=True, kw_only=True):
    """How much of a fault there was."""

    fault: Annotated[str, Meta(description="name of the fault")]
    severity: Annotated[float | None, Meta(description="0 as it should be, 1 to be corrected at once; null if it was not seen")]
    sigma: Annotated[float | None, Meta(description="one standard deviation of it; null together with it")]


class Attempt(Table, frozen=True, kw_only=True):
    """One try at an action."""

    number: Annotated[int, Meta(description="counts the lesson's attempts from 1; stays the same with `--pupil`")]
    id: Annotated[int, Meta(description="names it on the bus and in the lesson's file")]
    pupil: Annotated[str | None, Meta(description="code of the pupil; null if nobody was named")]
    action: Annotated[str, Meta(description="name of the action")]
    title: Annotated[str | None, Meta(description="the action in the report's language; null if it is not taught any more")]
    by: Annotated[Literal["recognised", "chosen"], Meta(description="how the action is known: found out, or chosen by a person")]
    handed: Annotated[Handed, Meta(description="the side that leads")]
    begun: Annotated[str, Meta(description="day and time of its start, ISO 8601")]
    keyframes_s: Annotated[Keyframes, Meta(description="when it was")]
    score: Annotated[float | None, Meta(description="0 to 100; null if too little was seen")]
    score_sigma: Annotated[float | None, Meta(description="one standard deviation of it; null together with it")]
    praise: Annotated[Praise | None, Meta(description="what was good; null for nothing that is sure")]
    cue: Annotated[Cue | None, Meta(description="what to correct; null for nothing that is sure")]
    silence: Annotated[
        Silence | None,
        Meta(
            description="what it means that there is no cue: fine, nothing was wrong; unsure, nothing that is sure enough to "
            "correct (or the lesson is older than this field); unseen, too little was seen but for what is praised; null with a cue"
        ),
    ]
    measures: Annotated[tuple[Measure, ...], Meta(description="those that the tablet shows first")]
    judgements: Annotated[tuple[Judgement, ...], Meta(description="one a fault of the action")]


class ActionSummary(Table, frozen=True, kw_only=True):
    """A pupil's attempts at one action."""

    action: Annotated[str, Meta(description="name of the action")]
    title: Annotated[str | None, Meta(description="in the report's language; null if it is not taught any more")]
    attempts: Annotated[int, Meta(description="how many")]
    scored: Annotated[int, Meta(description="how many of them have a score")]
    score: Annotated[float | None, Meta(description="mean of these scores; null if there is none, or if nobody was named")]
    score_sigma: Annotated[
        float | None, Meta(description="mean of their sigmas: one pupil's errors are alike, so more attempts make it no smaller")
    ]
    cue: Annotated[
        str | None, Meta(description="fault that was to be corrected most often, of equals the later one; null for none")
    ]
    cue_text: Annotated[str | None, Meta(description="its cue in the report's language")]
    cue_count: Annotated[int, Meta(description="in how many attempts")]


class PupilSummary(Table, frozen=True, kw_only=True):
    """A pupil in the lesson."""

    pupil: Annotated[str | None, Meta(description="code of the pupil; null for attempts of nobody who was named")]
    attempts: Annotated[int, Meta(description="how many")]
    actions: Annotated[tuple[ActionSummary, ...], Meta(description="in the order of their first attempts")]


class Lesson(Table, frozen=True, kw_only=True):
    """The lesson that is reported."""

    name: Annotated[str, Meta(description="as 'kinebox lessons' lists it")]
    title: Annotated[str, Meta(description="what people call it; may be empty")]
    begun: Annotated[str, Meta(description="day and time, with the time zone of the machine that reports, ISO 8601")]
    seconds: Annotated[float, Meta(description="its length")]
    kinebox: Annotated[str, Meta(description="version of KineBox that recorded it")]


class Report(Table, frozen=True, kw_only=True):
    """The file."""

    format: Annotated[Literal["kinebox-report"], Meta(description="always kinebox-report")] = FORMAT
    version: Annotated[int, Meta(description="of this schema; a new one where something is gone or means something else")] = VERSION
    language: Annotated[Language, Meta(description="of all titles and texts: en, zh, de or es")]
    source: Annotated[
        Source, Meta(description="recorded: as the tablet said on the day; evaluated: the recorded motion was evaluated again")
    ]
    lesson: Annotated[Lesson, Meta(description="the lesson")]
    pupils: Annotated[tuple[PupilSummary, ...], Meta(description="by code; who was not named comes last")]
    attempts: Annotated[tuple[Attempt, ...], Meta(description="in their order in the lesson")]
