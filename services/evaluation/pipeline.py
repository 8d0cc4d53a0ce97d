"""The evaluation as one pure function: `state, out = step(state, event, config)`.

An event is a smooth motion as it arrives, or a word of a tablet about what pupils shall do. The same events give the same output to
the last bit, so that a lesson which is played shows its attempts again. The state is changed in place and belongs to the caller of
`step`.
"""

from dataclasses import dataclass, field
from typing import Final, Literal

from models.messages.feedback import ANY, ActivityRequest, Feedback
from models.messages.motion import JointState, Motion
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempts import AttemptFinder
from services.evaluation.config import EvaluationConfig
from services.evaluation.stream import Frame, Stream

AROUND_S: Final = 1.2
"""So much of the motion before and after an attempt is looked at with it, as far as it is there."""


@dataclass(frozen=True)
class EvaluationOutput:
    """What one event led to.

    Attributes:
        feedback: of the attempt that ended; `t_published_ns` is the newest motion's instant.
        refused: a tablet asked for an action that there is not.
    """

    feedback: Feedback | None = None
    refused: bool = False


NOTHING = EvaluationOutput()


@dataclass(eq=False)
class EvaluationState:
    """Everything that the evaluation remembers.

    Attributes:
        finder: of attempts.
        activity: what pupils do; `ANY` for whichever it is.
        chosen_by: whose word that was.
        stream: the newest smooth motion.
        attempts: how many were found.
    """

    finder: AttemptFinder
    activity: str
    chosen_by: Literal["site", "tablet"] = "site"
    stream: Stream = field(default_factory=Stream)
    attempts: int = 0

    @property
    def doing(self) -> Literal["waiting", "moving", "unknown"]:
        """What the pupil does as far as is known."""
        if not self.stream.frames or (self.stream.newest.states == JointState.UNKNOWN).all():
            return "unknown"
        return self.finder.state


def initial_state(config: EvaluationConfig) -> EvaluationState:
    """The state before the first event."""
    finder = AttemptFinder(tuple(config.standards.values()), config.frame_s)
    finder.choose(config.activity or None)
    return EvaluationState(finder, config.activity)


def step(
    state: EvaluationState, event: Motion | ActivityRequest, config: EvaluationConfig
) -> tuple[EvaluationState, EvaluationOutput]:
    """Take in one event. Live motions are not looked at."""
    if isinstance(event, ActivityRequest):
        return state, _choose(state, event, config)
    if event.kind != "smooth":
        return state, NOTHING
    frames = state.stream.take(event, config)
    if frames is None:
        state.finder.reset()
        frames = [state.stream.newest]
    feedback = None
    for frame in frames:
        feedback = _push(state, frame, config) or feedback
    return state, NOTHING if feedback is None else EvaluationOutput(feedback)


def _choose(state: EvaluationState, request: ActivityRequest, config: EvaluationConfig) -> EvaluationOutput:
    if request.activity != ANY and request.activity not in config.standards:
        return EvaluationOutput(refused=True)
    state.activity, state.chosen_by = request.activity, "tablet"
    state.finder.choose(request.activity or None)
    return NOTHING


def _push(state: EvaluationState, frame: Frame, config: EvaluationConfig) -> Feedback | None:
    found = state.finder.push(frame.joints_m, frame.number * config.frame_s)
    if found is None:
        return None
    if found.moments_s[0] < state.stream.frames[0].number * config.frame_s:
        return None  # It is longer than anything that is taught.
    track = state.stream.track(found.moments_s[0] - AROUND_S, found.moments_s[-1] + AROUND_S, config.frame_s)
    moments = Moments(state.stream.newest.number * config.frame_s, state.stream.t_ns, state.stream.epoch, config.speed)
    state.attempts += 1
    return appraise(track, found, "recognised" if state.activity == ANY else "chosen", moments, config)
