"""The attempts of a recorded lesson: those that were told on the day, or what evaluation makes of its motion now."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import typer

from models.config.site import EvaluationConfig as Taught
from models.config.site import decode_site
from models.errors import UserError
from models.messages.feedback import ANY, Feedback
from models.messages.lesson import Entry
from models.messages.motion import Motion
from models.teaching.schema import Teaching
from services.cli.duration import clock
from services.cli.progress import ProgressLine
from services.evaluation.config import VOCABULARY, WHICHEVER, EvaluationConfig
from services.evaluation.pipeline import EvaluationOutput, finish, initial_state, step
from services.evaluation.report.document import Source
from services.lesson.lesson_header import LessonHeader
from services.lesson.lesson_reader import Lesson
from services.lesson.pupils import attempts_told, turns_of
from services.lesson.replay import decode
from services.logs.printable import printable
from services.site_file.migration import migrated_text
from services.site_file.reading import read_site
from services.support.teaching_files import load_standards, load_teachings, own_folder


@dataclass(frozen=True, eq=False)
class Attempts:
    """What was tried in a lesson.

    Attributes:
        feedbacks: in their order.
        source: "recorded" if they were told on the day.
        taught: what the site says about teaching.
        teachings: by action.
        own: the school's own folder, if there is one here.
    """

    feedbacks: tuple[Feedback, ...]
    source: Source
    taught: Taught
    teachings: dict[str, Teaching]
    own: Path | None


def attempts_of(lesson: Lesson, data: Path, site: Path | None, progress: ProgressLine, *, again: bool = False) -> Attempts:
    """The recorded attempts of a lesson; if there are none, or `again`, its motion is evaluated.

    Args:
        lesson: open.
        data: the data folder, with the school's own teaching.
        site: the site file to go by; None for the lesson's own.
        progress: shows how far evaluation is.
        again: whatever was said on the day.

    Raises:
        UserError: the lesson, the site file or the teaching files cannot be read, or there is no motion to evaluate.
    """
    taught = _taught(lesson.header, site)
    own = _own(data, taught, strict=site is not None)
    teachings = load_teachings(own, VOCABULARY)
    recorded = () if again else recorded_feedbacks(lesson)
    if recorded:
        return Attempts(recorded, "recorded", taught, teachings, own)
    config = EvaluationConfig(teachings, load_standards(own), _activity(taught, teachings))
    return Attempts(_evaluated(lesson, config, progress), "evaluated", taught, teachings, own)


def recorded_feedbacks(lesson: Lesson) -> tuple[Feedback, ...]:
    """What was told on the day, with pupils as corrected since; UserError if it cannot be read."""
    return attempts_told(lesson.parts())


def _evaluated(lesson: Lesson, config: EvaluationConfig, progress: ProgressLine) -> tuple[Feedback, ...]:
    found: list[Feedback] = []
    for output in _outputs(lesson, config, progress):
        if output.failure is not None:
            _note(f"an attempt could not be judged and is left out ({type(output.failure).__name__}: {output.failure})")
        if output.feedback is not None:
            found.append(output.feedback)
    return tuple(found)


def _outputs(lesson: Lesson, config: EvaluationConfig, progress: ProgressLine) -> Iterator[EvaluationOutput]:
    """What the evaluation makes of each motion, and at last of the lesson's end."""
    state = initial_state(config)
    turns = deque(turns_of(lesson.parts()))
    motions = 0
    for entry in _entries(lesson):
        if entry.kind != "motion":
            continue
        motions += 1
        progress.show(f"evaluated {clock(max(entry.t_ns - lesson.header.started_ns, 0) * 1e-9)}")
        while turns and turns[0].t_ns <= entry.t_ns:
            state, _ = step(state, turns.popleft(), config)
        state, output = step(state, decode(entry, Motion), config)
        yield output
    if not motions:
        raise UserError(f"lesson {lesson.path} holds no motion: it ended too early; report a longer one")
    yield finish(state, config)


def _entries(lesson: Lesson) -> Iterator[Entry]:
    return (entry for part in lesson.parts() for entry in part.entries)


def _taught(header: LessonHeader, site: Path | None) -> Taught:
    """What was taught where the lesson was, unless a site file says otherwise; what KineBox brings if neither is readable."""
    if site is not None:
        return read_site(site)[0].evaluation
    try:
        return decode_site(migrated_text(header.site_toml.encode(), "of the lesson").new.encode(), "of the lesson").evaluation
    except UserError as error:
        _note(f"{error}; taken as if it said nothing of teaching")
        return Taught()


def _own(data: Path, taught: Taught, *, strict: bool) -> Path | None:
    try:
        return own_folder(data, taught.teaching)
    except UserError as error:
        if strict:
            raise
        # The lesson may come from another box.
        _note(f"{error}; what KineBox brings counts")
        return None


def _activity(taught: Taught, teachings: dict[str, Teaching]) -> str:
    return taught.activity if taught.activity != WHICHEVER and taught.activity in teachings else ANY


def _note(line: str) -> None:
    typer.echo(printable(f"note: {line}"), err=True)
