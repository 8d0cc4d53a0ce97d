"""Performances of a standard as a search for them compares them, and as what their own movement makes of the scale.

How far a performance is from one of them is told as a share of how far somebody is who only stands there: 0 is the same motion,
and a walk, a wave or a bend is not much nearer than 1 to anything.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.motion import Handed
from models.teaching.standard import FRAME_S, Standard
from services.evaluation.features import features_of, mirrored_features

_SYMMETRIC: Final = 0.03
"""A standard whose features differ from its mirror image by less than this, root of the mean square, has no side that leads."""


@dataclass(frozen=True, eq=False)
class Template:
    """A performance as it is compared.

    Attributes:
        action, handed: whose.
        features: (S, COUNT, 3) from its start to its end, or to shortly after its peak.
        still: (S,) sum of squared distances, from its start to each frame, of somebody who stays as he is at its start.
        keyframes: (4,) frames from its start to each of its keyframes.
    """

    action: str
    handed: Handed
    features: Float
    still: Float
    keyframes: Float


def templates_of(standard: Standard, most: int, past_peak_s: float | None = None) -> Iterator[Template]:
    """At most so many performances as they are compared, and unless there is no difference their mirror images.

    Args:
        standard: whose.
        most: performances, the standard's own first.
        past_peak_s: until so long after the peak; None for all of it.
    """
    performances = (standard.performance, *standard.exemplars)[:most]
    rights = [features_of(one.joints_m, FRAME_S) for one in performances]
    # One performance that no side leads tells it of the action; others, of real people, are never quite like their mirror image.
    led = all(_is_led(right) for right in rights)
    for exemplar, right in zip(performances, rights, strict=True):
        frames = np.array(exemplar.moments_s) / FRAME_S
        first, last = round(frames[0]), round(frames[-1])
        if past_peak_s is not None:
            last = min(round(frames[2] + past_peak_s / FRAME_S), last)
        sides: tuple[tuple[Handed, Float], ...] = (("right", right), ("left", mirrored_features(right)))
        for handed, whole in sides if led else sides[:1]:
            features = whole[first : last + 1]
            still = _still(features)
            if still[-1] > 0:
                yield Template(standard.action, handed, features, still, frames - first)


def _still(features: Float) -> Float:
    """See `Template`. A joint stays where it is first known; what is unknown counts as the known ones do, as in `Spring`."""
    first = np.isfinite(features[..., 0]).argmax(axis=0)
    squared = ((features - features[first, np.arange(features.shape[1])]) ** 2).sum(axis=2)
    known = np.isfinite(squared).sum(axis=1)
    return np.cumsum(np.nan_to_num(squared).sum(axis=1) * (features.shape[1] / np.maximum(known, 1)))


def _is_led(features: Float) -> bool:
    """Whether a performance is another one than its mirror image."""
    apart = ((features - mirrored_features(features)) ** 2).sum(axis=2)
    return bool(np.sqrt(np.nanmean(apart)) >= _SYMMETRIC) if np.isfinite(apart).any() else True
