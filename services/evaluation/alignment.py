"""Dynamic time warping (equation 19): which frame of a motion is which frame of the standard.

`warp` aligns two whole motions within a Sakoe-Chiba band (Sakoe and Chiba, "Dynamic programming algorithm optimization for spoken
word recognition", IEEE Trans. ASSP 26(1), 1978). `Spring` finds, frame by frame, where in a stream templates are performed
(Sakurai, Faloutsos and Yamamuro, "Stream monitoring under the time warping distance", ICDE 2007): a frame costs as much work as
the templates have frames, however long the stream is.

Unknown joints have no part: what the known ones are apart is counted for them as well. Frames that share no known joint are apart
by nothing; `align` leaves none without any.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from models.skeleton import coco
from models.teaching.standard import FRAME_S, Standard
from services.evaluation.following import bridged, follow
from services.evaluation.normalise import Placing, PlacingError, placed, placing_of
from services.evaluation.track import Track

BAND: Final = 0.35
"""Half width of the band in `align`, as a share of the longer motion."""


@dataclass(frozen=True, eq=False)
class Alignment:
    """Of two motions of T and S frames.

    Attributes:
        cost: D(T, S) of equation 19, sum of squared distances along the path.
        path: (L, 2) pairs of frames, from (0, 0) to (T - 1, S - 1); each step goes one frame ahead in one motion or in both.
    """

    cost: float
    path: Counts

    def onto(self, frame: float) -> float:
        """The frame of the first motion that is frame `frame` of the second one: the mean of those that are, and between them."""
        ours, theirs = self.path[:, 0].astype(np.float64), self.path[:, 1]
        means = np.bincount(theirs, ours) / np.bincount(theirs)
        return float(np.interp(frame, np.arange(len(means)), means))


@dataclass(frozen=True, eq=False)
class AlignedTrack:
    """An attempt along its standard.

    Attributes:
        alignment: of the attempt's frames with the standard's, and what they are apart on the whole.
        frames: (T,) the one moment of the standard that each frame of the attempt is compared with and shown beside, in its frames
            (`services.evaluation.following`).
        placing: how the attempt was brought into the standard's frame.
        joints_m: (T, 17, 3) the attempt there (`services.evaluation.normalise.placed`).
        standard_m: (S, 17, 3) the standard, the middle of the hips above the origin as well.
    """

    alignment: Alignment
    frames: Float
    placing: Placing
    joints_m: Float
    standard_m: Float


def align(track: Track, standard: Standard, band: float = BAND) -> AlignedTrack | None:
    """Align an attempt that leads with the right (`normalise.lead_right`) with a standard.

    Returns:
        None if the track has no frame, or does not show how the pupil stands and how tall he is.
    """
    try:
        own = placing_of(standard.joints_m, FRAME_S, 1.0)
        trunk_seen: Bool = np.asarray(track.seen[:, coco.TRUNK].all(axis=1))
        placing = placing_of(track.joints_m, track.frame_s, 1.0 / own.scale, vouched=trunk_seen)
    except PlacingError:
        return None
    joints, theirs = placed(track.joints_m, placing), placed(standard.joints_m, replace(own, scale=1.0))
    radius = int(np.ceil(band * max(len(joints), len(theirs))))
    # What was not seen at all lies between what was: else the path would hide there whatever it finds no other place for.
    one, other = bridged(joints), bridged(theirs)
    return AlignedTrack(warp(one, other, radius), follow(one, other, track.frame_s), placing, joints, theirs)


def warp(ours: Float, theirs: Float, radius: int | None = None) -> Alignment:
    """Align two motions.

    Args:
        ours: (T, K, 3) at least one frame; NaN is unknown.
        theirs: (S, K, 3) at least one frame.
        radius: of the band, in frames about the diagonal, on one side widened by the difference of the lengths; None takes none.

    Raises:
        ValueError: a motion has no frame, they are of different joints, or the radius is negative.
    """
    if not len(ours) or not len(theirs) or ours.shape[1:] != theirs.shape[1:] or (radius is not None and radius < 0):
        raise ValueError(f"motions of the shapes {ours.shape} and {theirs.shape} cannot be aligned within {radius} frames")
    wide = max(len(ours), len(theirs)) if radius is None else radius
    one, other = (np.ascontiguousarray(motion.reshape(len(motion), -1), np.float64) for motion in (ours, theirs))
    costs = _accumulated(one, other, wide)
    return Alignment(float(costs[-1, -1]), _path(costs))


class Spring:
    """Where templates are performed in a stream. Each frame ends the best performance of each template that could end there."""

    def __init__(self, templates: Sequence[Float]) -> None:
        """Templates of (S, K, 3)."""
        if not templates or min(map(len, templates)) == 0:
            raise ValueError("a search has at least one template, and each has at least one frame")
        flat = [np.ascontiguousarray(template.reshape(len(template), -1), np.float64) for template in templates]
        self._frames = np.concatenate(flat)
        self._firsts = np.cumsum([0, *map(len, flat)])
        self.lengths: Counts = np.diff(self._firsts)
        """(N,) frames of each template."""
        self.reset()

    def reset(self, count: int = 0) -> None:
        """Forget the stream; the next frame is number `count`."""
        self._costs = np.full(len(self._frames), np.inf)
        self._starts = np.full(len(self._frames), -1)
        self._count = count

    @property
    def costs(self) -> Float:
        """(N,) sum of squared distances of the best performance of each template that ends at the newest frame."""
        return np.asarray(self._costs[self._firsts[1:] - 1])

    @property
    def starts(self) -> Counts:
        """(N,) the frame at which it began."""
        return np.asarray(self._starts[self._firsts[1:] - 1])

    def ahead(self) -> Iterator[tuple[Float, Counts]]:
        """Of each template: (S,) costs of the best performances that have come as far as each of its frames, and their starts."""
        for first, end in pairwise(self._firsts.tolist()):
            yield self._costs[first:end], self._starts[first:end]

    def forget(self, until: int) -> None:
        """Performances that began at frame `until` or before have no part any more."""
        self._costs[self._starts <= until] = np.inf

    def skip(self) -> None:
        """The next frame is not known: no performance goes on in it, none ends, and none is given up."""
        self._count += 1

    def push(self, joints: Float) -> None:
        """Take the next frame, (K, 3); NaN is unknown. One without a known joint is as good as any frame: `skip` it."""
        frame = np.ascontiguousarray(joints.ravel(), np.float64)
        _advance(frame, self._frames, self._firsts, self._count, self._costs, self._starts)
        self._count += 1


@compiled
def _apart(one: Float, other: Float) -> float:
    """Sum of squared distances between the (3 K,) joints of two frames, of which some are unknown."""
    total, known = 0.0, 0
    for k in range(0, one.shape[0], 3):
        x, y, z = one[k] - other[k], one[k + 1] - other[k + 1], one[k + 2] - other[k + 2]
        squared = x * x + y * y + z * z
        if not np.isnan(squared):
            total += squared
            known += 1
    return total * (one.shape[0] // 3) / known if known else 0.0


@compiled
def _accumulated(ours: Float, theirs: Float, radius: int) -> Float:
    """(T, S) D of equation 19; infinite outside the band."""
    rows, columns = ours.shape[0], theirs.shape[0]
    costs = np.full((rows, columns), np.inf)
    below, above = radius + max(0, rows - columns), radius + max(0, columns - rows)
    for i in range(rows):
        for j in range(max(0, i - below), min(columns, i + above + 1)):
            before = np.inf
            if i == 0 and j == 0:
                before = 0.0
            if i > 0:
                before = costs[i - 1, j]
                if j > 0:
                    before = min(before, costs[i - 1, j - 1])
            if j > 0:
                before = min(before, costs[i, j - 1])
            # Written out, for numba turns no such loop into vector instructions once it is a function of its own.
            apart = 0.0
            for k in range(ours.shape[1]):
                difference = ours[i, k] - theirs[j, k]
                apart += difference * difference
            if np.isnan(apart):
                apart = _apart(ours[i], theirs[j])
            costs[i, j] = before + apart
    return costs


@compiled
def _path(costs: Float) -> Counts:
    """(L, 2) back from the last cell, diagonally where that is as good."""
    i, j = costs.shape[0] - 1, costs.shape[1] - 1
    path = np.empty((i + j + 1, 2), np.int64)
    place = i + j
    while True:
        path[place, 0], path[place, 1] = i, j
        if i == 0 and j == 0:
            break
        place -= 1
        diagonal = costs[i - 1, j - 1] if i > 0 and j > 0 else np.inf
        up = costs[i - 1, j] if i > 0 else np.inf
        left = costs[i, j - 1] if j > 0 else np.inf
        if diagonal <= up and diagonal <= left:
            i -= 1
            j -= 1
        elif up <= left:
            i -= 1
        else:
            j -= 1
    return path[place:].copy()


@compiled
def _advance(frame: Float, templates: Float, firsts: Counts, number: int, costs: Float, starts: Counts) -> None:
    """One frame further, in place: every template's costs and starts, by the recurrence of equation 19 with a free beginning."""
    for n in range(firsts.shape[0] - 1):
        cost_before, start_before = 0.0, number
        cost_diagonal, start_diagonal = 0.0, number
        for i in range(firsts[n], firsts[n + 1]):
            cost, start = cost_diagonal, start_diagonal
            if costs[i] < cost:
                cost, start = costs[i], starts[i]
            if cost_before < cost:
                cost, start = cost_before, start_before
            cost_diagonal, start_diagonal = costs[i], starts[i]
            apart = 0.0
            for k in range(frame.shape[0]):
                difference = frame[k] - templates[i, k]
                apart += difference * difference
            if np.isnan(apart):
                apart = _apart(frame, templates[i])
            costs[i], starts[i] = cost + apart, start
            cost_before, start_before = costs[i], starts[i]
