"""Asking the recorder of a running box to begin or end a lesson, from outside the box.

A request is only heard if the bus has already connected both sides, and nobody answers it: so it is repeated until the recorder's
health says that it was done.
"""

import time
from collections.abc import Callable

from models.errors import UserError
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health, RecorderHealth
from models.messages.lesson import LessonRequest
from models.process import RECORDER, Bus, Subscription
from services.bus import join as bus_join

CONNECT_S = 3.0
HEARD_WITHIN_S = 15.0
"""The recorder starts last, up to five seconds after the others, and a busy machine takes as long again."""
BOX_HEARD_WITHIN_S = 5.0
"""Health comes every second from every process; the one that routes the bus needs no longer to be connected."""
SUPERVISOR_HEARD_WITHIN_S = 3.0
"""It speaks every second."""
DONE_WITHIN_S = 20.0
"""A box that starts or is busy may take as long until fusion begins anew for a lesson."""
_REPEAT_S = 1.0
_REFUSED_AFTER_S = 1.5
_ROUND_S = 0.2
_KEEP = 4


class Remote:
    """A place on the bus of a box from which its recorder is heard and asked."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self._subscription: Subscription = bus.subscribe(topics.ALL_HEALTH, keep=_KEEP)
        self._someone = False
        self.newest: Health | None = None
        """What the recorder said last."""
        self.heard_s = time.monotonic()
        """When any part of the box was heard last."""
        self._run_ns: int | None = None  # As the supervisor said it first; None before.

    def start(self, title: str) -> RecorderHealth:
        """Begin a lesson; its state once it has begun.

        Raises:
            UserError: no recorder is heard, one is recording already, or it cannot record.
        """
        now = self._current()
        if now.lesson:
            raise _taken(now)
        request = LessonRequest("start", title, time.monotonic_ns())
        begun = self._ask(request, lambda recorder: bool(recorder.lesson), "begin a lesson")
        if begun.asked_ns != request.t_ns:  # Somebody else asked at the same time, and was heard first.
            raise _taken(begun)
        return begun

    def stop(self, lesson: str = "") -> RecorderHealth | None:
        """End the lesson that is being recorded; its last state before, or None if none was.

        Args:
            lesson: the one to end, if only this one shall be: where another one is being recorded by now, that goes on.

        Raises:
            UserError: no recorder is heard, it does not end, or the lesson ended otherwise than it should have.
        """
        before = self._current()
        is_meant = before.lesson != "" and before.lesson == (lesson or before.lesson)
        if is_meant:
            request = LessonRequest("stop", lesson=before.lesson)
            self._ask(request, lambda recorder: recorder.lesson != before.lesson, "end the lesson")
        if self.newest is not None and refused(self.newest):
            raise UserError(self.newest.reason)
        return before if is_meant else None

    def listen(self, timeout_s: float) -> Health | None:
        """The recorder's next word; None if none came."""
        end_s = time.monotonic() + timeout_s
        while (remaining_s := end_s - time.monotonic()) > 0:
            delivery = self._subscription.receive(remaining_s)
            if delivery is None:
                break
            try:
                health = read_health(delivery.topic, delivery.payload)
            except codec.CodecError:
                continue
            self._someone = True
            self.heard_s = time.monotonic()
            if health.supervisor is not None and self._run_ns is None:
                self._run_ns = health.supervisor.started_ns
            if health.process == RECORDER:
                self.newest = health
                return health
        return None

    def is_another_run(self) -> bool:
        """Whether the box was started anew since it was heard first, by the next word of its supervisor."""
        first_ns = self._run_ns
        if first_ns is None:
            return False
        self._run_ns = None
        return self._hear_run() not in {first_ns, None}

    def _hear_run(self) -> int | None:
        end_s = time.monotonic() + SUPERVISOR_HEARD_WITHIN_S
        while self._run_ns is None and (remaining_s := end_s - time.monotonic()) > 0:
            self.listen(min(remaining_s, _ROUND_S))
        return self._run_ns

    def _current(self) -> RecorderHealth:
        """What the recorder does now; one that is being started again is waited for, and goes on with its lesson."""
        health = self.listen(BOX_HEARD_WITHIN_S)
        if health is None and self._someone:
            health = self.listen(HEARD_WITHIN_S - BOX_HEARD_WITHIN_S)
        if health is None:
            whom = "the box's recorder is not heard" if self._someone else "no part of the box is heard"
            raise UserError(f"{whom}; see what 'kinebox run' says about it, or start the box again")
        end_s = time.monotonic() + DONE_WITHIN_S
        while _comes_back(health) and (later := self.listen(max(end_s - time.monotonic(), 0.0))) is not None:
            health = later
        if _comes_back(health):
            raise UserError(f"the recorder is not back yet: {health.reason}; nothing was changed, try again")
        if health.state == "failed" or health.recorder is None:
            raise UserError(f"the recorder cannot record: {health.reason or 'it does not say why'}")
        return health.recorder

    def _ask(self, request: LessonRequest, done: Callable[[RecorderHealth], bool], what: str) -> RecorderHealth:
        asked_s = time.monotonic()
        again_s = asked_s
        while (now_s := time.monotonic()) < asked_s + DONE_WITHIN_S:
            if now_s >= again_s:
                self._bus.publish(topics.lesson_request(), codec.encode(request))
                again_s = now_s + _REPEAT_S
            health = self.listen(_ROUND_S)
            if health is None or health.recorder is None:
                continue
            if done(health.recorder):
                return health.recorder
            # What it says at first may be about the time before.
            if refused(health) and health.t_ns * 1e-9 > asked_s + _REFUSED_AFTER_S:
                raise UserError(f"the recorder cannot {what}: {health.reason}")
        reason = f": {self.newest.reason}" if self.newest is not None and self.newest.reason else ""
        raise UserError(f"the recorder did not {what} within {DONE_WITHIN_S:g} s{reason}")


def _taken(recorder: RecorderHealth) -> UserError:
    return UserError(f"lesson {recorder.lesson} is being recorded already; end it with 'kinebox record --stop'")


def _comes_back(health: Health) -> bool:
    """Whether there is no recorder at the moment, but will be."""
    return health.state == "starting" or any(trouble.code == "restarting" for trouble in health.troubles)


def refused(health: Health) -> bool:
    """Whether the recorder says that it cannot record; other troubles that it may have keep it from nothing."""
    return any(trouble.code == "not_recording" for trouble in health.troubles)


def join(endpoint: str) -> Bus:
    """A place on the bus of the box that runs.

    Raises:
        UserError: none runs, or it does not answer.
    """
    bus = bus_join.join(endpoint, CONNECT_S)
    if bus is None and bus_join.accepts(endpoint):
        raise UserError(f"the box at {endpoint} does not answer; 'kinebox doctor' says what hangs, or end it and start it again")
    if bus is None:
        raise UserError(f"no box runs at {endpoint}; start it with 'kinebox run', or name the site file of the one that runs")
    return bus


def require_title(title: str) -> None:
    """Raise UserError if no lesson can be called that."""
    try:
        title.encode()
        LessonRequest("start", title)
    except UnicodeEncodeError as error:
        raise UserError("--title: it holds bytes that are not UTF-8; type it anew") from error
    except ValueError as error:
        raise UserError(f"--title: {error}; shorten it") from error
