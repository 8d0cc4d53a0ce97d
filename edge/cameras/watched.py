"""A source under watch: one that ends is opened again, and pictures that cannot be what they claim are refused and said.

A camera's cable is pulled, its driver hands out the same buffer again and again, its clock is set. None of that may end the
process, be taken for movement, or wait for a person once it is over.
"""

from collections.abc import Callable

from edge.cameras.source import Clock, Frame, Source, SourceError
from models.errors import UserError
from models.messages.trouble import SourceCode, Trouble

SECOND_NS = 1_000_000_000
AHEAD_NS = SECOND_NS // 10
"""A picture cannot be of the future; the clock of a camera is known to some milliseconds only."""
BEHIND_NS = SECOND_NS
"""A picture that arrives so late is of no use, and rather its clock is wrong."""
OPEN_AGAIN_AFTER_NS = SECOND_NS // 2
"""So long a camera may show nothing but impossible times; then it is opened again, which sets its clock anew."""
STUCK_AFTER_NS = 5 * SECOND_NS
"""So long a camera may show the same picture; then it is opened again, which ends what its driver hangs in."""
_FIRST_WAIT_NS = SECOND_NS // 10
_LONGEST_WAIT_NS = SECOND_NS
_REMEMBERED_NS = SECOND_NS
"""A trouble is told for so long after it was over, that a report once a second has it."""
_REMEDIES: dict[SourceCode, str] = {
    "camera_ended": "check its cable, its power and its file",
    "camera_repeats": "if it stays so, unplug it and plug it in again",
    "camera_clock": "if it stays so, unplug it and plug it in again",
}
_BREATH_NS = 5_000_000
"""Between two pictures that are refused: a driver that repeats one may not even wait."""


class WatchedSource:
    """`Source` around whatever `open_source` opens.

    Args:
        open_source: opens the device or file.
        camera: its name, for what is said.
        clock: CLOCK_MONOTONIC.

    Raises:
        UserError: it cannot be opened the first time.
    """

    def __init__(self, open_source: Callable[[], Source], camera: str, clock: Clock) -> None:
        self._open_source = open_source
        self._camera = camera
        self._clock = clock
        self._source: Source | None = None
        self._skipped_before = 0
        self._last: tuple[int, int, int] | None = None  # epoch, index, t_mid_ns
        self._wrong_since_ns: int | None = None
        self._wait_ns = _FIRST_WAIT_NS
        self._open_at_ns = 0
        self._problem: Trouble | None = None
        self._problem_ns = 0
        try:
            self._source = open_source()
        except SourceError as error:
            self._ended(str(error))

    @property
    def skipped(self) -> int:
        """See `Source.skipped`; counted over all openings."""
        return self._skipped_before + (self._source.skipped if self._source is not None else 0)

    @property
    def problem(self) -> Trouble | None:
        """See `Source.problem`."""
        recent = self._clock.now_ns() - self._problem_ns < _REMEMBERED_NS
        return self._problem if recent or self._source is None else None

    def grab(self, timeout_s: float) -> Frame | None:
        """See `Source.grab`; None also for a picture that was refused, and while there is nothing open."""
        if self._source is None and not self._open_again(timeout_s):
            return None
        assert self._source is not None  # noqa: S101 - it was opened just now
        try:
            frame = self._source.grab(timeout_s)
        except SourceError as error:
            self._ended(str(error))
            return None
        return None if frame is None else self._checked(frame)

    def close(self) -> None:
        """See `Source.close`."""
        if self._source is not None:
            self._source.close()
            self._source = None

    def _checked(self, frame: Frame) -> Frame | None:
        now_ns = self._clock.now_ns()
        identity = frame.epoch, frame.index, frame.t_mid_ns
        # First: a picture that is shown for seconds has an old time, and its camera's clock is right all the same.
        if self._last is not None and identity[:2] == self._last[:2]:
            self._repeated(now_ns)
            return None
        ahead_ns = frame.t_mid_ns - now_ns
        if ahead_ns > AHEAD_NS or ahead_ns < -BEHIND_NS:
            words = f"its clock is {abs(ahead_ns) * 1e-9:.1f} s {'ahead' if ahead_ns > 0 else 'behind'}"
            self._refused("camera_clock", words, OPEN_AGAIN_AFTER_NS, now_ns)
            return None
        if self._last is not None and identity[2] <= self._last[2]:
            self._repeated(now_ns)
            return None
        self._last, self._wrong_since_ns, self._wait_ns = identity, None, _FIRST_WAIT_NS
        return frame

    def _repeated(self, now_ns: int) -> None:
        self._refused("camera_repeats", "it shows the same picture again", STUCK_AFTER_NS, now_ns)
        self._clock.sleep_until(now_ns + _BREATH_NS)

    def _refused(self, code: SourceCode, what: str, patience_ns: int, now_ns: int) -> None:
        """A picture cannot be what it claims; if only such come for longer than `patience_ns`, the source is opened again."""
        words = f"camera '{self._camera}': {what}"
        self._problem, self._problem_ns = Trouble(code, words, _REMEDIES[code]), now_ns
        self._wrong_since_ns = now_ns if self._wrong_since_ns is None else self._wrong_since_ns
        if now_ns - self._wrong_since_ns > patience_ns:
            self._gone(code, words)

    def _ended(self, why: str) -> None:
        self._gone("camera_ended", why)

    def _gone(self, code: SourceCode, why: str) -> None:
        """The source has ended, or shall: open it again in a while, which grows until a picture is good."""
        now_ns = self._clock.now_ns()
        self._skipped_before = self.skipped
        self.close()
        self._problem, self._problem_ns = Trouble(code, f"{why}; it is opened again", _REMEDIES[code]), now_ns
        self._open_at_ns = now_ns + self._wait_ns
        self._wait_ns = min(2 * self._wait_ns, _LONGEST_WAIT_NS)
        self._wrong_since_ns = None

    def _open_again(self, timeout_s: float) -> bool:
        now_ns = self._clock.now_ns()
        if now_ns < self._open_at_ns:
            self._clock.sleep_until(min(self._open_at_ns, now_ns + round(timeout_s * SECOND_NS)))
            return False
        try:
            self._source = self._open_source()
        except (SourceError, UserError) as error:
            self._ended(str(error))
            return False
        # A device counts its pictures from its opening; its times go on.
        self._last = None if self._last is None else (-1, -1, self._last[2])
        return True
