"""The shape space: principal components of people of all ages, and which of them are likely at which age."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from models.arrays import Float
from models.body.build import people
from models.skeleton import smpl

COEFFICIENTS = 16
_TYPICAL = (("male", 9), ("female", 9), ("male", 35), ("female", 35))
_LEAST_VARIANCE = 1e-4
"""Added to each coefficient's variance, in standard deviations squared, so that no shape is impossible."""


@dataclass(frozen=True)
class ShapeSpace:
    """What the body's files hold of the full mesh.

    Attributes:
        template: (V, 3) mean of all people in the T-pose, metres.
        shapedirs: (V, 3, S) principal components, each times its standard deviation.
        joints: (24, 3) and
        joint_shapedirs: (24, 3, S) of the joints.
        prior_mean: (2, A, S) and
        prior_cov: (2, A, S, S) of the coefficients by sex and age.
        typical: (B, V, 3) mean bodies of children and adults.
        figures: what was measured.
    """

    template: Float
    shapedirs: Float
    joints: Float
    joint_shapedirs: Float
    prior_mean: Float
    prior_cov: Float
    typical: Float
    figures: dict[str, Any]


def fit(source: people.Source, generator: np.random.Generator, say: Callable[[str], None]) -> ShapeSpace:
    """Draw people, fit the components to one half of them and measure on the other."""
    vertices, joints = [], []
    for sex in people.SEXES:
        for age in people.AGES_YEARS:
            bodies, skeletons = people.in_t_pose(source, people.phenotypes(source, sex, age, generator))
            vertices.append(bodies.astype(np.float32))
            joints.append(skeletons)
            say(f"{sex}, {age} years: {len(bodies)} people, {np.ptp(bodies[..., 2], axis=1).mean():.3f} m on average")
    bodies, skeletons = np.concatenate(vertices), np.concatenate(joints)
    count = bodies.shape[1]
    flat = bodies.reshape(len(bodies), -1)
    learnt, held_out = flat[::2], flat[1::2]
    mean = learnt.mean(0, dtype=np.float64)
    variances, components = _principal(learnt - mean.astype(np.float32))
    sigmas = np.sqrt(variances)
    coefficients = ((flat - mean.astype(np.float32)) @ (components / sigmas).astype(np.float32)).astype(np.float64)
    design = np.column_stack((np.ones(len(coefficients)), coefficients))
    fitted = np.linalg.lstsq(design[::2], skeletons[::2].reshape(len(design[::2]), -1), rcond=None)[0]
    joints_left = skeletons[1::2].reshape(len(design[1::2]), -1) - design[1::2] @ fitted
    by_age = coefficients.reshape(len(people.SEXES), len(people.AGES_YEARS), people.PEOPLE_PER_AGE, COEFFICIENTS)
    centred = by_age - by_age.mean(2, keepdims=True)
    missed = held_out - (mean + coefficients[1::2] @ (components * sigmas).T)
    typical = [
        vertices[people.SEXES.index(sex) * len(people.AGES_YEARS) + people.AGES_YEARS.index(age)].mean(0) for sex, age in _TYPICAL
    ]
    directions = (components * sigmas).reshape(count, 3, COEFFICIENTS)
    return ShapeSpace(
        template=_alike(mean.reshape(count, 3, 1), source.mirror)[..., 0],
        shapedirs=_alike(directions, source.mirror),
        joints=_alike(fitted[0].reshape(-1, 3, 1), np.array(smpl.MIRROR))[..., 0],
        joint_shapedirs=_alike(fitted[1:].T.reshape(-1, 3, COEFFICIENTS), np.array(smpl.MIRROR)),
        prior_mean=by_age.mean(2),
        prior_cov=np.einsum("xans,xant->xast", centred, centred) / (people.PEOPLE_PER_AGE - 1)
        + _LEAST_VARIANCE * np.eye(COEFFICIENTS),
        typical=np.stack(typical).astype(np.float64),
        figures={
            "people": len(flat),
            "variance_explained_percent": _round(100 * (1 - np.var(missed) / np.var(held_out - mean))),
            "vertex_error_mean_mm": _round(1000 * np.linalg.norm(missed.reshape(-1, 3), axis=1).mean()),
            "joint_error_mean_mm": _round(1000 * np.linalg.norm(joints_left.reshape(-1, 3), axis=1).mean()),
            "joint_error_max_mm": _round(1000 * np.linalg.norm(joints_left.reshape(-1, 3), axis=1).max()),
        },
    )


def _alike(points: Float, mirror: np.ndarray) -> Float:
    """(N, 3, S) the same with both sides exactly alike; the people are, their sums in single precision nearly."""
    return np.asarray((points + points[mirror] * np.array((1.0, -1.0, 1.0))[:, None]) / 2)


def _principal(centred: np.ndarray) -> tuple[Float, Float]:
    """(S,) variances, descending, and (D, S) components, whose largest entry is positive."""
    gram = (centred @ centred.T).astype(np.float64) / len(centred)
    values, vectors = np.linalg.eigh(gram)
    order = np.argsort(-values)[:COEFFICIENTS]
    components = centred.T.astype(np.float64) @ (vectors[:, order] / np.sqrt(values[order] * len(centred)))
    components /= np.linalg.norm(components, axis=0)
    signs = np.sign(components[np.abs(components).argmax(0), np.arange(COEFFICIENTS)])
    return values[order], components * signs


def _round(value: float) -> float:
    return round(float(value), 3)
