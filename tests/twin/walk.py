"""The bootstrap in time: from the errors in one picture to those in the next, by what came next where it was alike.

All loops that are hot are here: the search of the nearest transitions, and the walk along a stream.
"""

from typing import NamedTuple

import numpy as np

from models.arrays import Bool, Float, Float32
from models.compiled import Counts, compiled

UNKNOWN = -2
_SMALL_ERROR = 0.01
"""Errors are compared on a scale that is linear up to this share of the stature and logarithmic beyond."""
_ORDINARY = 0.1
"""Larger errors, in statures, are not carried on in part."""
_NEVER = np.float32(1e30)


class Table(NamedTuple):
    """The N transitions of a library, from one picture to the next, for a part of J joints.

    A mode is a number for the set of joints that are crossed, or negative if nobody is found.

    Attributes:
        pictures: (D, N) features of the second pictures.
        befores: (3 J, N) features of the errors in the first ones; see `error_rows`.
        mode_before: (N,) mode in the first picture.
        mode_after: (N,) in the second one.
        found_after: (N,) whether the pupil is found there.
        given_after: (N,) mode of the earlier parts' joints there.
        residual_before: (N, J, 2) errors in the first picture.
        residual_after: (N, J, 2) in the second one.
        trust_before: (N, J, 2) score and spread in the first one.
        trust_after: (N, J, 2) in the second one.
        factors: (2,) see `error_rows`.
        carry: (J,) share of the difference between the errors before and the neighbour's before that is carried on.
    """

    pictures: Float32
    befores: Float32
    mode_before: Counts
    mode_after: Counts
    found_after: Bool
    given_after: Counts
    residual_before: Float
    residual_after: Float
    trust_before: Float
    trust_after: Float
    factors: Float
    carry: Float


class Path(NamedTuple):
    """What a walk leads through.

    Attributes:
        query: (n, D) features of the pictures.
        found: (n,) whether the pupil is found there; not read by the part that leads.
        given: (n,) mode of the earlier parts' joints there.
        draws: (n, 2) uniform random numbers.
    """

    query: Float32
    found: Bool
    given: Counts
    draws: Float


@compiled
def error_rows(residual: Float, score: Float, factors: Float) -> Float32:
    """(3 J, n) features of errors, by which they are compared with those before.

    Args:
        residual: (n, J, 2).
        score: (n, J).
        factors: (2,) what residuals and scores are multiplied with.
    """
    out = np.empty((3 * residual.shape[1], residual.shape[0]), np.float32)
    row = np.empty(3 * residual.shape[1], np.float32)
    for n in range(residual.shape[0]):
        _error_row(residual[n], score[n], factors, row)
        out[:, n] = row
    return out


@compiled
def nearest(table: Table, group: Counts, asked: Counts, k: int) -> Counts:
    """The transitions nearest to some of them, in other groups, from the same mode to the same mode.

    Args:
        table: where to search.
        group: (N,) of which none is a neighbour of its own: the lessons' seeds.
        asked: (n,) transitions.
        k: how many.

    Returns:
        (n, k) the nearest first; -1 where there are no more.
    """
    out = np.full((asked.shape[0], k), -1)
    best = np.empty(k, np.int64)
    distance = np.empty(group.shape[0], np.float32)
    for n in range(asked.shape[0]):
        own = asked[n]
        distance[:] = np.float32(0.0)
        _add_distance(table.pictures, table.pictures[:, own], distance)
        _add_distance(table.befores, table.befores[:, own], distance)
        for i in range(group.shape[0]):
            same = table.mode_before[i] == table.mode_before[own] and table.mode_after[i] == table.mode_after[own]
            if group[i] == group[own] or not same:
                distance[i] = _NEVER
        count = smallest(distance, best)
        out[n, :count] = best[:count]
    return out


@compiled
def walk(
    table: Table, path: Path, around: int, k: int, leads: bool, mode: int, residual: Float, trust: Float
) -> tuple[Counts, Float, Float]:
    """Walk one part through n pictures.

    What is mistaken for what, the mode, is drawn first: from a wide neighbourhood of the situation, among the transitions that
    begin in the present mode and in which the earlier parts are mistaken alike. A narrow one, in which errors must be alike, too,
    would seldom contain what is rare. Then the errors are drawn from the nearest of those that lead to that mode. Errors that are
    carried on take their score from whoever had errors as large there.

    Args:
        table: what to draw from.
        path: what to walk through.
        around: neighbours by the situation, among which modes are drawn.
        k: neighbours from which errors are drawn, the r-th nearest with a chance of 1 / r.
        leads: whether this part decides if the pupil is found.
        mode: before the first picture; `UNKNOWN` if that is not known. If it is, these tell more:
        residual: (J, 2) and
        trust: (J, 2). They are overwritten with those of the last picture.

    Returns:
        (n,) transitions taken, -1 where nobody is found and this part does not lead; (n, J, 2) residuals; (n, J, 2) trust.
    """
    joints, size, steps = residual.shape[0], table.mode_before.shape[0], path.query.shape[0]
    taken = np.full(steps, -1)
    residuals, trusts = np.zeros((steps, joints, 2)), np.zeros((steps, joints, 2))
    distance, whole = np.empty(size, np.float32), np.empty(size, np.float32)
    row = np.empty(3 * joints, np.float32)
    wide, best = np.empty(around, np.int64), np.empty(k, np.int64)
    for n in range(steps):
        if not leads and not path.found[n]:
            mode = UNKNOWN
            continue
        count = _alike(table, path, n, leads, mode, distance, wide)
        then = table.mode_after[wide[min(int(path.draws[n, 0] * count), count - 1)]]
        whole[:] = distance
        if mode >= 0:
            _error_row(residual, trust[:, 0], table.factors, row)
            _add_distance(table.befores, row, whole)
        for i in range(size):
            if table.mode_after[i] != then or distance[i] >= _NEVER:
                whole[i] = _NEVER
        i = best[_rank(path.draws[n, 1], smallest(whole, best))]
        carries = mode >= 0 and mode == table.mode_before[i] and mode == then
        _follow(table, i, carries, wide[:count], residual, trust)
        taken[n], residuals[n], trusts[n], mode = i, residual, trust, then
    return taken, residuals, trusts


@compiled
def _alike(table: Table, path: Path, n: int, leads: bool, mode: int, distance: Float32, wide: Counts) -> int:
    """The transitions into pictures like the n-th: how many, in `wide`; `distance` is of all, `_NEVER` for those that don't fit."""
    count = 0
    for strictness in range(2, -1, -1):  # What was never seen so has to be made of what is less alike.
        distance[:] = np.float32(0.0)
        _add_distance(table.pictures, path.query[n], distance)
        for i in range(distance.shape[0]):
            fits = leads or (table.found_after[i] and (strictness < 2 or table.given_after[i] == path.given[n]))
            if not (fits and (strictness < 1 or mode in (UNKNOWN, table.mode_before[i]))):
                distance[i] = _NEVER
        count = smallest(distance, wide)
        if count > 0:
            break
    return count


@compiled
def _follow(table: Table, i: int, carries: bool, wide: Counts, residual: Float, trust: Float) -> None:
    """Take over what transition i led to."""
    for j in range(residual.shape[0]):
        share = table.carry[j] if carries else 0.0
        for axis in range(2):
            if not (abs(residual[j, axis]) < _ORDINARY and abs(table.residual_before[i, j, axis]) < _ORDINARY):
                share = 0.0
        for axis in range(2):
            carried = share * (residual[j, axis] - table.residual_before[i, j, axis])
            residual[j, axis] = table.residual_after[i, j, axis] + carried
        source = i
        if share > 0.0:
            large, least = _log_size(residual[j]), np.inf
            for c in wide:
                apart = abs(_log_size(table.residual_after[c, j]) - large) + abs(table.trust_before[c, j, 0] - trust[j, 0])
                if table.mode_after[c] == table.mode_after[i] and apart < least:
                    source, least = c, apart
        trust[j] = table.trust_after[source, j]


@compiled
def _error_row(residual: Float, score: Float, factors: Float, out: Float32) -> None:
    joints = residual.shape[0]
    for j in range(joints):
        out[2 * j] = factors[0] * np.arcsinh(residual[j, 0] / _SMALL_ERROR)
        out[2 * j + 1] = factors[0] * np.arcsinh(residual[j, 1] / _SMALL_ERROR)
        out[2 * joints + j] = factors[1] * score[j]


@compiled
def _log_size(residual: Float) -> float:
    size: float = np.log(np.sqrt(residual[0] ** 2 + residual[1] ** 2) + 0.3 * _SMALL_ERROR)
    return size


@compiled
def _add_distance(features: Float32, query: Float32, out: Float32) -> None:
    for d in range(features.shape[0]):
        value = query[d]
        for i in range(features.shape[1]):
            difference = features[d, i] - value
            out[i] += difference * difference


@compiled
def smallest(values: Float32, best: Counts) -> int:
    """How many values are below 1e30, at most as many as `best` holds; it gets the indices of the smallest ones, ascending.

    Among equals the lower index comes first.
    """
    k, filled = best.shape[0], 0
    worst = _NEVER
    for i in range(values.shape[0]):
        value = values[i]
        if not value < worst:
            continue
        place = min(filled, k - 1)
        while place > 0 and values[best[place - 1]] > value:
            best[place] = best[place - 1]
            place -= 1
        best[place] = i
        filled = min(filled + 1, k)
        if filled == k:
            worst = values[best[k - 1]]
    return filled


@compiled
def _rank(draw: float, k: int) -> int:
    """A rank from 0 to k - 1, rank r with a chance proportional to 1 / (r + 1) (Lall and Sharma's kernel)."""
    total = 0.0
    for r in range(k):
        total += 1.0 / (r + 1)
    reached = 0.0
    for r in range(k):
        reached += 1.0 / (r + 1) / total
        if draw < reached:
            return r
    return k - 1
