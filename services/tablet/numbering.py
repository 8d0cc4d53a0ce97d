"""Numbers of the attempts on the list: those of the lesson that is being recorded, as a report counts; else counted from the first.

Nothing is counted twice: while a lesson is recorded, what its file holds has the number that the recorder says, and else the
evaluation's count goes. In between, an attempt is the one after those before it. Reads no clock.
"""

from bisect import bisect_left
from collections.abc import Sequence
from typing import NamedTuple


class _Counted(NamedTuple):
    """An attempt's name and its number."""

    attempt: int
    number: int


class _Lesson(NamedTuple):
    """How many attempts the lesson's file holds, and the names of the last of them, in their order."""

    attempts: int
    newest: tuple[int, ...]


_NOTHING = _Counted(0, 0)


class Numbering:
    """Who says which number an attempt has. Attempts go by their names (`Feedback.id`), which rise."""

    def __init__(self) -> None:
        self.begin()

    def begin(self) -> None:
        """The list began anew."""
        self._counted = _NOTHING
        self._lesson: _Lesson | None = None

    def counted(self, attempt: int, number: int) -> None:
        """The evaluation has published so many, of which this was the last."""
        if attempt >= self._counted.attempt:
            self._counted = _Counted(attempt, number)

    def recorded(self, attempts: int, newest: tuple[int, ...]) -> None:
        """The lesson's file holds so many, of which these are the last."""
        self._lesson = _Lesson(attempts, newest)

    def passed(self, attempt: int, number: int | None) -> None:
        """The oldest attempt leaves the list; those that follow go on from its number."""
        if number is None:
            return
        if self._lesson is not None and attempt > max(self._lesson.newest, default=0):
            self._lesson = _Lesson(number, (attempt,))
        if attempt > self._counted.attempt:
            self._counted = _Counted(attempt, number)

    def of(self, attempts: Sequence[int]) -> list[int | None]:
        """The numbers of attempts that rise; None for one that the lesson does not hold."""
        if self._lesson is not None:
            return self._in_lesson(attempts, self._lesson)
        place = bisect_left(attempts, self._counted.attempt)
        there = place < len(attempts) and attempts[place] == self._counted.attempt
        first = self._counted.number - place
        return [first + index + (index >= place and not there) for index in range(len(attempts))]

    def _in_lesson(self, attempts: Sequence[int], lesson: _Lesson) -> list[int | None]:
        first = lesson.attempts - len(lesson.newest) + 1
        known = {attempt: number for number, attempt in enumerate(lesson.newest, start=first)}
        last, count = max(lesson.newest, default=0), lesson.attempts
        numbers: list[int | None] = []
        for attempt in attempts:
            if attempt not in known and attempt > last:  # It is on its way into the file, or was tried after the recording.
                count += 1
                known[attempt] = count
            numbers.append(known.get(attempt))
        return numbers
