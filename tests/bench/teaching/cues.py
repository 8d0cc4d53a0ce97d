"""Whether what is said is right: named faults, false cues, which fault is taken for which, and the response against severity.

`python -m tests.bench.teaching.cues` takes the true keyframes: on true motion with errors as fusion has them, and on the twin
(`--on twin`). `make bench-keyframes` prints the same figures of attempts as the box finds them, keyframes and all.
"""

import argparse
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Final

import numpy as np

import models.teaching
from edge.simulation.split import SPLITS, Split, generator
from models.errors import UserError
from models.messages.feedback import Judgement
from models.motions.actions.library import ACTIONS
from models.teaching.schema import Teaching, Vocabulary, decode_teaching
from services.evaluation.appraisal import measures_of
from services.evaluation.attempt import FoundAttempt
from services.evaluation.cues import Said, choose
from services.evaluation.faults import judge
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.bench.table import Cell, ResultTable
from tests.bench.teaching.cases import Case, double, single, well
from tests.bench.teaching.finding import Found
from tests.bench.teaching.lessons import lesson_of_all
from tests.bench.teaching.noise import as_fused
from tests.bench.teaching.performed import RATE_HZ, Performed, kept
from tests.bench.teaching.twinned import around, attempt_of, smooth_of, truth_of

SEVERITIES: Final = (0.25, 0.5, 0.75, 1.0)
_MOMENT_S: Final = 0.02
"""Keyframes of true motion are so wrong, one standard deviation: less than a frame, as found ones are at best."""
BARS: Final = {"cue_accuracy_pct": (">=", 85.0), "false_cue_pct": ("<=", 5.0)}


@dataclass(frozen=True)
class Result:
    """What was said of one case."""

    case: Case
    said: Said
    judgements: tuple[Judgement, ...]


@cache
def taught(action: str) -> Teaching:
    """The file that ships."""
    name = f"{action}.toml"
    return decode_teaching((files(models.teaching) / "actions" / name).read_bytes(), name, Vocabulary(CATALOGUE, FUNCTIONS))


def result(case: Case, track: Track, attempt: FoundAttempt) -> Result:
    """Judge an attempt as the box does."""
    teaching = taught(case.action)
    reading = Reading(track, attempt.handed)
    judgements = judge(teaching, reading, attempt)
    return Result(case, choose(teaching, judgements, measures_of(teaching, reading, attempt)), judgements)


def cases_of(split: Split, seed: int) -> list[Case]:
    """Everything that a pupil tries at full severity."""
    return [*well(split, seed), *single(split, seed), *double(split, seed)]


def on_true_motion(split: Split, seeds: Sequence[int], data: Path, slight: bool = True) -> list[Result]:
    """True motion with errors as fusion has them; with slighter faults, too, if asked."""
    results = []
    for seed in seeds:
        slighter = [case for severity in SEVERITIES[:-1] for case in single(split, seed, severity)] if slight else []
        for name, cases in (("", cases_of(split, seed)), ("-slight", slighter)):
            done = kept(cases, data / "teaching" / f"performed-{split}-{seed}{name}.npz") if cases else []
            results += [_seen(one) for one in done]
    return results


def _seen(one: Performed) -> Result:
    random = generator(one.case.split, f"teaching noise {one.case.action} {one.case.faults} {one.case.number}", one.case.seed)
    track = as_fused(one.joints_m, 1 / RATE_HZ, random)
    start, exertion, peak, end = np.array(one.attempt.moments_s) + random.normal(0, _MOMENT_S, 4)
    return result(one.case, track, FoundAttempt(one.case.action, one.attempt.handed, (start, exertion, peak, end)))


def on_twin(split: Split, seeds: Sequence[int], data: Path) -> list[Result]:
    """Whole lessons through the twin and fusion."""
    results = []
    for seed in seeds:
        plan = lesson_of_all(split, seed)
        truth = truth_of(plan)
        track = smooth_of(plan, truth, data)
        for true in truth.motion.attempts:
            attempt = attempt_of(true)
            case = Case(split, seed, true.action, dict(true.faults))
            results.append(result(case, around(track, attempt), attempt))
    return results


def of_found(split: Split, seed: int, track: Track, found: Found) -> list[Result]:
    """What the box says of each true attempt as it found it; of one that it did not find it says nothing."""
    results = []
    for true in found.true:
        case = Case(split, seed, true.action, dict(true.faults))
        own = next((decided.attempt for pair, decided in found.pairs if pair is true), None)
        results.append(Result(case, Said(), ()) if own is None else result(case, around(track, own), own))
    return results


def figures(results: Iterable[Result]) -> dict[str, float]:
    """Percent, over cases at full severity; NaN where there are none.

    Returns:
        `cue_accuracy_pct`: of attempts with one fault, whose fault is named. `false_cue_pct`: of attempts without a fault, that are
        corrected. `cue_double_pct`: of attempts with two, where one of them is named. `praised_pct` and `fine_pct`: of attempts
        without a fault, where something is praised, and that are told that nothing was wrong. `false_fine_pct`: of attempts with
        faults, that are told the same.
    """
    full = [one for one in results if set(one.case.faults.values()) <= {1.0}]
    faultless, alone, two = ([one for one in full if len(one.case.faults) == count] for count in (0, 1, 2))
    return {
        "cue_accuracy_pct": _percent(one.said.cue in one.case.faults for one in alone),
        "false_cue_pct": _percent(bool(one.said.cue) for one in faultless),
        "cue_double_pct": _percent(one.said.cue in one.case.faults for one in two),
        "wrong_cue_pct": _percent(bool(one.said.cue) and one.said.cue not in one.case.faults for one in alone),
        "praised_pct": _percent(bool(one.said.praise) for one in faultless),
        "fine_pct": _percent(one.said.fine for one in faultless),
        "false_fine_pct": _percent(one.said.fine for one in (*alone, *two)),
    }


def confusion(results: Iterable[Result]) -> list[ResultTable]:
    """One table an action: what was performed, and how often what was said, percent; the last column is silence."""
    full = [one for one in results if set(one.case.faults.values()) <= {1.0} and len(one.case.faults) < 2]
    tables = []
    for action in dict.fromkeys(one.case.action for one in full):
        names = [fault.name for fault in ACTIONS[action].faults]
        rows = []
        for performed in ("", *names):
            said = [one.said.cue for one in full if one.case.action == action and "".join(one.case.faults) == performed]
            cells: list[Cell] = [100 * said.count(name) / len(said) if said else None for name in (*names, "")]
            rows.append((performed or "faultless", len(said), *cells))
        tables.append(ResultTable(f"{action}: performed, and what was said, %", ("performed", "n", *names, "silence"), tuple(rows)))
    return tables


def response(results: Iterable[Result]) -> ResultTable:
    """How judged severity and cues grow with the severity that was performed: 0.5 is where cues begin."""
    one_fault = [one for one in results if len(one.case.faults) == 1]
    rows = []
    for severity in sorted({next(iter(one.case.faults.values())) for one in one_fault}):
        some = [one for one in one_fault if severity in one.case.faults.values()]
        judged = [_own(one) for one in some if one.judgements]
        known = np.array([one.severity for one in judged if one.severity is not None and one.sigma is not None])
        named = _percent(one.said.cue in one.case.faults for one in some)
        wrong = _percent(bool(one.said.cue) and one.said.cue not in one.case.faults for one in some)
        cells = (float(np.median(known)), float(known.std()), 100 * (1 - len(known) / len(some)), named, wrong)
        rows.append((f"{severity:g}", len(some), *cells))
    columns = ("performed severity", "n", "judged, median", "its deviation", "not judged, %", "named, %", "another named, %")
    return ResultTable("Response against severity, all faults", columns, tuple(rows))


def _own(one: Result) -> Judgement:
    """Of the fault that was performed."""
    return next(judgement for judgement in one.judgements if judgement.fault in one.case.faults)


def _percent(hits: Iterable[bool]) -> float:
    values = list(hits)
    return 100 * float(np.mean(values)) if values else float("nan")


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=Path("build"))
    parser.add_argument("--split", choices=SPLITS, default="development", help="test only to measure, never to tune")
    parser.add_argument("--seeds", type=int, default=COUNT, help="pupils")
    parser.add_argument("--on", choices=("true", "twin"), default="true")
    options = parser.parse_args()
    seeds = seeds_of(options.split, options.seeds)
    try:
        results = (on_true_motion if options.on == "true" else on_twin)(options.split, seeds, options.data)
    except UserError as error:
        sys.stderr.write(f"cues: {error}\n")
        return 2
    report = Report(f"cues-{options.on}-{options.split}", seeds)
    report.add(figures(results))
    report.tables += [*confusion(results), response(results)]
    return report.conclude(BARS, options.data)


if __name__ == "__main__":
    sys.exit(main())
