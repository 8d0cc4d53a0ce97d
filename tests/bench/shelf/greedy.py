"""The simple method that others use for several people, as strong as it gets without robustness and memory: the baseline.

The same grouping in each picture; persons of different cameras are joined by average linkage on the mean distance between the
rays of their common joints, never two of one camera; each joint by a linear solution (DLT) weighted by the candidates' scores.
"""

from itertools import combinations
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco
from services.fusion.views import Views
from tests.bench.shelf.openpose import Grouped

LINK_M: Final = 0.2
"""Persons further apart are not joined; from 0.10 to 0.50 PCP on frames 300-374 is the same within 0.1."""
_MIN_COMMON: Final = 3


def greedy_persons(views: Views, pictures: list[list[Grouped]]) -> list[Float]:
    """(17, 3) joints of each person that two cameras or more see; NaN where fewer than two see the joint."""
    seen = [(camera, person) for camera, persons in enumerate(pictures) for person in persons]
    clusters = _link([camera for camera, _ in seen], _distances(views, seen))
    return [_triangulated(views, [seen[i] for i in cluster]) for cluster in clusters if len(cluster) >= 2]


def _distances(views: Views, seen: list[tuple[int, Grouped]]) -> Float:
    """(n, n) mean distance in metres between the rays of two persons' common joints; infinite where there is no telling."""
    rays = []
    for camera, person in seen:
        ray = np.column_stack((person.points_px, np.ones(coco.COUNT))) @ views.rays[camera].T
        rays.append(ray / np.linalg.norm(ray, axis=1, keepdims=True))
    out = np.full((len(seen), len(seen)), np.inf)
    for a, b in combinations(range(len(seen)), 2):
        common = (seen[a][1].score > 0) & (seen[b][1].score > 0)
        if seen[a][0] == seen[b][0] or common.sum() < _MIN_COMMON:
            continue
        normal = np.cross(rays[a][common], rays[b][common])
        base = views.centres_m[seen[b][0]] - views.centres_m[seen[a][0]]
        out[a, b] = out[b, a] = np.mean(np.abs(normal @ base) / np.maximum(np.linalg.norm(normal, axis=1), 1e-9))
    return out


def _link(cameras: list[int], distances: Float) -> list[list[int]]:
    """Average linkage: the two nearest clusters are joined until none are nearer than `LINK_M`."""
    clusters = [[i] for i in range(len(cameras))]
    while True:
        best, pair = LINK_M, None
        for a, b in combinations(range(len(clusters)), 2):
            if {cameras[i] for i in clusters[a]} & {cameras[i] for i in clusters[b]}:
                continue
            apart = float(distances[np.ix_(clusters[a], clusters[b])].mean())
            if apart < best:
                best, pair = apart, (a, b)
        if pair is None:
            return clusters
        clusters[pair[0]] += clusters.pop(pair[1])


def _triangulated(views: Views, members: list[tuple[int, Grouped]]) -> Float:
    joints = np.full((coco.COUNT, 3), np.nan)
    for joint in range(coco.COUNT):
        rows = []
        for camera, person in members:
            weight, projection = person.score[joint], views.projections[camera]
            if weight > 0:
                rows += [weight * (person.points_px[joint, axis] * projection[2] - projection[axis]) for axis in (0, 1)]
        if len(rows) >= 4:
            solution = np.linalg.svd(np.array(rows))[2][-1]
            joints[joint] = solution[:3] / solution[3]
    return joints
