"""Makes new standards: of an attempt of a lesson (`kinebox standard record`), or of a file from elsewhere (`import`)."""

import datetime as dt
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import typer

from models.errors import UserError
from models.teaching.showing import PerformanceError, decode_own
from models.teaching.standard import FRAME_S, RATE_HZ, Moments, Standard
from services.cli.attempt_number import attempt_in, ranges, require_attempt, told
from services.cli.lesson_attempts import Attempts, attempts_of
from services.cli.lessons import require_data
from services.cli.progress import ProgressLine
from services.cli.standards import AT_NEXT_START, SHIPPED, own_standards
from services.evaluation.attempt import AROUND_S, FoundAttempt
from services.evaluation.new_standard import require_found, standard_of
from services.evaluation.resampling import resampled
from services.evaluation.search import attempts_in, leading_side, performances_like
from services.evaluation.track import Track
from services.lesson.imports.file import read_motion
from services.lesson.layout import SUFFIX
from services.lesson.lesson_reader import open_lesson
from services.lesson.readable_names import readable
from services.lesson.replay import configuration
from services.lesson.stretches import stretches
from services.logs.printable import printable
from services.site_file.reading import read_file
from services.support.called import called, same_place
from services.support.own_standards import OwnStandards
from services.support.teaching_files import STANDARD_SUFFIX, folder_of_own

LEAST_RATE_HZ: Final = 20.0
"""A hit is over within two frames of this."""
_ANOTHER: Final = "choose another attempt ('kinebox report' shows them all), or have it done once more, in sight of all cameras"


@dataclass(frozen=True)
class Record:
    """What is asked for of a lesson.

    Attributes:
        attempt: of the lesson's attempts, counted from 1 as `kinebox report` does.
        action: of which it is to be the standard; None for the one that was tried.
        again: attempts are those that evaluation finds now, whatever was said on the day.
    """

    attempt: int
    action: str | None = None
    again: bool = False


@dataclass(frozen=True)
class Import:
    """What is asked for of a file.

    Attributes:
        action: of which it is to be the standard.
        attempt: of those in the file, counted from 1; None if there is only one.
        moments_s: start, exertion, peak and end, seconds from the first frame; all None: they are looked for.
        unit: of a BVH file; None for the one that follows from its legs.
    """

    action: str
    attempt: int | None = None
    moments_s: tuple[float | None, float | None, float | None, float | None] = (None, None, None, None)
    unit: str | None = None


@dataclass(frozen=True, eq=False)
class _Performance:
    """What is to be a standard, and in words what it is.

    Attributes:
        track, attempt, origin: see `standard_of`. The origin goes wherever the standard goes, so it holds no name that people gave.
        name: by which an error calls it.
        told: by which people see whether it is the one that they mean.
        remedy: what to do if it can be none.
    """

    track: Track
    attempt: FoundAttempt
    origin: str
    name: str
    told: str
    remedy: str


def record(file: Path, data: Path, site: Path | None, order: Record) -> None:
    """Make an attempt of a lesson the standard, and say so.

    Args:
        file: of the lesson.
        data: the data folder, with the school's own teaching.
        site: the site file to go by; None for the lesson's own.
        order: what is asked for.

    Raises:
        UserError: the lesson cannot be read, there is no such attempt, it is none at that action, too much of it is unknown, or
            the standard cannot be written; all is as it was then.
    """
    require_data(data)
    number = order.attempt
    with open_lesson(file) as lesson, ProgressLine() as progress:
        lesson.require_entries()
        attempts = attempts_of(lesson, data, site, progress, again=order.again)
        numbers = range(1, len(attempts.feedbacks) + 1)
        require_attempt(numbers, number, file, "name a lesson with an attempt in it", attempts.source, again=order.again)
        frame_s, around_s = configuration(lesson.header.preset).frame_s, AROUND_S + FRAME_S
        found = stretches(lesson.parts(), frame_s, attempts.feedbacks, only=number, around_s=around_s)
        header = lesson.header
    stretch, each = attempt_in(found, number, file, "choose another attempt")
    own = OwnStandards(attempts.own or folder_of_own(data, ""))
    attempt, track = each.found, resampled(stretch.track, FRAME_S)
    name = f"attempt {number} of lesson {file}"
    if order.action not in {None, attempt.action}:
        attempt = _tried_as(track, attempt, own.counts(str(order.action)), name)
    when = told(header, each)
    # Short enough for a line of `kinebox standard list`.
    origin = f"attempt {number}, lesson {header.begun:%Y-%m-%d}, {header.wall(each.found.moments_s[0]):%H:%M:%S}"
    whose = f", pupil {each.pupil}" if each.pupil else ""
    shown = f"attempt {number} of lesson {file.name.removesuffix(SUFFIX)} ({when}{whose})"
    performance = _Performance(track, attempt, origin, name, shown, _ANOTHER)
    _keep(own, performance, _options(own, data, site))
    if attempt is each.found:
        _say_what_was_corrected(attempts, number)


def bring_in(file: Path, data: Path, site: Path | None, order: Import) -> None:
    """Make a motion of another program the standard, or let a standard of another school count, and say so.

    Raises:
        UserError: the file cannot be read, its frames are too few a second, no attempt or several are found in it, keyframes are
            given that are not in it, too much of it is unknown, it is a standard of another action, or the standard cannot be
            written; all is as it was then.
    """
    own = own_standards(data, site)
    counting, name, options = own.counts(order.action), readable(str(file)), _options(own, data, site)
    if file.suffix.lower() == STANDARD_SUFFIX:
        _count(own, _of_another_school(file, order), name, options)
        return
    track = read_motion(file, order.unit)
    if track.frame_s * LEAST_RATE_HZ > 1:
        rate = f"{1 / track.frame_s:.3g} frames a second; a standard needs {LEAST_RATE_HZ:g}, and has {RATE_HZ:g}"
        raise UserError(f"{name} has {rate}; export it again with more")
    track = resampled(track, FRAME_S)
    moments_s = _given(order, track, name)
    if moments_s is None:
        attempt = _found(order, track, counting, name)
    else:
        attempt = FoundAttempt(order.action, leading_side(track, moments_s, counting), moments_s)
    kind = file.suffix[1:].upper()
    origin = f"imported from a {kind} file on {dt.datetime.now().astimezone():%Y-%m-%d}"
    _keep(own, _Performance(track, attempt, origin, name, name, "correct the file, or take another performance"), options)


def _of_another_school(file: Path, order: Import) -> Standard:
    """The standard that a file holds."""
    name = readable(str(file))
    if order != Import(order.action):
        raise UserError(f"{name} is a standard, of which nothing is open; leave out all options but --action")
    standard = decode_own(read_file(file, "standard"), name)
    if standard.action != order.action:
        raise UserError(f"{name} is a standard of '{standard.action}'; correct --action")
    try:
        require_found(standard)
    except PerformanceError as error:
        raise UserError(f"{name} {error}; take the file of another one") from error
    return standard


def _options(own: OwnStandards, data: Path, site: Path | None) -> str:
    """By which another command finds the same standards."""
    options = same_place(data, site)
    # What a lesson's own site file names, no other command knows of.
    return options if site is not None or own.folder == own_standards(data, None).folder else f"{options} --site FILE"


def _keep(own: OwnStandards, shown: _Performance, options: str) -> None:
    """Make the standard, keep it, and say so."""
    attempt = shown.attempt
    base = own.shipped(attempt.action) or own.counts(attempt.action)
    try:
        made = standard_of(shown.track, attempt, base, shown.origin)
    except PerformanceError as error:
        raise UserError(f"{shown.name} {error}; {shown.remedy}") from error
    mirrored = "; its left side led, so the standard is its mirror image" if attempt.handed == "left" else ""
    _count(own, made, shown.told, options, mirrored)


def _count(own: OwnStandards, made: Standard, source: str, options: str, mirrored: str = "") -> None:
    """Let a standard count from now on, and say so."""
    counting = own.counts(made.action)
    placed = own.put(made)
    kept, before = placed.standard, SHIPPED if placed.before is None else placed.before
    seconds = kept.moments_s[-1] - kept.moments_s[0]
    lines = (
        f"{kept.action}: version {kept.version} counts now, made of {source}",
        f"it takes {seconds:.1f} s, performed by somebody {kept.stature_m:.2f} m tall{mirrored}",
        f"{own.file(kept.action)}: {AT_NEXT_START}",
        f"bring back what counted before ({counting.origin}): {called()} standard restore {kept.action} {before} {options}",
    )
    for line in lines:
        typer.echo(printable(line))


def _tried_as(track: Track, attempt: FoundAttempt, standard: Standard, what: str) -> FoundAttempt:
    """What was taken for an attempt at another action, as one at this."""
    first, last = (track.frame_at(t_s) for t_s in (attempt.moments_s[0] - AROUND_S, attempt.moments_s[-1] + AROUND_S))
    found = attempts_in(track.part(max(int(first), 0), int(last) + 1), standard)

    def common_s(other: FoundAttempt) -> float:
        ends, starts = (
            (other.moments_s[-1], attempt.moments_s[-1]),
            (other.moments_s[0], attempt.moments_s[0]),
        )
        return min(ends) - max(starts)

    best = max(found, key=common_s, default=None)
    if best is None or common_s(best) <= 0:
        raise UserError(
            f"{what} is one at {attempt.action}, and none at {standard.action} is found in it; leave out --action, or take another"
        )
    return best


def _given(order: Import, track: Track, what: str) -> Moments | None:
    """Keyframes that were given; None if none were."""
    start, exertion, peak, end = order.moments_s
    if order.moments_s == (None, None, None, None):
        return None
    if start is None or exertion is None or peak is None or end is None or order.attempt is not None:
        raise UserError("keyframes are given with all of --start, --exertion, --peak and --end, and without --attempt")
    last_s = float(track.t_s[-1])
    if not 0 <= start < exertion < peak < end <= last_s:
        raise UserError(
            f"--start, --exertion, --peak and --end follow one another within the 0 to {last_s:.2f} s of {what}; correct them"
        )
    return start, exertion, peak, end


def _found(order: Import, track: Track, standard: Standard, what: str) -> FoundAttempt:
    """The attempt in a file: as the box finds attempts, or, if there is none, whatever is most like the standard until its peak."""
    found = attempts_in(track, standard) or performances_like(track, standard)
    if not found:
        raise UserError(
            f"no {order.action} is found in {what}; correct --action, or give its keyframes: --start, --exertion, --peak and --end"
        )
    if order.attempt is None and len(found) > 1:
        when = ", ".join(f"{each.moments_s[0]:.1f} to {each.moments_s[-1]:.1f} s" for each in found)
        raise UserError(f"{what} holds {len(found)} attempts ({when}); choose one with --attempt")
    number = order.attempt or 1
    if number > len(found):
        raise UserError(f"{what} has no attempt {number}; it has {ranges(range(1, len(found) + 1))}")
    return found[number - 1]


def _say_what_was_corrected(attempts: Attempts, number: int) -> None:
    """If something was: then it is hardly the attempt that was meant."""
    feedback = attempts.feedbacks[number - 1]
    teaching = attempts.teachings.get(feedback.action)
    faults = [] if teaching is None else [fault for fault in teaching.fault if fault.name == feedback.cue]
    for fault in faults:
        typer.echo(printable(f"note: of this attempt was said: {fault.cue.of(attempts.taught.language)}"), err=True)
