"""How alike two sets of errors in the same situations are: sizes, memory, swaps, losses, and whether scores know of errors."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from tests.twin.context import Context
from tests.twin.errors import Errors, displacement

SHARES: Final = (0.5, 0.75, 0.9, 0.95, 0.99)
LAGS: Final = (1, 2, 5)
GROUPS: Final = {
    "head": (0, 1, 2, 3, 4),
    **{f"{name}s": (5 + 2 * i, 6 + 2 * i) for i, name in enumerate(("shoulder", "elbow", "wrist", "hip", "knee", "ankle"))},
}
_FEW: Final = 0.002
"""Shares below are as good as none."""
Told = Sequence[tuple[Context, Errors]]
"""Streams, each picture after picture."""


@dataclass(frozen=True, eq=False)
class Description:
    """What a set of errors is like.

    Attributes:
        quantiles: (17, len(SHARES)) of the distance from the true point, in statures, swapped or not.
        memory: (17, len(LAGS)) correlation of a residual with that of so many pictures before, both axes together.
        crossed: (17,) share of joints that are on the other side's place.
        lost: share of pictures without the pupil.
        spell: pictures that a loss lasts in the mean; 0 if there is none.
        knowing: (17,) rank correlation of score and distance; negative, if scores know.
        score: (17,) mean.
        steady: (17,) size of a stream's mean residual, in statures, mean over the streams: what no smoothing takes off.
    """

    quantiles: Float
    memory: Float
    crossed: Float
    lost: float
    spell: float
    knowing: Float
    score: Float
    steady: Float


def describe(told: Told) -> Description:
    """Errors of some streams, all together."""
    found = np.concatenate([errors.found for _, errors in told])
    distance = np.concatenate([np.linalg.norm(displacement(context.pose, errors), axis=-1) for context, errors in told])[found]
    score = np.concatenate([errors.score for _, errors in told])[found]
    lost = [~errors.found for _, errors in told]
    ends = sum(int(one[-1]) + int((one[:-1] & ~one[1:]).sum()) for one in lost if len(one))
    return Description(
        quantiles=np.quantile(distance, SHARES, axis=0).T if len(distance) else np.full((coco.COUNT, len(SHARES)), np.nan),
        memory=np.stack([_memory([errors for _, errors in told], lag) for lag in LAGS], axis=-1),
        crossed=np.concatenate([errors.crossed for _, errors in told])[found].mean(axis=0),
        lost=float(1.0 - found.mean()),
        spell=float(sum(one.sum() for one in lost) / ends) if ends else 0.0,
        knowing=np.array([_rank_correlation(score[:, j], distance[:, j]) for j in range(coco.COUNT)]),
        score=score.mean(axis=0),
        steady=np.mean([_steady(errors) for _, errors in told if errors.found.any()], axis=0),
    )


def unlikeness(told: Description, twin: Description) -> dict[str, float]:
    """How far two descriptions are apart, by kind; `all` is what fitting makes small.

    Sizes and steadiness are compared by the mean absolute logarithm of their ratio, memory and what scores know by their mean
    absolute difference, shares by the logarithm of their ratio, rare ones as if they were a little less rare.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        size = float(np.nanmean(np.abs(np.log(twin.quantiles / told.quantiles))))
        steady = float(np.nanmean(np.abs(np.log(twin.steady / told.steady))))
    apart = {
        "size": size,
        "steady": steady,
        "memory": float(np.nanmean(np.abs(twin.memory - told.memory))),
        "crossed": float(np.mean(_ratio(twin.crossed, told.crossed))),
        "lost": float(_ratio(np.array(twin.lost), np.array(told.lost))),
        "knowing": float(np.nanmean(np.abs(twin.knowing - told.knowing))),
    }
    # Swaps and losses are rare, so that their shares are known to a quarter or so at best.
    weights = {"size": 1.0, "steady": 0.5, "memory": 1.0, "crossed": 0.3, "lost": 0.1, "knowing": 1.0}
    return apart | {"all": sum(weights[name] * value for name, value in apart.items())}


def _ratio(one: Float, other: Float) -> Float:
    return np.asarray(np.abs(np.log((one + _FEW) / (other + _FEW))))


def _memory(told: Sequence[Errors], lag: int) -> Float:
    """(17,) correlation of residuals so many pictures apart, where the joint is where it belongs in both."""
    out = np.full(coco.COUNT, np.nan)
    long = [errors for errors in told if len(errors) > lag]
    if not long:
        return out
    now, then = (np.concatenate([errors.residual[part] for errors in long]) for part in (slice(lag, None), slice(None, -lag)))
    both = np.concatenate([errors.found[lag:] & errors.found[:-lag] for errors in long])
    apart = np.concatenate([errors.crossed[lag:] | errors.crossed[:-lag] for errors in long])
    for joint in range(coco.COUNT):
        chosen = both & ~apart[:, joint]
        if chosen.sum() > 30:
            # By ranks: one wild error must not decide.
            out[joint] = np.mean([_rank_correlation(now[chosen, joint, axis], then[chosen, joint, axis]) for axis in range(2)])
    return out


def _steady(errors: Errors) -> Float:
    """(17,) of one stream."""
    counted = (errors.found[:, None] & ~errors.crossed)[..., None]
    mean = (errors.residual * counted).sum(axis=0) / np.maximum(counted.sum(axis=0), 1)
    return np.asarray(np.linalg.norm(mean, axis=-1))


def _rank_correlation(one: Float, other: Float) -> float:
    if len(one) < 3 or np.ptp(one) == 0 or np.ptp(other) == 0:
        return float("nan")
    from scipy.stats import rankdata  # noqa: PLC0415 - a fifth of a second, and every process of pytest imports this module

    return float(np.corrcoef(rankdata(one), rankdata(other))[0, 1])
