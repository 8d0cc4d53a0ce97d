"""Figures of an exported body: how well it agrees with the full mesh, and what usual people measure."""

from typing import Any

import numpy as np

from models.arrays import Float
from models.body.model import BodyModel
from models.body.pose import Pose
from models.body.prior import SEXES
from models.skeleton import smpl

_PEOPLE, _POSES = 40, 5
_SEED = 7
_TURN_RAD = 0.5


def against(model: BodyModel, whole: BodyModel, arrays: dict[str, np.ndarray]) -> dict[str, Any]:
    """Landmarks in random shapes and poses against the full mesh's, and the joints as J_regressor has them."""
    landmarks, joints = [], []
    generator = np.random.default_rng(_SEED)
    for _ in range(_PEOPLE):
        shape = _anyone(model, generator)
        body, true = model.shaped(shape), whole.shaped(shape)
        joints.append(np.linalg.norm(arrays["J_regressor"] @ body.rest_vertices_m - body.rest_joints_m, axis=1))
        for _ in range(_POSES):
            pose = Pose(np.zeros(3), generator.normal(0.0, _TURN_RAD, (smpl.COUNT, 3)))
            landmarks.append(np.linalg.norm(body.coco_m(pose) - true.coco_m(pose), axis=1))
    return {
        "vertices": len(model.skin.vertices),
        "faces": len(model.faces),
        "landmark_error_mean_mm": _millimetres(np.mean(landmarks)),
        "landmark_error_max_mm": _millimetres(np.max(landmarks)),
        "joint_regressor_error_mean_mm": _millimetres(np.mean(joints)),
        "joint_regressor_error_max_mm": _millimetres(np.max(joints)),
        "largest_regressor_weight": round(float(np.abs(arrays["coco_regressor"]).max()), 3),
        "largest_joint_regressor_weight": round(float(np.abs(arrays["J_regressor"]).max()), 3),
    }


def usual_people(model: BodyModel) -> dict[str, dict[str, float]]:
    """Stature and mass of the mean shape of each age and sex of the prior."""
    if model.prior is None:
        raise ValueError("the model has no prior")
    out = {}
    for sex in SEXES:
        for age in model.prior.ages_years:
            body = model.shaped(model.prior.likely(float(age), sex).mean)
            out[f"{sex} {age:g}"] = {"stature_m": round(body.stature_m, 3), "mass_kg": round(body.mass_kg, 1)}
    return out


def _anyone(model: BodyModel, generator: np.random.Generator) -> Float:
    if model.prior is None:
        raise ValueError("the model has no prior")
    age = generator.uniform(model.prior.ages_years[0], model.prior.ages_years[-1])
    return model.prior.likely(float(age), SEXES[generator.integers(2)]).sample(generator)


def _millimetres(value: np.floating[Any]) -> float:
    return round(1000 * float(value), 3)
