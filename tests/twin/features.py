"""What makes two situations alike: numbers whose squared differences add up to a distance.

Every group of numbers is divided by what is a small difference of its kind, and by the root of how many there are, so that the
groups' weights mean the same for every part of the body.
"""

from dataclasses import asdict, dataclass

import numpy as np

from models.arrays import Float, Float32
from tests.twin.context import Context
from tests.twin.errors import Errors
from tests.twin.parts import Part

_POSE, _VIEW, _HIDDEN, _SPEED, _SIZE, _SCORE = 0.06, 0.25, 0.5, 0.4, 0.3, 0.15
_SMALL_ERROR = 0.01
"""As in `tests.twin.walk`."""


@dataclass(frozen=True)
class Weights:
    """How much each group counts.

    Attributes:
        pose: places of the part's joints and of those beside it.
        view: direction to the camera.
        hidden: what hides them.
        speed: in the picture.
        size: of the body in the picture, and of the crop.
        before: errors in the picture before.
        score: before.
        given: errors of earlier parts in the same picture.
        person: whether it is the same person. Bodies and clothes have their own errors, and all cameras see the same ones.
    """

    pose: float = 1.0
    view: float = 1.0
    hidden: float = 1.0
    speed: float = 0.5
    size: float = 0.5
    before: float = 2.0
    score: float = 0.5
    given: float = 0.5
    person: float = 1.0

    def scaled(self, group: str, factor: float) -> "Weights":
        """The same with one group's weight multiplied."""
        return Weights(**(asdict(self) | {group: factor * asdict(self)[group]}))


def of_picture(part: Part, weights: Weights, context: Context, errors: Errors, person: Float) -> Float32:
    """(n, D) of the situation, and of the errors of earlier parts, in one picture.

    Args:
        part: of the body.
        weights: of the groups.
        context: of n situations.
        errors: of which those of earlier parts are read.
        person: (n, P) of P persons one for whose picture it is, zero for the others.
    """
    joints, near = list(part.joints), list(part.joints + part.beside)
    groups = [
        _group(context.pose[:, near], _POSE, weights.pose),
        _group(context.view, _VIEW, weights.view),
        _group(context.hidden[:, joints], _HIDDEN, weights.hidden),
        _group(context.speed[:, joints], _SPEED, weights.speed),
        _group(np.stack((context.size, context.extent), axis=-1), _SIZE, weights.size),
        (person * np.sqrt(weights.person / 2)).astype(np.float32),
    ]
    if part.given:
        given = list(part.given)
        groups.append(_group(np.arcsinh(errors.residual[:, given] / _SMALL_ERROR), 1.0, weights.given))
    return np.concatenate(groups, axis=1)


def error_factors(part: Part, weights: Weights) -> Float:
    """(2,) what the part's own errors before are multiplied with to be compared: residuals and scores."""
    count = len(part.joints)
    return np.sqrt((weights.before / (2 * count), weights.score / count / _SCORE**2))


def _group(values: Float, scale: float, weight: float) -> Float32:
    flat = values.reshape(len(values), -1)
    scaled: Float32 = (flat * (np.sqrt(weight / flat.shape[1]) / scale)).astype(np.float32)
    return scaled
