"""Attempts, keyframes and cues as the box finds them, beside what is true: `make bench-keyframes`, the paper's Figure 9.

Lessons are of test pupils: rendered, through networks and fusion as the box runs them; on true motion at 30 Hz; on the twin; and
half an hour of walking, waiting and all else that pupils do between attempts, on the twin. Beside what is found with the standards
stands what equation 17 finds alone: the maxima of the motion's energy.
"""

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from edge.simulation.lesson.plan import PLAN_VERSION, Plan, PupilPlan
from edge.simulation.lesson.stage import member_of
from edge.simulation.split import SPLITS, Split, generator
from models.errors import UserError
from models.motions.actions.library import ACTIONS
from models.motions.between import Between, idle_time, spend
from models.motions.motion import Motion
from models.motions.sequence import Sequence as Acts
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject
from services.evaluation.alignment import warp
from services.evaluation.attempt import PHASES
from services.evaluation.attempts import AttemptFinder
from services.evaluation.track import Track, known_track
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.bench.table import Cell, ResultTable
from tests.bench.teaching import cues
from tests.bench.teaching.filmed import films
from tests.bench.teaching.finding import (
    SETTLED_S,
    SIX,
    Found,
    attempt_f1,
    delays_s,
    energy_f1,
    find,
    keyframe_f1,
    moments_s,
    shipped,
)
from tests.bench.teaching.lessons import lesson_of_all
from tests.bench.teaching.twin_beside import attempt_figures, gaps_pct, twins_of_films
from tests.bench.teaching.twin_beside import table as beside
from tests.bench.teaching.twinned import TRACK_HZ, Truth, smooth_of, truth_of

WHERE: Final = ("true", "twin", "rendered", "idle")
IDLE_S: Final = 1800.0
_PIECE_S: Final = 360.0
"""Each pupil idles for so long."""
_AFTER_S: Final = 1.5
"""The pupil stands for so long after his last attempt."""
_AREA_M: Final = (2.2, 1.6)
_FALSE: Final = "false_attempts_per_5min.twin"
BARS: Final = {
    "keyframe_f1.rendered": (">=", 0.93),
    "attempt_f1.rendered": (">=", 0.97),
    "keyframe_f1.true_motion": (">=", 0.98),
    "keyframe_f1.twin": (">=", 0.93),
    "attempt_f1.true_motion": (">=", 0.97),
    "attempt_f1.twin": (">=", 0.97),
    _FALSE: ("<=", 0.0),
    "cue_accuracy_pct.rendered": (">=", 85.0),
    "cue_accuracy_pct.twin": (">=", 85.0),
    "false_cue_pct.rendered": ("<=", 5.0),
    "false_cue_pct.twin": ("<=", 5.0),
    "decision_delay_s.rendered.p95": ("<=", SETTLED_S),
    "decision_delay_s.twin.p95": ("<=", SETTLED_S),
    "evaluation_ms": ("<=", 1.0),
    "dtw_ms": ("<=", 1.5),
}


@dataclass(frozen=True, eq=False)
class Lesson:
    """A pupil's lesson as the box has it, and what was found in it."""

    seed: int
    track: Track
    found: Found


def on_rendered(split: Split, seeds: Sequence[int], data: Path) -> Iterator[Lesson]:
    """Lessons as four cameras see them; a part of what is performed on true motion."""
    for plan, track, attempts in films(split, seeds, data):
        yield Lesson(plan.seed, track, find(track, attempts))


def on_true_motion(split: Split, seeds: Sequence[int]) -> Iterator[Lesson]:
    """Whole lessons as they are truly performed."""
    for seed in seeds:
        truth = truth_of(lesson_of_all(split, seed))
        t_s = np.arange(int((truth.motion.duration_s + _AFTER_S) * TRACK_HZ)) / TRACK_HZ
        track = known_track(truth.joints_m(t_s), 1 / TRACK_HZ)
        yield Lesson(seed, track, find(track, truth.motion.attempts))


def on_twin(split: Split, seeds: Sequence[int], data: Path) -> Iterator[Lesson]:
    """The same lessons through the twin and fusion."""
    for seed in seeds:
        plan = lesson_of_all(split, seed)
        truth = truth_of(plan)
        track = smooth_of(plan, truth, data)
        yield Lesson(seed, track, find(track, truth.motion.attempts))


def idle_on_twin(split: Split, seeds: Sequence[int], data: Path, seconds: float = IDLE_S) -> Iterator[Lesson]:
    """Pupils who do anything but an action, through the twin and fusion."""
    for number in range(int(np.ceil(seconds / _PIECE_S))):
        plan, truth = idling(split, seeds[number % len(seeds)], number)
        track = smooth_of(plan, truth, data)
        yield Lesson(plan.seed, track, find(track, ()))


def idling(split: Split, seed: int, number: int) -> tuple[Plan, Truth]:
    """Somebody who walks and jogs about, waits, stretches, bends, scratches and claps; he differs from number to number."""
    random = generator(split, f"teaching idle {number}", seed)
    years = float(np.round(random.uniform(7.0, 16.0), 1))
    plan = Plan(
        version=PLAN_VERSION,
        name=f"teaching-idle-{number}",
        seed=seed,
        split=split,
        pupils=[PupilPlan(name="pupil", age_years=years, performs=[])],
    )
    subject = member_of(plan, 0).subject

    def somewhere(draw: np.random.Generator) -> Standpoint:
        x_m, y_m = (float(draw.uniform(-half, half)) for half in _AREA_M)
        return Standpoint(x_m, y_m, float(draw.uniform(-np.pi, np.pi)))

    acts = [partial(_spent, what, subject) for what in idle_time(_PIECE_S, somewhere, int(random.integers(2**31)))]
    return plan, Truth(subject, Acts(acts).motion())


def _spent(what: Between, subject: Subject, at: Standpoint) -> Motion:
    return spend(what, subject, at)


def figures(lessons: Sequence[Found], where: str) -> dict[str, float]:
    """What the lessons come to, under the names of the figures; `where` is "true_motion", "twin" or "rendered"."""
    out = {f"keyframe_f1.{where}.{action}": keyframe_f1(lessons, action) for action in SIX}
    out[f"keyframe_f1.{where}"] = float(np.mean([keyframe_f1(lessons, action) for action in SIX]))
    out[f"keyframe_f1.{where}.energy_alone"] = float(np.mean([energy_f1(lessons, action) for action in SIX]))
    out[f"attempt_f1.{where}"] = attempt_f1(lessons)
    delays = delays_s(lessons)
    if delays:
        out[f"decision_delay_s.{where}.p95"] = float(np.percentile(delays, 95))
    return out


def table(lessons: Sequence[Found], where: str) -> ResultTable:
    """By action: attempts, keyframes, energy alone, and how far keyframes are off."""
    rows: list[tuple[Cell, ...]] = []
    for action in ACTIONS:
        phases = [keyframe_f1(lessons, action, number) for number in range(len(PHASES))]
        apart = np.array(
            [
                np.array(found.attempt.moments_s) - moments_s(true)
                for one in lessons
                for true, found in one.pairs
                if true.action == action
            ]
        )
        rows.append(
            (
                action,
                float(sum(true.action == action for one in lessons for true in one.true)),
                attempt_f1(lessons, action),
                keyframe_f1(lessons, action),
                *phases,
                1000 * float(np.median(np.abs(apart))) if len(apart) else None,
                energy_f1(lessons, action),
            )
        )
    columns = ("action", "n", "attempts F1", "keyframes F1", *PHASES, "median error, ms", "equation 17 alone")
    return ResultTable(f"{where}: keyframes within 3 frames of 30 a second", columns, tuple(rows))


def speed() -> dict[str, float]:
    """CPU ms of one thread: a frame of the finder, and an alignment of 300 with 300 frames of 17 joints."""
    motion = np.concatenate([standard.joints_m for standard in shipped()])[:300]
    finder = AttemptFinder(shipped())
    aligned, pushed = [], []
    for number, joints in enumerate(motion):
        began = time.thread_time()
        finder.push(joints, number / TRACK_HZ)
        pushed.append(time.thread_time() - began)
    for _ in range(50):
        began = time.thread_time()
        warp(motion, motion[::-1])
        aligned.append(time.thread_time() - began)
    return {"evaluation_ms": 1000 * float(np.mean(pushed[10:])), "dtw_ms": 1000 * float(np.median(aligned[5:]))}


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--split", choices=SPLITS, default="test", help="development, to tune")
    parser.add_argument("--seeds", type=int, default=COUNT, help="pupils")
    parser.add_argument("--on", choices=WHERE, action="append", help="only this; all if left out")
    options = parser.parse_args()
    seeds, split = seeds_of(options.split, options.seeds), options.split
    report = Report("bench-keyframes", seeds)
    report.add(speed())
    on = options.on or WHERE
    try:
        if "true" in on:
            _add(report, split, "true_motion", on_true_motion(split, seeds))
        if "twin" in on:
            _add(report, split, "twin", on_twin(split, seeds, options.data))
        if "rendered" in on:
            rendered = _add(report, split, "rendered", on_rendered(split, seeds, options.data))
            twin = attempt_figures(*_heard(split, (Lesson(*one) for one in twins_of_films(split, seeds, options.data))))
            report.add({f"twin_gap_pct.{name}": gap for name, gap in gaps_pct(rendered, twin).items()})
            report.tables.append(beside(rendered, twin))
        if "idle" in on:
            idle = [one.found for one in idle_on_twin(split, seeds, options.data)]
            minutes = sum(one.seconds for one in idle) / 60
            report.add({"idle_minutes.twin": minutes, _FALSE: 5 * sum(len(one.false) for one in idle) / minutes})
    except UserError as error:
        sys.stderr.write(f"bench-keyframes: {error}\n")
        return 2
    return report.conclude(_bars(on), options.data)


def _bars(on: Sequence[str]) -> dict[str, tuple[str, float]]:
    """Those of what is measured."""
    return {name: bar for name, bar in BARS.items() if _where(name) in (None, *on)}


def _where(figure: str) -> str | None:
    """What it is measured on; None if the same is measured in any case."""
    if figure == _FALSE:
        return "idle"
    words = {"true_motion": "true", "twin": "twin", "rendered": "rendered"}
    return next((where for word, where in words.items() if word in figure.split(".")), None)


def _add(report: Report, split: Split, where: str, lessons: Iterator[Lesson]) -> dict[str, float]:
    """Take what the lessons come to into the report; returns what the twin is compared by."""
    all_found, said = _heard(split, lessons)
    report.add(figures(all_found, where) | {f"{name}.{where}": value for name, value in cues.figures(said).items()})
    report.tables += [table(all_found, where), *cues.confusion(said)]
    return attempt_figures(all_found, said)


def _heard(split: Split, lessons: Iterator[Lesson]) -> tuple[list[Found], list[cues.Result]]:
    """What was found, and what is said of it."""
    all_found, said = [], []
    for one in lessons:
        all_found.append(one.found)
        said += cues.of_found(split, one.seed, one.track, one.found)
    return all_found, said


if __name__ == "__main__":
    sys.exit(main())
