"""What was found against what there is: precision, recall and F1 of matches, keyframes and attempts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from models.arrays import Bool


@dataclass(frozen=True)
class Retrieval:
    """Counts.

    Attributes:
        right: found, and there.
        found: all that was found.
        there: all that there is.
    """

    right: int
    found: int
    there: int

    def __add__(self, other: "Retrieval") -> "Retrieval":
        return Retrieval(self.right + other.right, self.found + other.found, self.there + other.there)

    @property
    def precision_pct(self) -> float:
        """Share of what was found that is there; NaN if nothing was found."""
        return 100 * self.right / self.found if self.found else np.nan

    @property
    def recall_pct(self) -> float:
        """Share of what is there that was found; NaN if there is nothing."""
        return 100 * self.right / self.there if self.there else np.nan

    @property
    def f1(self) -> float:
        """Harmonic mean of precision and recall, 0 to 1; NaN if nothing is there and nothing was found."""
        both = self.found + self.there
        return 2 * self.right / both if both else np.nan


def one_to_one(allowed: Bool) -> Retrieval:
    """The most pairs (found, there) in which nobody takes part twice; `allowed` (found, there) says who may be a pair."""
    found, there = allowed.shape
    if not allowed.any():
        return Retrieval(0, found, there)
    partners = maximum_bipartite_matching(csr_array(allowed), perm_type="column")
    return Retrieval(int((partners >= 0).sum()), found, there)


def moments(found_s: Sequence[float], true_s: Sequence[float], tolerance_s: float) -> Retrieval:
    """Keyframes of one kind: a pair is at most `tolerance_s` apart."""
    apart = np.abs(np.subtract.outer(np.asarray(found_s, np.float64), np.asarray(true_s, np.float64)))
    return one_to_one(np.asarray(apart <= tolerance_s))


def intervals(
    found_s: Sequence[tuple[float, float]], true_s: Sequence[tuple[float, float]], least_overlap: float = 0.5
) -> Retrieval:
    """Attempts, as (begin, end): a pair's common time is at least `least_overlap` of the time that the two cover together."""
    found, true = (np.asarray(spans, np.float64).reshape(-1, 2) for spans in (found_s, true_s))
    begin = np.maximum.outer(found[:, 0], true[:, 0])
    end = np.minimum.outer(found[:, 1], true[:, 1])
    common = np.maximum(end - begin, 0.0)
    either = np.add.outer(found[:, 1] - found[:, 0], true[:, 1] - true[:, 0]) - common
    return one_to_one(np.asarray((common > 0) & (common >= least_overlap * either)))


def pairs(found: set[tuple[int, int]], true: set[tuple[int, int]]) -> Retrieval:
    """Matches of points: pairs of indices."""
    return Retrieval(len(found & true), len(found), len(true))
