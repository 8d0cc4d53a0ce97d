"""Shares of visible joints that a network puts within 5 % of body height, by anything that one may ask for."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from tests.bench.metrics.correctness import pck_pct
from tests.bench.networks.landmarks import Looks
from tests.bench.networks.looks import Looked, Name, Turn, errors_of_height
from tests.bench.reconstruct.lesson import Lesson

WITHIN: Final = 0.05
UPRIGHT_ACTIONS: Final = (
    "basketball_shot", "long_jump", "badminton_clear", "volleyball_spike", "soccer_kick", "squat", "star_jump", "run",
)  # fmt: skip
_BELIEVED: Final = 0.3


@dataclass(frozen=True, eq=False)
class Errors:
    """One network, one way of cropping, one camera of one lesson.

    Attributes:
        network, turn, camera, seed, pupil: which.
        of_height: (n, 17) error over the body's height; NaN where the pupil was not looked at.
        visible: (n, 17) whether the joint can be seen; only these count.
        actions: (n,) what is done; empty between attempts.
    """

    network: Name
    turn: Turn
    camera: str
    seed: int
    pupil: str
    of_height: Float
    visible: Bool
    actions: tuple[str, ...]


def errors(lesson: Lesson, looked: dict[str, Looked], network: Name, turn: Turn) -> list[Errors]:
    """Of each camera."""
    found = []
    for camera in lesson.rig:
        truth = lesson.pictures[camera.name]
        actions = tuple(lesson.action_at(float(t)) for t in truth.times_s)
        of_height = errors_of_height(lesson, camera, looked[camera.name])
        found.append(Errors(network, turn, camera.name, lesson.seed, lesson.pupil, of_height, truth.visible, actions))
    return found


def within5_pct(chosen: Sequence[Errors], actions: Sequence[str]) -> float:
    """Percent of the visible joints in pictures of these actions; a pupil who was not looked at is wrong. NaN without any."""
    shares = [each.of_height[_of(each, actions)][each.visible[_of(each, actions)]] for each in chosen]
    return pck_pct(np.concatenate(shares), WITHIN) if shares else np.nan


def by_joint(chosen: Sequence[Errors], actions: Sequence[str], joint: int) -> float:
    """The same of one joint."""
    shares = [each.of_height[_of(each, actions), joint][each.visible[_of(each, actions), joint]] for each in chosen]
    return pck_pct(np.concatenate(shares), WITHIN) if shares else np.nan


def bias_looks(lesson: Lesson, looked: dict[str, Looked], wanted: Callable[[str], bool]) -> list[Looks]:
    """What a lesson's pictures of some actions say of the landmark bias: visible points that the network believes in."""
    found = []
    for camera in lesson.rig:
        truth, said = lesson.pictures[camera.name], looked[camera.name]
        chosen = np.array([wanted(lesson.action_at(float(t))) for t in truth.times_s], np.bool_)
        counts = truth.visible & (np.nan_to_num(said.scores) >= _BELIEVED) & chosen[:, None]
        found.append(Looks(camera, said.points_px, truth.points_m, counts))
    return found


def _of(each: Errors, actions: Sequence[str]) -> Bool:
    return np.array([action in actions for action in each.actions], np.bool_)
