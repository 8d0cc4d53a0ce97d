"""The evaluation process: smooth motion and the teacher's choice in; feedback and health out. `pipeline` does the thinking."""

import time
from dataclasses import dataclass

import msgspec
import structlog

from models.messages import codec, topics
from models.messages.attempts import AttemptsBegin, FeedbackRequest
from models.messages.feedback import ActivityRequest, Feedback
from models.messages.health import EvaluationHealth
from models.messages.motion import Motion
from models.messages.pupil import PupilCorrections, PupilTurn
from models.messages.trouble import Trouble, messages_refused
from models.process import Delivery, ProcessContext
from services.evaluation.config import VOCABULARY, WHICHEVER, EvaluationConfig
from services.evaluation.memory import Memory
from services.evaluation.pipeline import EvaluationOutput, initial_state, step
from services.evaluation.taught import configuration
from services.evaluation.warm_up import warm_up
from services.support.health import HealthReporter
from services.support.teaching_files import load_standards, load_teachings

KEEP = 64
"""Unread motions: an attempt is made of all of them, and while one is evaluated, on a busy box, some wait."""
SECOND_NS = 1_000_000_000
SILENT_NS = SECOND_NS
"""Without motion for so long nobody knows what the pupil does."""
_ROUND_S = 0.1

log = structlog.get_logger()


def prepare() -> None:
    """Have every kernel ready, before anybody waits for a word."""
    warm_up(EvaluationConfig(load_teachings(None, VOCABULARY), load_standards(None)))


def main(context: ProcessContext) -> None:
    """Serve until told to stop.

    Raises:
        UserError: what is taught cannot be read.
    """
    EvaluationLoop(context, configuration(context.site, context.data, context.playback)).run()


@dataclass
class _Second:
    """Counted between two health messages."""

    missed_before: int = 0
    motions: int = 0
    spent_ns: int = 0
    rejected: int = 0


class EvaluationLoop:
    """The loop of `main`, with everything from outside passed in."""

    def __init__(self, context: ProcessContext, config: EvaluationConfig) -> None:
        self._context = context
        self._bus = context.bus
        self._config = config
        self._state = initial_state(config)
        self._memory = Memory()
        self._heard_ns = time.monotonic_ns() - SILENT_NS
        self._attempt_ms = 0.0
        self._second = _Second()
        self._reporter = HealthReporter(context.name, context.bus, context.resources)

    def run(self) -> None:
        """Take motions and wishes as they come; once a second, say how things are."""
        subscription = self._bus.subscribe(
            topics.motion("smooth"),
            topics.activity_request(),
            topics.pupil_turn(),
            topics.pupil_corrections(),
            topics.attempts_begin(),
            topics.feedback_request(),
            keep=KEEP,
        )
        # Whoever sees the token may ask: from now on everything is heard.
        self._bus.declare_alive(topics.alive(self._context.name))
        try:
            while not self._context.stop.is_set():
                delivery = subscription.receive(_ROUND_S)
                if delivery is not None:
                    self._receive(delivery)
                if self._reporter.due():
                    self._second_passed()
        finally:
            subscription.close()

    def _receive(self, delivery: Delivery) -> None:
        try:
            self._take(delivery)
        except codec.CodecError as error:
            if self._second.rejected == 0:  # one a second says enough, and fills no disk
                log.warning("message refused", topic=delivery.topic, reason=str(error))
            self._second.rejected += 1

    def _take(self, delivery: Delivery) -> None:
        """What a message asks for; CodecError if it cannot be read."""
        payload = delivery.payload
        if delivery.topic == topics.activity_request():
            self._choose(codec.decode(payload, ActivityRequest))
        elif delivery.topic == topics.pupil_turn():
            self._take_turn(codec.decode(payload, PupilTurn))
        elif delivery.topic == topics.pupil_corrections():
            self._memory.correct(codec.decode(payload, PupilCorrections).corrections)
        elif delivery.topic == topics.attempts_begin():
            self._begin_list(codec.decode(payload, AttemptsBegin))
        elif delivery.topic == topics.feedback_request():
            answer = self._memory.before(codec.decode(payload, FeedbackRequest).before)
            self._bus.publish(topics.remembered_feedback(), codec.encode(answer))
        else:
            self._see(codec.decode(payload, Motion))

    def _see(self, motion: Motion) -> None:
        began_ns = time.thread_time_ns()
        self._state, output = step(self._state, motion, self._config)
        spent_ns = time.thread_time_ns() - began_ns
        self._heard_ns = time.monotonic_ns()
        self._second.motions += 1
        self._second.spent_ns += spent_ns
        if output.feedback is not None:
            self._attempt_ms = spent_ns * 1e-6
        self._tell(output)

    def _choose(self, request: ActivityRequest) -> None:
        self._state, output = step(self._state, request, self._config)
        if output.refused:
            log.warning("there is no such action", activity=request.activity)
            self._second.rejected += 1
            return
        self._tell(output)
        log.info("activity", chosen=request.activity or WHICHEVER)
        self._second_passed()  # Who chose it is waiting to hear that it was done.

    def _take_turn(self, turn: PupilTurn) -> None:
        if turn.t_ns > time.monotonic_ns():
            raise codec.CodecError("a turn of the future, which would outdo all until then")
        before = self._state.turn
        self._state, _ = step(self._state, turn, self._config)
        if self._state.turn != before:
            self._second_passed()  # As above. That a turn is told of again is no news.

    def _begin_list(self, begin: AttemptsBegin) -> None:
        if begin.t_ns > time.monotonic_ns():
            raise codec.CodecError("a list that begins in the future, which would outdo all until then")
        if self._memory.begin(begin):
            self._second_passed()  # As above.

    def _tell(self, output: EvaluationOutput) -> None:
        if output.failure is not None:
            log.error("an attempt could not be judged", attempt=self._state.attempts, exc_info=output.failure)
        if output.feedback is not None:
            self._publish(output.feedback)

    def _publish(self, feedback: Feedback) -> None:
        now_ns = time.monotonic_ns()
        stamped: Feedback = msgspec.structs.replace(feedback, t_published_ns=now_ns)
        self._bus.publish(topics.feedback(), codec.encode(stamped))
        self._memory.note(stamped)
        after_s = (now_ns - feedback.keyframes_ns[-1]) * 1e-9
        said = {"cue": feedback.cue or "none", "praise": feedback.praise or "none"}
        log.info("attempt", action=feedback.action, **said, after_s=round(after_s, 2))

    def _second_passed(self) -> None:
        second, state = self._second, self._state
        missed = state.stream.missed - second.missed_before
        self._second = _Second(state.stream.missed)
        silent = time.monotonic_ns() - self._heard_ns >= SILENT_NS
        evaluation = EvaluationHealth(
            activity=state.activity,
            chosen_by=state.chosen_by,
            state="unknown" if silent else state.doing,
            attempts=state.attempts,
            failures=state.failures,
            frame_ms=second.spent_ns * 1e-6 / max(second.motions, 1),
            attempt_ms=self._attempt_ms,
            missed=missed,
            rejected=second.rejected,
            pupil=state.turn.pupil,
            pupil_since_ns=state.turn.t_ns,
            list_since_ns=self._memory.since_ns,
            list_count=self._memory.count,
            list_newest=self._memory.newest,
        )
        troubles = _troubles(missed, second.rejected)
        self._reporter.report("degraded" if troubles else "ok", troubles, evaluation=evaluation)


def _troubles(missed: int, rejected: int) -> tuple[Trouble, ...]:
    lost = f"{missed} figures of the last second were missed, and an attempt in them may be grey or go unseen"
    found = [Trouble("motion_missed", lost, "give the box more CPU, or take fewer cameras")] if missed else []
    found += [messages_refused(rejected)] if rejected else []
    return tuple(found)
