"""For whoever edits a teaching file: what its evidence is in good and faulty performances, and what else would tell a fault apart.

Development pupils only, on true motion with errors as fusion has them.

    python -m tests.bench.teaching.tune squat                       every line of evidence of the squat
    python -m tests.bench.teaching.tune squat --search heels_up     measures by which heels that leave the floor are known best
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from rich.console import Console

from edge.simulation.split import generator
from models.arrays import Float
from models.motions.actions.library import ACTIONS
from models.teaching.measure import Measure
from models.teaching.schema import Evidence
from services.evaluation.attempt import FoundAttempt
from services.evaluation.faults import severity
from services.evaluation.measures.reduce import evaluate, name_of
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.mass import masses_of
from services.evaluation.signals.posture import BodySide, Posture
from services.evaluation.signals.reading import Reading, rate, rate_of_rate, unwrapped
from services.evaluation.signals.signal import Signal
from services.evaluation.track import Track
from tests.bench.seeds import seeds_of
from tests.bench.table import ResultTable
from tests.bench.teaching.cues import cases_of, taught
from tests.bench.teaching.noise import as_fused
from tests.bench.teaching.performed import RATE_HZ, Performed, kept

_PUPILS: Final = 12
_BEST: Final = 25
_ENOUGH: Final = 1.2
"""Standard deviations from the middle at least, on either side, to be listed."""
_AROUND: Final = ((-0.3, 0.0), (-0.2, 0.0), (-0.2, 0.2), (-0.1, 0.1), (0.0, 0.2), (0.0, 0.4), (0.1, 0.5), (0.2, 0.6))


@dataclass(frozen=True, eq=False)
class Try:
    """An attempt as it would be measured.

    Attributes:
        performed: the case, and how it truly was.
        track: with errors.
    """

    performed: Performed
    track: Track

    @property
    def fault(self) -> str:
        """The one that was performed; empty for none, and for several."""
        return "".join(self.performed.case.faults)

    @property
    def attempt(self) -> FoundAttempt:
        """With its true keyframes."""
        return self.performed.attempt


def tries(action: str, pupils: int, data: Path) -> list[Try]:
    """What development pupils do, without faults and with each alone."""
    found = []
    for seed in seeds_of("development", pupils):
        for one in kept(cases_of("development", seed), data / "teaching" / f"performed-development-{seed}.npz"):
            if one.case.action == action and len(one.case.faults) < 2:
                random = generator("development", f"tuning {one.case.faults} {one.case.number}", seed)
                found.append(Try(one, as_fused(one.joints_m, 1 / RATE_HZ, random)))
    return found


@dataclass(frozen=True)
class Separation:
    """How well a number tells a fault from good performances.

    Attributes:
        good, good_sigma, fault, fault_sigma: medians and standard deviations of both.
        apart: how many standard deviations the nearer one of both is from the middle.
        others: what another fault makes of it: 0 as good, 1 as this fault.
    """

    good: float
    good_sigma: float
    fault: float
    fault_sigma: float
    others: dict[str, float]

    @property
    def apart(self) -> float:
        """Standard deviations from the middle between the medians, of whoever has the larger ones."""
        return abs(self.fault - self.good) / 2 / max(self.good_sigma, self.fault_sigma, 1e-9)


def separation(values: Callable[[Try], float], fault: str, among: Sequence[Try]) -> Separation | None:
    """Of one number; None if it is not known of everybody."""
    by_fault: dict[str, list[float]] = {}
    for one in among:
        by_fault.setdefault(one.fault, []).append(values(one))
    if not all(np.isfinite(some).all() for some in by_fault.values()):
        return None
    good, faulty = np.array(by_fault.pop("")), np.array(by_fault.pop(fault))
    span = float(np.median(faulty) - np.median(good))
    others = {name: (float(np.mean(some)) - float(np.median(good))) / (span or np.inf) for name, some in by_fault.items()}
    return Separation(float(np.median(good)), float(good.std()), float(np.median(faulty)), float(faulty.std()), others)


def evidence_table(action: str, among: Sequence[Try]) -> ResultTable:
    """Every line of evidence of a file, and what they make together."""
    rows = []
    readings = {one: Reading(one.track, one.attempt.handed) for one in among}
    for fault in taught(action).fault:
        values = {
            evidence: {one: evaluate(evidence, reading, one.attempt).value for one, reading in readings.items()}
            for evidence in fault.evidence
        }
        for evidence, found in values.items():
            rows.append(_row(fault.name, f"{_side(evidence)}{name_of(evidence)}", separation(found.__getitem__, fault.name, among)))
        total = sum(evidence.weight for evidence in fault.evidence)

        def together(one: Try, total: float = total, values: dict[Evidence, dict[Try, float]] = values) -> float:
            return sum(evidence.weight * severity(evidence, found[one]) for evidence, found in values.items()) / total

        rows.append(_row(fault.name, "severity", separation(together, fault.name, among)))
    return _table(f"{action}: evidence in good and in faulty performances", rows)


def search_table(action: str, fault: str, among: Sequence[Try]) -> ResultTable:
    """The measures that tell a fault apart best."""
    found = []
    for measure in candidates():
        apart = separation(lambda one, measure=measure: one_value(one, measure), fault, among)  # type: ignore[misc]
        if apart is not None and apart.apart > _ENOUGH:
            found.append((apart.apart - max((abs(value) for value in apart.others.values()), default=0.0), measure, apart))
    found.sort(key=lambda one: -one[0])
    rows = [_row(fault, f"{_side(measure)}{name_of(measure)}", apart) for _, measure, apart in found[:_BEST]]
    return _table(f"{action}: what tells {fault} apart", rows)


def candidates() -> Iterator[Measure]:
    """Every signal over stretches that may say something."""
    for name, signal in CATALOGUE.items():
        for side in ("lead", "other", "both") if signal.sided else ("both",):
            for take in ("max", "min", "mean", "range"):
                for over in (("start", "exertion"), ("start", "peak"), ("exertion", "peak"), ("exertion", "end"), ("peak", "end")):
                    yield Measure(signal=name, side=side, over=over, take=take)
                for shift_s in _AROUND:
                    yield Measure(signal=name, side=side, at="peak", shift_s=shift_s, take=take)


_SERIES: dict[tuple[int, str, str], Float] = {}


def one_value(one: Try, measure: Measure) -> float:
    """A candidate's value, by whole frames; without its sigma, which would take a hundred times as long."""
    first, early_s, last, late_s = measure.stretch
    begin, end = (
        one.track.frame_at(one.attempt.moment_s(phase) + shift_s) for phase, shift_s in ((first, early_s), (last, late_s))
    )
    frames = slice(max(round(begin), 0), round(end) + 1)
    values = _values(one, CATALOGUE[str(measure.signal)], measure.side)[frames]
    if not len(values):
        return float("nan")
    return float(np.ptp(values) if measure.take == "range" else getattr(np, measure.take)(values))


def _values(one: Try, signal: Signal, side: str) -> Float:
    key = (id(one), signal.name, side)
    if key not in _SERIES:
        lead = one.attempt.handed
        other: BodySide = "left" if lead == "right" else "right"
        sides: tuple[BodySide, ...] = (lead, other) if side == "both" and signal.sided else (other if side == "other" else lead,)
        _SERIES[key] = np.mean([_of_side(one, signal, body_side) for body_side in sides], axis=0)
    return _SERIES[key]


def _of_side(one: Try, signal: Signal, side: BodySide) -> Float:
    stature_m = one.performed.stature_m
    joints = one.track.joints_m
    points = (joints, rate(joints, one.track.frame_s), rate_of_rate(joints, one.track.frame_s))[signal.order]
    value = signal.formula(Posture(lambda joint: points[:, joint], side, stature_m, masses_of(stature_m)))
    value = unwrapped(value) if signal.turns else value
    value = value - value[round(one.track.frame_at(one.attempt.moment_s("start")))] if signal.from_start else value
    return -rate(value, one.track.frame_s) if signal.rate_of else value


def _side(measure: Measure) -> str:
    return f"{measure.side} " if measure.side != "both" else ""


def _row(fault: str, name: str, found: Separation | None) -> tuple[str | float | None, ...]:
    if found is None:
        return fault, name, None, None, None, None, None, "not known of everybody"
    worst = max(found.others.items(), key=lambda one: abs(one[1]), default=("", 0.0))
    return (
        *(fault, name, found.good, found.good_sigma, found.fault, found.fault_sigma, found.apart),
        f"{worst[0]} {worst[1]:+.1f}",
    )


def _table(title: str, rows: Sequence[tuple[str | float | None, ...]]) -> ResultTable:
    columns = ("fault", "measure", "good", "± ", "fault ", "±", "apart, sigma", "most confused with")
    return ResultTable(title, columns, tuple(rows))


def main() -> int:
    """Print; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=tuple(ACTIONS))
    parser.add_argument("--search", metavar="FAULT")
    parser.add_argument("--pupils", type=int, default=_PUPILS)
    parser.add_argument("--data", type=Path, default=Path("build"))
    options = parser.parse_args()
    among = tries(options.action, options.pupils, options.data)
    if options.search is None:
        table = evidence_table(options.action, among)
    elif options.search in {fault.name for fault in ACTIONS[options.action].faults}:
        table = search_table(options.action, options.search, among)
    else:
        sys.stderr.write(f"tune: {options.action} has no fault '{options.search}'\n")
        return 2
    Console(width=180).print(table.for_terminal())
    return 0


if __name__ == "__main__":
    sys.exit(main())
