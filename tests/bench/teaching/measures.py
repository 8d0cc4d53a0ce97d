"""How well an attempt is measured: values against the truth, and whether their sigmas are honest.

    python -m tests.bench.teaching.measures --data build             test pupils through the twin and fusion
    ... --on rendered                                                as four cameras see them; rendered the first time, for hours
    ... --split development                                          those that may be looked at

Keyframes are the true ones here, so that an error is one of measuring; `tempo_frames` needs found ones and is `bench-keyframes`'.
The truth of a signal is the same formula on the body's true points; of jumps it is what bears and how the whole body's centre of
mass moves. Rolls and cartwheels are told apart: the twin is too kind to who is upside down, and jumps are none of theirs.
"""

import argparse
import math
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from msgspec import UNSET

from edge.simulation.lesson.plan import Plan
from edge.simulation.split import Split
from models.errors import UserError
from models.motions.motion import Attempt
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.measures.reduce import evaluate, name_of
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT, NETWORK
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.bench.table import Cell, ResultTable
from tests.bench.teaching.cases import Case, single, well
from tests.bench.teaching.cues import taught
from tests.bench.teaching.filmed import films
from tests.bench.teaching.force_plate import drop_jump, names
from tests.bench.teaching.lessons import lesson_of
from tests.bench.teaching.twinned import Truth, around, attempt_of, smooth_of, truth_of

TUMBLES: Final = ("forward_roll", "cartwheel")
ANGLES: Final = {
    "knee": "knee_flexion",
    "elbow": "elbow_flexion",
    "hip": "hip_flexion",
    "trunk": "trunk_inclination",
    "shoulder": "shoulder_elevation",
}
_TAKES: Final = ("max", "min", "mean", "range", "change")
_FORCE_PLATE: Final = "jump_height_cm.force_plate"
_BARS: Final = {
    **{f"angle_error_deg.{joint}": ("<=", 6.0) for joint in ("knee", "elbow", "hip", "trunk")},
    "jump_height_cm.sim": ("<=", 2.5),
    "jump_distance_cm": ("<=", 5.0),
    _FORCE_PLATE: ("<=", 1.2),
    "within_sigma_pct.signals": (">=", 58.0),
    "within_sigma_pct.measures": (">=", 58.0),
}
_OF_JUMPS: Final = ("jump_height", "jump_height_by_time", "flight_time", "peak_after_top", "jump_distance")
"""Functions whose truth is what bears, not the same function of true points."""
_JUMPS: Final = ("long_jump", "volleyball_spike", "star_jump")


@dataclass(frozen=True)
class Compared:
    """One value beside the true one.

    Attributes:
        action: that was attempted.
        kind: "frame" for a signal in a frame, "shown" for what the page shows, else how it was taken.
        name: of the signal or function.
        error: measured less true, in the signal's unit; NaN if it was not known.
        sigma: that was stated.
    """

    action: str
    kind: str
    name: str
    error: float
    sigma: float


def cases_of(split: Split, seed: int) -> list[Case]:
    """What a pupil performs: all actions well, and a fifth of the faults."""
    return [*well(split, seed), *(case for number, case in enumerate(single(split, seed)) if number % 5 == seed % 5)]


def plan_of(split: Split, seed: int) -> Plan:
    """The lesson of a pupil."""
    return lesson_of("measures", split, seed, cases_of(split, seed))


def on_twin(split: Split, seeds: Sequence[int], data: Path) -> Iterator[tuple[Plan, Truth, Track]]:
    """Lessons through the twin and fusion."""
    for seed in seeds:
        plan = plan_of(split, seed)
        truth = truth_of(plan)
        yield plan, truth, smooth_of(plan, truth, data)


def on_rendered(split: Split, seeds: Sequence[int], data: Path) -> Iterator[tuple[Plan, Truth, Track]]:
    """Lessons through pictures, networks and fusion."""
    for plan, track, _ in films(split, seeds, data):
        yield plan, truth_of(plan), track


def compare(truth: Truth, smooth: Track) -> Iterator[Compared]:
    """Every signal in every frame of every attempt, every signal taken in every way, every function."""
    model = replace(NETWORK, moment_s=0.0)
    told = Stature(truth.stature_m, 0.0)
    for true in truth.motion.attempts:
        attempt = attempt_of(true)
        track = around(smooth, attempt)
        if len(track) < 2:
            continue
        joints_m = truth.joints_m(track.t_s)
        exact = known_track(joints_m, track.frame_s)
        exact = replace(exact, t_s=track.t_s)
        found = Reading(track, true.handed, model)
        right = Reading(exact, true.handed, EXACT, told)
        yield from _frames(found, right, attempt)
        yield from _taken(found, right, attempt)
        yield from _shown(found, right, attempt)
        yield from _jumped(truth, true, found, attempt)
        yield Compared(attempt.action, "stature", "stature", found.stature.metres - truth.stature_m, found.stature.sigma_m)


def _frames(found: Reading, right: Reading, attempt: FoundAttempt) -> Iterator[Compared]:
    for signal in CATALOGUE.values():
        ours, theirs = (reading.of(signal, "lead") for reading in (found, right))
        inside = (ours.t_s >= attempt.moments_s[0]) & (ours.t_s <= attempt.moments_s[-1]) & ours.seen & theirs.seen
        apart = ours.value - theirs.value
        if signal.turns:
            apart = (apart + 180) % 360 - 180
        for error, sigma in zip(apart[inside], ours.sigma[inside], strict=True):
            yield Compared(attempt.action, "frame", signal.name, float(error), float(sigma))


def _taken(found: Reading, right: Reading, attempt: FoundAttempt) -> Iterator[Compared]:
    measures = [Measure(signal=name, side="lead", over=("start", "end"), take=take) for name in CATALOGUE for take in _TAKES]
    measures += [Measure(signal=name, side="lead", at="peak") for name in CATALOGUE]
    measures += [Measure(function=name) for name in FUNCTIONS if name not in _OF_JUMPS]
    for measure in measures:
        ours, theirs = (evaluate(measure, reading, attempt) for reading in (found, right))
        if ours.known and theirs.known and ours.sigma > 0:
            kind = "function" if measure.signal is UNSET else measure.take
            yield Compared(attempt.action, kind, name_of(measure).split()[0], ours.value - theirs.value, ours.sigma)


def _shown(found: Reading, right: Reading, attempt: FoundAttempt) -> Iterator[Compared]:
    """What the page shows of the action; NaN where it would be grey."""
    for shown in taught(attempt.action).shown:
        ours, theirs = (evaluate(shown, reading, attempt) for reading in (found, right))
        if theirs.known and not (ours.known and ours.sigma == 0):
            error, sigma = (ours.value - theirs.value, ours.sigma) if ours.known else (math.nan, math.nan)
            yield Compared(attempt.action, "shown", f"{attempt.action} {shown.name}", error, sigma)


def _jumped(truth: Truth, true: Attempt, found: Reading, attempt: FoundAttempt) -> Iterator[Compared]:
    if true.action not in _JUMPS:
        return
    jump = truth.jump(true)
    if jump is None:
        return
    values = {
        "jump_height": 100 * jump.rise_m,
        "flight_time": jump.on_s - jump.off_s,
        "peak_after_top": true.peak_s - jump.top_s,
        **({"jump_distance": 100 * jump.reach_m} if true.action == "long_jump" else {}),
    }
    for name, value in values.items():
        ours = evaluate(Measure(function=name), found, attempt)
        if ours.known:
            yield Compared(true.action, "jump", name, ours.value - value, ours.sigma)
        else:
            print(f"{true.action}: {name} is not known: {ours.why}")


def within_pct(compared: Sequence[Compared]) -> float:
    """Share of errors that are within their sigma."""
    return 100 * float(np.mean([abs(one.error) <= one.sigma for one in compared])) if compared else math.nan


def median_error(compared: Sequence[Compared]) -> float:
    """Median absolute error."""
    return float(np.median([abs(one.error) for one in compared])) if compared else math.nan


def figures(compared: Sequence[Compared]) -> dict[str, float]:
    """By the names of the bench."""
    upright = [one for one in compared if one.action not in TUMBLES]
    frames = [one for one in upright if one.kind == "frame"]
    out = {f"angle_error_deg.{joint}": median_error([one for one in frames if one.name == name]) for joint, name in ANGLES.items()}
    jumps = [one for one in compared if one.kind == "jump"]
    for figure, name in (
        ("jump_height_cm.sim", "jump_height"),
        ("jump_distance_cm", "jump_distance"),
        ("flight_time_s", "flight_time"),
    ):
        out[figure] = median_error([one for one in jumps if one.name == name])
    out["stature_pct"] = 100 * median_error([one for one in compared if one.kind == "stature"])
    out["within_sigma_pct.signals"] = _mean_within(frames)
    others = {"frame", "shown", "stature", "jump"}
    out["within_sigma_pct.measures"] = _mean_within([one for one in upright if one.kind not in others])
    out["within_sigma_pct.shown"] = within_pct(_known([one for one in compared if one.kind == "shown"]))
    out["within_sigma_pct.jumps"] = within_pct(jumps)
    return out


def _mean_within(compared: Sequence[Compared]) -> float:
    """Every signal or function counts alike, however many values it has."""
    by_name = _grouped(compared, lambda one: one.name)
    return float(np.mean([within_pct(group) for group in by_name.values()])) if by_name else math.nan


def _grouped(compared: Sequence[Compared], key: Callable[[Compared], str]) -> dict[str, list[Compared]]:
    groups = defaultdict(list)
    for one in compared:
        groups[key(one)].append(one)
    return groups


def tables(compared: Sequence[Compared]) -> list[ResultTable]:
    """Median error and share within sigma of each signal and function, and of each way to take a number."""
    upright = [one for one in compared if one.action not in TUMBLES]
    signals = _grouped([one for one in upright if one.kind == "frame"], lambda one: one.name)
    ways = _grouped([one for one in upright if one.kind != "shown"], lambda one: one.kind)
    shown = _grouped([one for one in compared if one.kind == "shown"], lambda one: one.name)
    columns = ("values", "median error", "median sigma", "within sigma %")
    out = [
        _table("signals, every frame of upright actions", ("signal", *columns), signals),
        _table("ways to take a number", ("way", *columns), ways),
        _table(
            "functions",
            ("function", *columns),
            _grouped([one for one in upright if one.kind in {"function", "jump", "stature"}], lambda one: one.name),
        ),
    ]
    tumbles = _grouped([one for one in compared if one.action in TUMBLES and one.kind == "frame"], lambda one: one.name)
    return [*out, _shown_table(shown), _table("signals, rolls and cartwheels", ("signal", *columns), tumbles)]


def _shown_table(groups: dict[str, list[Compared]]) -> ResultTable:
    """With how often each is known, and how far it is off to one side."""
    rows: list[tuple[Cell, ...]] = []
    for name, group in groups.items():
        known = _known(group)
        share, bias = 100 * len(known) / len(group), float(np.median([one.error for one in known])) if known else None
        sigma = float(np.median([one.sigma for one in known])) if known else None
        rows.append((name, float(len(group)), share, bias, median_error(known), sigma, within_pct(known)))
    columns = ("measure", "attempts", "known %", "bias", "median error", "median sigma", "within sigma %")
    return ResultTable("what the page shows", columns, tuple(rows))


def _known(compared: Sequence[Compared]) -> list[Compared]:
    return [one for one in compared if math.isfinite(one.error)]


def _table(title: str, columns: tuple[str, ...], groups: dict[str, list[Compared]]) -> ResultTable:
    rows = [
        (name, float(len(group)), median_error(group), float(np.median([one.sigma for one in group])), within_pct(group))
        for name, group in groups.items()
    ]
    return ResultTable(title, columns, tuple(rows))


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--shared", type=Path, help="folder of the measurement data, for the drop jumps over a force plate")
    parser.add_argument("--split", choices=("development", "test"), default="test")
    parser.add_argument("--seeds", type=int, default=COUNT, help="pupils")
    parser.add_argument("--on", choices=("twin", "rendered"), default="twin")
    options = parser.parse_args()
    try:
        seeds = seeds_of(options.split, options.seeds)
        suffix = "".join(f".{word}" for word in (options.on, options.split) if word not in {"twin", "test"})
        report = Report(f"measures{suffix}", seeds)
        compared, by_seed = [], []
        for plan, truth, track in (on_twin if options.on == "twin" else on_rendered)(options.split, seeds, options.data):
            now = list(compare(truth, track))
            compared += now
            by_seed.append(figures(now))
            print(f"pupil {plan.seed}: {len(now)} values")
    except UserError as error:
        sys.stderr.write(f"measures: {error}\n")
        return 2
    report.add_seeds(by_seed)
    report.tables += tables(compared)
    if options.shared is not None and names(options.shared):
        jumps = [drop_jump(options.shared, name) for name in names(options.shared)]
        report.add({_FORCE_PLATE: float(np.mean([abs(jump.error_cm) for jump in jumps]))})
        rows = tuple((jump.name, jump.ours.value, jump.ours.sigma, jump.plate_cm, jump.error_cm) for jump in jumps)
        report.tables.append(ResultTable("drop jumps, cm", ("recording", "ours", "sigma", "force plate", "error"), rows))
        held = _BARS
    else:
        print("drop jumps: the measurement data is not there; no figure of the force plate")
        held = {name: bar for name, bar in _BARS.items() if name != _FORCE_PLATE}
    return report.conclude(held, options.data)


if __name__ == "__main__":
    sys.exit(main())
