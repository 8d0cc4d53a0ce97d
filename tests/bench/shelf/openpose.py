"""OpenPose's joint candidates and part affinities of one picture, grouped into persons.

Every connection of two candidates is looked at once, best first: it joins the two partial persons that its ends belong to unless
both already have one of the same joint (Kruskal's algorithm with that exclusion; the order over all limbs at once is what lets
a sure forearm stop a doubtful upper arm).
Source: Cao et al., "OpenPose: Realtime Multi-Person 2D Pose Estimation using Part Affinity Fields", TPAMI 2021; BODY_25.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.skeleton import coco

JOINTS: Final = 25
LIMBS: Final = tuple(
    zip(
        (1, 9, 10, 8, 8, 12, 13, 1, 2, 3, 2, 1, 5, 6, 5, 1, 0, 0, 15, 16, 14, 19, 14, 11, 22, 11),
        (8, 10, 11, 9, 12, 13, 14, 2, 3, 4, 17, 5, 6, 7, 18, 0, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24),
        strict=True,
    )
)
_TO_COCO: Final = [0, 16, 15, 18, 17, 5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11]
"""The BODY_25 joint of each COCO keypoint."""
MIN_AFFINITY: Final = 0.05
MIN_JOINTS: Final = 4


@dataclass(frozen=True, eq=False)
class Picture:
    """What OpenPose says about one picture.

    Attributes:
        candidates: of each joint, (n, 3) pixels and score.
        affinities: of each limb (a, b), (n_a, n_b).
    """

    candidates: tuple[Float, ...]
    affinities: tuple[Float, ...]


@dataclass(frozen=True, eq=False)
class Grouped:
    """One person in one picture.

    Attributes:
        points_px: (17, 2) COCO keypoints.
        score: (17,) 0 where there is none.
    """

    points_px: Float
    score: Float


def group(picture: Picture, min_affinity: float = MIN_AFFINITY) -> list[Grouped]:
    """The persons of a picture with at least `MIN_JOINTS` joints each."""
    # A partial person is the candidate of each joint that it has.
    owner = {(joint, i): {joint: i} for joint in range(JOINTS) for i in range(len(picture.candidates[joint]))}
    for _, joint_a, a, joint_b, b in sorted(_connections(picture, min_affinity), reverse=True):
        first, second = owner[joint_a, a], owner[joint_b, b]
        if first is second or first.keys() & second.keys():
            continue
        first |= second
        for joint, i in second.items():
            owner[joint, i] = first
    persons = {id(person): person for person in owner.values()}.values()
    return [_as_coco(picture, person) for person in persons if len(person) >= MIN_JOINTS]


def _connections(picture: Picture, min_affinity: float) -> Iterator[tuple[float, int, int, int, int]]:
    for (joint_a, joint_b), affinity in zip(LIMBS, picture.affinities, strict=True):
        for a, b in np.argwhere(affinity >= min_affinity).tolist():
            yield float(affinity[a, b]), joint_a, a, joint_b, b


def _as_coco(picture: Picture, person: dict[int, int]) -> Grouped:
    points, score = np.zeros((coco.COUNT, 2)), np.zeros(coco.COUNT)
    for keypoint, joint in enumerate(_TO_COCO):
        if joint in person:
            found = picture.candidates[joint][person[joint]]
            points[keypoint], score[keypoint] = found[:2], found[2]
    return Grouped(points, score)
