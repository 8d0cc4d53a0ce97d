"""Figures by their fixed names, rows and tables of what was measured."""

import math
import statistics
from collections.abc import Iterable, Sequence
from typing import Final

from tests.bench.reconstruct.figures import mean_over
from tests.bench.reconstruct.lesson import UPRIGHT
from tests.bench.reconstruct.measure import UPRIGHT_MEAN, Measured
from tests.bench.table import Cell, ResultTable, spread, table_of

COLUMNS: Final = (
    "mpjpe_mm", "p95_mm", "pampjpe_mm", "pck50_pct", "pck_auc150_pct", "acc_error_mm", "max_jump_mm", "peak_speed_bias_pct",
    "missing_pct", "frames_without_pose",
)  # fmt: skip


def by_action_table(measured: Sequence[Measured], way: str) -> ResultTable:
    """All figures of each action, mean ± deviation over the lessons."""
    actions = [action for action in (*UPRIGHT, *measured[0].smooth) if action in measured[0].smooth and action != UPRIGHT_MEAN]
    rows: dict[str, dict[str, Cell]] = {}
    for action in dict.fromkeys(actions):
        rows[action] = {name: spread([each.smooth[action][name] for each in measured if action in each.smooth]) for name in COLUMNS}
        live = [each.live[action]["mpjpe_mm"] for each in measured if action in each.live]
        rows[action]["live mpjpe_mm"] = spread(live)
    return table_of(f"by action, {way}; {len(measured)} lessons, mean ± deviation", "action", rows)


def by_pupil_table(measured: Sequence[Measured]) -> ResultTable:
    """MPJPE of each lesson's pupil, action by action."""
    rows: dict[str, dict[str, Cell]] = {
        f"{each.lesson}": {action: figures["mpjpe_mm"] for action, figures in each.smooth.items()} for each in measured
    }
    return table_of("MPJPE in mm by pupil and action, live rate", "lesson", rows)


def figures_of(measured: Measured, suffix: str) -> dict[str, float]:
    """One lesson's figures by their fixed names; `suffix` is of the way of looking, empty for the live rate."""
    smooth, live = measured.smooth, measured.live
    means = {kind: mean_over(UPRIGHT, figures) for kind, figures in (("smooth", smooth), ("live", live))}
    mean, whole = means["smooth"], smooth.get(UPRIGHT_MEAN, {})
    named = {f"mpjpe_mm{suffix or '.mean'}": mean.get("mpjpe_mm")}
    if suffix in {"", ".every_frame"}:
        named |= {f"mpjpe_mm.{action}{suffix}": figures["mpjpe_mm"] for action, figures in smooth.items() if action != UPRIGHT_MEAN}
        named |= {f"mpjpe_mm.p95{suffix}": whole.get("p95_mm"), f"mpjpe_mm.live{suffix}": means["live"].get("mpjpe_mm")}
        named |= {
            f"pampjpe_mm{suffix or '.mean'}": mean.get("pampjpe_mm"),
            f"pampjpe_mm.live{suffix}": means["live"].get("pampjpe_mm"),
        }
        others = (
            "pck50_pct",
            "pck_auc150_pct",
            "acc_error_mm",
            "max_jump_mm",
            "peak_speed_bias_pct",
            "missing_pct",
        )
        for name in others:
            named |= {f"{name}{suffix}": mean.get(name), f"{name}.live{suffix}": means["live"].get(name)}
        named |= {
            f"{name}{suffix}": value for name, value in measured.further.items() if name not in {"crb_mm", "jitter_reduction_pct"}
        }
    if "jitter_reduction_pct" in measured.further:
        named["jitter_reduction_pct"] = measured.further["jitter_reduction_pct"]
    return {name: value for name, value in named.items() if value is not None}


def rows_of(measured: Measured) -> list[dict[str, object]]:
    """Everything that was measured of one lesson, action by action; instants without a pose by name."""
    return [
        {
            "lesson": measured.lesson,
            "seed": measured.seed,
            "way": measured.way,
            "crops_of_commit": measured.commit,
            "action": action,
            **{name: round(value, 4) for name, value in figures.items()},
            "without_pose_s": measured.without_pose.get(action, []),
        }
        for action, figures in measured.smooth.items()
        if action != UPRIGHT_MEAN
    ]


def lost(measured: Measured) -> int:
    """Frames of all attempts in which the smooth motion has no pose."""
    return sum(len(instants) for instants in measured.without_pose.values())


def change_pct(measured: Sequence[Measured], live: Sequence[Measured]) -> float:
    """By how much the headline of these lessons differs from that of the live rate on the very same ones, by their seeds."""
    headline = {each.seed: _headline_mm(each) for each in live}
    own = statistics.fmean(map(_headline_mm, measured))
    return 100 * (own / statistics.fmean(headline.get(each.seed, math.nan) for each in measured) - 1)


def _headline_mm(measured: Measured) -> float:
    return mean_over(UPRIGHT, measured.smooth).get("mpjpe_mm", math.nan)


def dataset_figures(measured: Iterable[Measured], suffix: str) -> dict[str, float]:
    """Means over films, by the names that the rendered lessons' have."""
    films = {str(number): each.smooth[UPRIGHT_MEAN] for number, each in enumerate(measured)}
    figures = mean_over(list(films), films)
    names = {"p95_mm": f"mpjpe_mm.p95{suffix}"} | {name: f"{name}{suffix or '.mean'}" for name in ("mpjpe_mm", "pampjpe_mm")}
    return {names.get(name, f"{name}{suffix}"): value for name, value in figures.items()}
