"""What was made of an attempt (evaluation -> tablet, recorder), and which action is asked for (tablet -> evaluation)."""

import math
from enum import IntEnum
from itertools import pairwise
from typing import Annotated, Final, Literal, get_args

import msgspec
import numpy as np
from msgspec import Meta

from models.arrays import Float32, UInt8
from models.messages.motion import JointState
from models.messages.observation import require_array, require_count
from models.messages.pupil import NOBODY, PupilCodeOrNone
from models.skeleton import coco
from models.teaching.measure import PHASES, Phase

MAX_FRAMES: Final = 1200
"""Forty seconds at 30 Hz: longer than the longest standard that there may be, performed as slowly as counts as an attempt at it."""
MAX_ENTRIES: Final = 64
"""Judgements or measures of one attempt."""
MAX_SHOWN: Final = 3
MAX_VALUE: Final = 1e9
"""No measure of a pupil is larger; what lies beyond is no measure but a mistake."""

ANY: Final = ""
"""In the place of an action: whichever it is."""

Name = Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,47}\Z")]
"""Of an action, a fault or a measure, as in `models.teaching`."""
NameOrNone = Annotated[str, Meta(pattern=r"^([a-z][a-z0-9_]{0,47})?\Z")]
"""The same, or empty for none."""
Unit = Annotated[str, Meta(max_length=16)]
Verdict = Literal["good", "fair", "poor", "unknown"]
VERDICTS: Final[tuple[Verdict, ...]] = get_args(Verdict)
Silence = Literal["fine", "unsure", "unseen"]
"""What it means that nothing is corrected: nothing was wrong; nothing that is sure enough; too little was seen."""


class Colour(IntEnum):
    """How far a joint is from where it should be, in one frame. Grey is: nobody knows, and it is never shown as good."""

    GREY = 0
    GREEN = 1
    YELLOW = 2
    RED = 3


class Judgement(msgspec.Struct, frozen=True):
    """How much of a fault there was.

    Attributes:
        fault: its name.
        severity: 0 is as it should be, 1 is the fault as a teacher would call it; None if it could not be seen.
        sigma: one standard deviation of it; None together with it.
    """

    fault: Name
    severity: float | None
    sigma: float | None

    def __post_init__(self) -> None:
        _require_estimate(f"the severity of {self.fault}", self.severity, self.sigma)

    @property
    def known(self) -> bool:
        """Whether it could be seen at all."""
        return self.severity is not None


class MeasureResult(msgspec.Struct, frozen=True):
    """One measure of an attempt.

    Attributes:
        name: of the measure.
        value: in `unit`; None if it could not be measured.
        sigma: one standard deviation of it; None together with it.
        unit: as in `models.teaching` ("deg", "cm", "pct", "m_s", "s", "deg_s").
        verdict: what a teacher would say; "unknown" if there is no value, or none that is sure enough.
        low, high: what is good lies between them; None where there is no such bound.
    """

    name: Name
    value: float | None
    sigma: float | None
    unit: Unit
    verdict: Verdict
    low: float | None = None
    high: float | None = None

    def __post_init__(self) -> None:
        _require_estimate(f"the measure {self.name}", self.value, self.sigma)
        for bound in (self.low, self.high):
            if bound is not None:
                _require_value(f"a bound of {self.name}", bound)
        if self.low is not None and self.high is not None and self.low > self.high:
            raise ValueError(f"the bounds of {self.name} are exchanged: {self.low:g} and {self.high:g}")
        if self.value is None and self.verdict != "unknown":
            raise ValueError(f"the measure {self.name} has the verdict {self.verdict}, and no value")


class Feedback(msgspec.Struct, frozen=True, eq=False, omit_defaults=True):
    """One attempt and what is to be said of it.

    Frame i of the T frames is at `t_first_ns + i * frame_ns`; the keyframes lie within them, as a rule with a little before the
    first and after the last.

    Attributes:
        id: names the attempt; the instant of its end in milliseconds, so that it is unique in a run of the machine.
        epoch: see `Observation.epoch`.
        action: what was tried.
        by: whether that was chosen by a person, or recognised.
        handed: the side that leads.
        keyframes_ns: CLOCK_MONOTONIC of start, exertion, peak and end, in this order.
        t_published_ns: CLOCK_MONOTONIC when it was handed to the bus.
        score: 0 to 100; None if too little could be seen.
        score_sigma: one standard deviation of it; None together with it.
        praise: the fault whose point was good, to be said first; empty for none.
        cue: the fault that is to be corrected; empty for none.
        cue_certainty: how likely it is that this fault was made, 0 to 1; 0 without a cue.
        judgements: of every fault that the action has.
        measures: all that the action asks for.
        shown: names of at most three of the measures, for the page.
        t_first_ns: CLOCK_MONOTONIC of the first frame.
        frame_ns: from one frame to the next.
        joints_m: (T, 17, 3) COCO keypoints in the world frame, metres; zero and without meaning where UNKNOWN.
        states: (T, 17) `JointState`.
        colours: (T, 17) `Colour`; grey where the state is not SEEN.
        standard_m: (T, 17, 3) how it should look: the standard at the moment that a frame is beside, at the pupil's place, heading
            and size; NaN where there is none.
        pupil: code of who was up when the attempt began; `NOBODY` for nobody who was named, which is left out on the wire.
        fine: nothing is to be corrected, and that is sure: every fault was judged, none is likely to have been made, and no shown
            measure is poor. False, and left out on the wire, with a cue, in doubt, and in lessons from before this was said.
        keyframes_unseen: those around which the pupil was not seen, so that `keyframes_ns` has but where the standard has them;
            left out on the wire where there are none, and in lessons from before this was said.
    """

    id: int
    epoch: int
    action: Name
    by: Literal["recognised", "chosen"]
    handed: Literal["right", "left"]
    keyframes_ns: tuple[int, int, int, int]
    t_published_ns: int
    score: float | None
    score_sigma: float | None
    praise: NameOrNone
    cue: NameOrNone
    cue_certainty: float
    judgements: Annotated[tuple[Judgement, ...], Meta(max_length=MAX_ENTRIES)]
    measures: Annotated[tuple[MeasureResult, ...], Meta(max_length=MAX_ENTRIES)]
    shown: Annotated[tuple[Name, ...], Meta(max_length=MAX_SHOWN)]
    t_first_ns: int
    frame_ns: int
    joints_m: Float32
    states: UInt8
    colours: UInt8
    standard_m: Float32
    pupil: PupilCodeOrNone = NOBODY
    fine: bool = False
    keyframes_unseen: Annotated[tuple[Phase, ...], Meta(max_length=len(PHASES))] = ()

    def __post_init__(self) -> None:
        for field in ("id", "epoch", "t_published_ns", "t_first_ns", "frame_ns"):
            require_count(field, getattr(self, field))
        _require_estimate("the score", self.score, self.score_sigma)
        if self.score is not None and not 0 <= self.score <= 100:
            raise ValueError(f"score must be within 0 and 100, not {self.score}")
        self._require_what_is_said()
        self._require_frames()
        self._require_keyframes()

    def _require_what_is_said(self) -> None:
        if not 0 <= self.cue_certainty <= 1 or (not self.cue and self.cue_certainty > 0):
            raise ValueError(f"cue_certainty must be within 0 and 1, and 0 without a cue, not {self.cue_certainty}")
        faults = _require_different("judgements", [judgement.fault for judgement in self.judgements])
        measures = _require_different("measures", [measure.name for measure in self.measures])
        if not {self.cue, self.praise} - {""} <= faults:
            raise ValueError("cue and praise must be among the faults that were judged")
        if self.cue and self.cue == self.praise:
            raise ValueError("the same point cannot be good and to be corrected")
        if not _require_different("shown", list(self.shown)) <= measures:
            raise ValueError("what is shown must be among the measures")
        if self.fine and not self._can_be_fine:
            raise ValueError("fine is only what was judged as a whole, without anything to correct and without a poor measure")

    def _require_frames(self) -> None:
        count = len(self.states) if self.states.ndim else 0
        if not 1 <= count <= MAX_FRAMES or not 0 < self.frame_ns <= 10**9:
            raise ValueError(f"an attempt has 1 to {MAX_FRAMES} frames, at most a second apart, not {count}, {self.frame_ns} ns")
        require_array("joints_m", self.joints_m, (count, coco.COUNT, 3))
        for field, highest in (("states", JointState.SEEN), ("colours", Colour.RED)):
            array = getattr(self, field)
            require_array(field, array, (count, coco.COUNT), np.uint8)
            if array.max() > highest:
                raise ValueError(f"{field} must be within 0 and {highest:d}, not {array.max()}")
        if (self.colours[self.states != JointState.SEEN] != Colour.GREY).any():
            raise ValueError("a joint that was not seen is grey")
        # NaN is allowed there, and infinity is not.
        known = np.where(np.isnan(self.standard_m), np.float32(0), self.standard_m)
        require_array("standard_m", known, (count, coco.COUNT, 3))

    def _require_keyframes(self) -> None:
        last_ns = self.t_first_ns + (len(self.states) - 1) * self.frame_ns
        require_count("the last frame", last_ns)
        if not all(before < after for before, after in pairwise(self.keyframes_ns)):
            raise ValueError(f"keyframes_ns must follow one another, not {self.keyframes_ns}")
        if not self.t_first_ns <= self.keyframes_ns[0] < self.keyframes_ns[-1] <= last_ns:
            raise ValueError(f"keyframes_ns must be within {self.t_first_ns} and {last_ns}, not {self.keyframes_ns}")
        _require_different("keyframes_unseen", list(self.keyframes_unseen))

    @property
    def _can_be_fine(self) -> bool:
        poor = {measure.name for measure in self.measures if measure.verdict == "poor"}
        judged = self.score is not None and all(judgement.known for judgement in self.judgements)
        return judged and not self.cue and poor.isdisjoint(self.shown)

    @property
    def silence(self) -> Silence | None:
        """What it means that nothing is corrected, for whoever shows it; None if something is."""
        if self.cue:
            return None
        if self.score is None:
            return "unseen"
        return "fine" if self.fine else "unsure"

    def frame_of(self, t_ns: int) -> int:
        """The frame nearest to an instant between the first and the last."""
        return (t_ns - self.t_first_ns + self.frame_ns // 2) // self.frame_ns


class ActivityRequest(msgspec.Struct, frozen=True):
    """What pupils shall do from now on (tablet -> evaluation).

    Attributes:
        activity: an action's name; `ANY` if whatever they do shall be recognised.
    """

    activity: NameOrNone


def _require_different(field: str, names: list[str]) -> set[str]:
    if len(set(names)) != len(names):
        raise ValueError(f"{field} names something twice: {', '.join(names)}")
    return set(names)


def _require_value(what: str, value: float) -> None:
    if not (math.isfinite(value) and abs(value) <= MAX_VALUE):
        raise ValueError(f"{what} must be within +-{MAX_VALUE:g}, not {value}")


def _require_estimate(what: str, value: float | None, sigma: float | None) -> None:
    if (value is None) != (sigma is None):
        raise ValueError(f"{what} has a value without a sigma, or the reverse")
    if value is None or sigma is None:
        return
    _require_value(what, value)
    if not 0 <= sigma <= MAX_VALUE:
        raise ValueError(f"the sigma of {what} must be within 0 and {MAX_VALUE:g}, not {sigma}")
