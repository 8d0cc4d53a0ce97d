"""An attempt of a lesson by its number, counted from 1 as `kinebox report` does."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from models.errors import UserError
from services.evaluation.report.document import Source
from services.lesson.lesson_header import LessonHeader
from services.lesson.stretches import LessonAttempt, Stretch


def require_attempt(numbers: Sequence[int], number: int, file: Path, without: str, source: Source, *, again: bool) -> None:
    """Raise UserError unless there is an attempt of this number.

    Args:
        numbers: of all attempts of the lesson; those that there are are named.
        number: of the attempt.
        file: of the lesson.
        without: what to do if no attempt was found in it.
        source: of the attempts; those that evaluation finds now may be more or fewer than on the day.
        again: whether they were evaluated because that was asked for, and not because there are none of the day.
    """
    if not numbers:
        raise UserError(f"lesson {file} holds no attempts that were found; {without}")
    if number not in numbers:
        others = " (with --again, those that are found anew count)" if source == "recorded" else ""
        others = " (without --again, those of the day count)" if again else others
        raise UserError(f"lesson {file} has no attempt {number}; it has {ranges(numbers)}{others}")


def attempt_in(found: Sequence[Stretch], number: int, file: Path, remedy: str) -> tuple[Stretch, LessonAttempt]:
    """The attempt of this number, which the lesson has, and the stretch that it is in; UserError if motion is missing of it."""
    for stretch in found:
        for each in stretch.attempts:
            if each.number == number:
                return stretch, each
    raise UserError(f"of attempt {number} of lesson {file} not all motion was recorded; {remedy}")


def told(header: LessonHeader, attempt: LessonAttempt) -> str:
    """What was tried and when, by which people see whether it is the attempt that they mean."""
    return f"{attempt.found.action}, {header.wall(attempt.found.moments_s[0]):%H:%M:%S}"


def ranges(numbers: Sequence[int]) -> str:
    """1-4, 6: whole numbers that rise, at least one."""

    def spans() -> Iterator[str]:
        first = last = numbers[0]
        for number in [*numbers[1:], -1]:
            if number != last + 1:
                yield f"{first}-{last}" if last > first else f"{first}"
                first = number
            last = number

    return ", ".join(spans())
