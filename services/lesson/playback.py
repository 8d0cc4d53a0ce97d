"""The replay process: plays a lesson in the place of fusion and its cameras, at the lesson's own pace or another.

What was observed goes through fusion's step again; motions come out with their times moved to now, so that a figure is as old
when it is shown as it was in the lesson. What cameras and fusion said of themselves is said again at its time. Attempts are found
and judged again by the evaluation, which runs beside and is waited for, so that it sees the lesson from its first figure on; it is
told what pupils were to do at that time of the lesson, and who was up.
"""

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import msgspec
import structlog

from models.errors import UserError
from models.messages import codec, topics
from models.messages.attempts import AttemptsBegin
from models.messages.feedback import ActivityRequest
from models.messages.health import Health, ReplayHealth
from models.messages.motion import Motion
from models.messages.pupil import NOBODY, PupilTurn
from models.process import EDGE, EVALUATION, ROUTER, Playback, ProcessContext, process_name
from services.fusion.warm_up import warm_up
from services.lesson.lesson_reader import Lesson, LessonPart, open_lesson
from services.lesson.pupils import turns_of
from services.lesson.replay import Replayed, configuration, decode, replay
from services.support.health import HealthReporter

SECOND_NS = 1_000_000_000
LONGEST_PAUSE_NS = 3 * SECOND_NS
"""Where nothing was recorded for longer (fusion was restarted, the disk was full), no more than this is waited."""
_LATE_NS = SECOND_NS // 2
"""Who is later than this gives up what was lost instead of hurrying after it."""
_SAID_FOR_NS = 3 * SECOND_NS
"""What a process of the lesson said is said again for so long in the lesson's time; after that it was silent."""
_ROUND_S = 0.1
EVALUATION_WITHIN_NS = 30 * SECOND_NS
"""So long the lesson waits for the evaluation: an attempt with which it begins would else be missed, and all numbers be too small
by one. A figure without words is still better than none for ever."""

log = structlog.get_logger()


def prepare() -> None:
    """Compile before the process begins, as fusion does."""
    warm_up()


def main(context: ProcessContext) -> None:
    """Play until told to stop or, unless it shall go on for ever, until the lesson's end.

    Raises:
        UserError: the lesson cannot be read or replayed.
    """
    if context.playback is None:
        raise UserError("process 'replay' plays a lesson; start it with 'kinebox replay LESSON'")
    with open_lesson(Path(context.playback.file)) as lesson:
        Player(context, context.playback, lesson).run()


@dataclass
class Pace:
    """Which instant of the lesson is due when.

    Attributes:
        speed: seconds of the lesson a second.
        from_ns: an instant of the lesson, as fusion dated it.
        at_ns: when that instant is due, CLOCK_MONOTONIC now.
    """

    speed: float
    from_ns: int
    at_ns: int

    def due_ns(self, t_ns: int, now_ns: int) -> int:
        """When an instant of the lesson is due; never long before `now_ns`, nor further ahead than a pause may last."""
        due_ns = self.at_ns + round((t_ns - self.from_ns) / self.speed)
        bounded_ns = min(max(due_ns, now_ns - _LATE_NS), now_ns + LONGEST_PAUSE_NS)
        if bounded_ns != due_ns:
            self.from_ns, self.at_ns = t_ns, bounded_ns
        return bounded_ns


class Player:
    """The loop of `main`, with everything from outside passed in."""

    def __init__(
        self, context: ProcessContext, playback: Playback, lesson: Lesson, clock_ns: Callable[[], int] = time.monotonic_ns
    ) -> None:
        self._context = context
        self._bus = context.bus
        self._playback = playback
        self._lesson = lesson
        self._clock_ns = clock_ns
        self._config = configuration(lesson.header.preset)
        self._rig = lesson.header.rig()
        self._players = {ROUTER, *(process_name(EDGE, name) for name in self._rig.names)}
        self._said: dict[str, tuple[int, Health]] = {}
        self._asked: ActivityRequest | None = None
        self._ask_again = threading.Event()
        self._evaluated = threading.Event()
        self._position_ns = 0
        self._begin_ns = self._end_ns = lesson.header.started_ns
        self._turns = turns_of(self._measured())
        self._turn = PupilTurn(NOBODY, 0)
        self._reporter = HealthReporter(context.name, context.bus, context.resources, clock_ns)

    def run(self) -> None:
        """Play the lesson, again and again if that is wished."""
        self._bus.declare_alive(topics.alive(self._context.name))
        self._bus.watch_alive(topics.alive(EVALUATION), self._evaluation_is)
        if not self._wait_for_evaluation():
            return
        while not self._context.stop.is_set():
            self._play(replay(self._lesson.parts(), self._rig, self._config))
            # A round without an entry, and thus without a wait of its own, must not spin.
            if not self._playback.loop or not self._wait_until(self._clock_ns() + round(_ROUND_S * SECOND_NS)):
                return

    def _evaluation_is(self, _topic: str, alive: bool) -> None:
        """Told from a thread of the bus: the evaluation came, also again, or went."""
        if alive:
            self._evaluated.set()
            self._ask_again.set()

    def _wait_for_evaluation(self) -> bool:
        """Go round until the evaluation hears everything, or has had its time; False if the process shall end."""
        latest_ns = self._clock_ns() + EVALUATION_WITHIN_NS
        while not self._evaluated.is_set():
            now_ns = self._clock_ns()
            if now_ns >= latest_ns:
                log.warning("the evaluation is not there: attempts at the lesson's beginning are missed")
                return True
            if not self._wait_until(now_ns + round(_ROUND_S * SECOND_NS)):
                return False
        return True

    def _measured(self) -> Iterator[LessonPart]:
        """The lesson's parts; from when to when it is becomes known as they are read, for one reading of a long one is enough."""
        times_ns: list[int] = []
        for part in self._lesson.parts():
            if part.entries:
                times_ns = [*times_ns[:1], part.entries[0].t_ns, part.entries[-1].t_ns]
                self._begin_ns, self._end_ns = times_ns[0], times_ns[-1]
            yield part

    def _play(self, items: Iterator[Replayed]) -> None:
        self._said.clear()
        self._asked = None
        self._call(PupilTurn(NOBODY, self._clock_ns()))  # Whoever was up at the end is not up at the beginning.
        # The same attempts come again, and have the same numbers: those of `kinebox report --again`.
        self._bus.publish(topics.attempts_begin(), codec.encode(AttemptsBegin(self._clock_ns())))
        turns = deque(self._turns)
        pace = Pace(self._playback.speed, self._begin_ns, self._clock_ns())
        for item in items:
            entry = item.entry
            # Fusion has done its work already: what it gives out leaves when it is due.
            due_ns = pace.due_ns(entry.t_ns, self._clock_ns())
            if not self._wait_until(due_ns):
                return
            self._position_ns = entry.t_ns - self._begin_ns
            if entry.kind == "health":
                said = decode(entry, Health)
                if said.process in self._players:
                    self._said[said.process] = (entry.t_ns, said)
                elif said.process == EVALUATION and said.evaluation is not None:
                    self._ask(ActivityRequest(said.evaluation.activity))
            for motion in item.motions:
                shown = moved(motion, due_ns - entry.t_ns, self._clock_ns())
                if motion.kind == "smooth":
                    self._call_until(motion.t_ns, shown.t_ns, turns)
                self._bus.publish(topics.motion(motion.kind), codec.encode(shown))

    def _wait_until(self, due_ns: int) -> bool:
        """Go round until then, at least once; False if the process shall end."""
        while True:
            self._context.beat()
            if self._reporter.due():
                self._speak()
            if self._ask_again.is_set() and self._asked is not None:
                self._ask_again.clear()
                self._bus.publish(topics.activity_request(), codec.encode(self._asked))
                self._call(self._turn)
            remaining_s = (due_ns - self._clock_ns()) * 1e-9
            if self._context.stop.wait(max(min(remaining_s, _ROUND_S), 0.0)):
                return False
            if remaining_s <= _ROUND_S:
                return True

    def _ask(self, request: ActivityRequest) -> None:
        """Say what pupils were to do, when that changed; between two changes whoever watches may choose otherwise."""
        if request != self._asked:
            self._asked = request
            self._ask_again.set()

    def _call_until(self, t_ns: int, shown_ns: int, turns: deque[PupilTurn]) -> None:
        """Say who was up until an instant of the lesson, which is shown as `shown_ns`: so the evaluation dates beginnings, too."""
        while turns and turns[0].t_ns <= t_ns:
            turn = turns.popleft()
            since_ns = shown_ns - round((t_ns - turn.t_ns) / self._playback.speed)
            self._call(PupilTurn(turn.pupil, max(since_ns, self._turn.t_ns + 1)))

    def _call(self, turn: PupilTurn) -> None:
        """Say who was up."""
        self._turn = turn
        self._bus.publish(topics.pupil_turn(), codec.encode(turn))

    def _speak(self) -> None:
        length_s = (self._end_ns - self._begin_ns) * 1e-9
        self._reporter.report(replay=ReplayHealth(self._position_ns * 1e-9, length_s, self._playback.speed))
        lesson_ns, now_ns = self._begin_ns + self._position_ns, self._clock_ns()
        for process, (t_ns, health) in self._said.items():
            if lesson_ns - t_ns < _SAID_FOR_NS:
                self._bus.publish(topics.health(process), codec.encode(msgspec.structs.replace(health, t_ns=now_ns)))


def moved(motion: Motion, by_ns: int, now_ns: int) -> Motion:
    """A motion of the lesson as one that is published now: all its times are later by `by_ns`."""
    result: Motion = msgspec.structs.replace(
        motion, t_ns=motion.t_ns + by_ns, t_newest_ns=motion.t_newest_ns + by_ns, t_published_ns=now_ns
    )
    return result
