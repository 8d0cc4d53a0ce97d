"""The evaluation as one pure function: `state, out = step(state, event, config)`.

An event is a smooth motion as it arrives, or a word of a tablet: what pupils shall do, or whose turn it is. The same events give
the same output to the last bit, so that a lesson which is played shows its attempts again. The state is changed in place and
belongs to the caller of `step`.
"""

from collections import deque
from dataclasses import dataclass, field
from typing import Final, Literal

from models.messages.feedback import ANY, ActivityRequest, Feedback
from models.messages.motion import JointState, Motion
from models.messages.pupil import NOBODY, PupilTurn, pupil_at
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import AROUND_S, FoundAttempt
from services.evaluation.attempts import AttemptFinder
from services.evaluation.config import EvaluationConfig
from services.evaluation.stream import Stream

_TURNS: Final = 64
"""So many turns are remembered: one may have ended while the attempt in it is still under way. Before them it was nobody's."""


@dataclass(frozen=True)
class EvaluationOutput:
    """What one event led to.

    Attributes:
        feedback: of the attempt that ended; `t_published_ns` is the newest motion's instant.
        failure: what went wrong with an attempt that ended, of which nothing can be said then.
        refused: a tablet asked for an action that there is not.
    """

    feedback: Feedback | None = None
    failure: Exception | None = None
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
        failures: of how many attempts nothing could be said.
        turns: the newest of them, in the order of their times.
    """

    finder: AttemptFinder
    activity: str
    chosen_by: Literal["site", "tablet"] = "site"
    stream: Stream = field(default_factory=Stream)
    attempts: int = 0
    failures: int = 0
    turns: deque[PupilTurn] = field(default_factory=lambda: deque(maxlen=_TURNS))

    @property
    def turn(self) -> PupilTurn:
        """The latest of the turns; nobody's before the first."""
        return self.turns[-1] if self.turns else PupilTurn(NOBODY, 0)

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
    state: EvaluationState, event: Motion | ActivityRequest | PupilTurn, config: EvaluationConfig
) -> tuple[EvaluationState, EvaluationOutput]:
    """Take in one event. Live motions are not looked at."""
    if isinstance(event, ActivityRequest):
        return state, _choose(state, event, config)
    if isinstance(event, PupilTurn):
        if event.t_ns > state.turn.t_ns:
            state.turns.append(event)
        return state, NOTHING
    if event.kind != "smooth":
        return state, NOTHING
    output = NOTHING
    if not state.stream.goes_on(event, config):
        output = finish(state, config)
        state.finder.reset()
    for frame in state.stream.take(event, config):
        if state.finder.advance(frame.joints_m, frame.number * config.frame_s):
            output = finish(state, config)
    return state, output


def finish(state: EvaluationState, config: EvaluationConfig) -> EvaluationOutput:
    """Tell of the attempt that has ended, if one has: it is decided on, or nothing that follows has to do with it."""
    try:
        found = state.finder.finish()
        return NOTHING if found is None else EvaluationOutput(_judged(state, found, config))
    except Exception as error:  # noqa: BLE001 - whatever is the matter with one attempt, the next one is told of
        state.failures += 1
        return EvaluationOutput(failure=error)


def _choose(state: EvaluationState, request: ActivityRequest, config: EvaluationConfig) -> EvaluationOutput:
    if request.activity != ANY and request.activity not in config.standards:
        return EvaluationOutput(refused=True)
    over = NOTHING if request.activity == state.activity else finish(state, config)
    state.activity, state.chosen_by = request.activity, "tablet"
    state.finder.choose(request.activity or None)
    return over


def _judged(state: EvaluationState, found: FoundAttempt, config: EvaluationConfig) -> Feedback:
    state.attempts += 1
    track = state.stream.track(found.moments_s[0] - AROUND_S, found.moments_s[-1] + AROUND_S, config.frame_s)
    moments = Moments(state.stream.newest.number * config.frame_s, state.stream.t_ns, state.stream.epoch, config.speed)
    # Whoever was up when it began: by its end the next one may have been called.
    pupil = pupil_at(state.turns, moments.ended_ns(found.moments_s[0]))
    return appraise(track, found, "recognised" if state.activity == ANY else "chosen", moments, config, pupil)
