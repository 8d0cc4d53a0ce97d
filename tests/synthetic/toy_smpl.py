"""A small body with every key of an official SMPL file, pose correctives included, in SMPL's own axes."""

from functools import cache
from typing import Any

import numpy as np
from scipy import sparse

from models.body.build.smpl import convert
from models.body.file import POSE_FEATURES, ROOT_PARENT, decode
from models.body.model import BodyModel
from models.skeleton import smpl

VERTICES = 60
COEFFICIENTS = 5


def official_content() -> dict[str, Any]:
    """What an official file's pickle holds."""
    generator = np.random.default_rng(11)
    weights = generator.random((VERTICES, smpl.COUNT)) * (generator.random((VERTICES, smpl.COUNT)) < 0.15)
    weights[np.arange(VERTICES), np.arange(VERTICES) % smpl.COUNT] += 0.5
    regressor = generator.random((smpl.COUNT, VERTICES)) * (generator.random((smpl.COUNT, VERTICES)) < 0.3)
    return {
        "v_template": generator.normal(0, 0.4, (VERTICES, 3)),
        "shapedirs": generator.normal(0, 0.02, (VERTICES, 3, COEFFICIENTS)),
        "posedirs": generator.normal(0, 0.003, (VERTICES, 3, POSE_FEATURES)),
        "weights": weights / weights.sum(1, keepdims=True),
        "J_regressor": sparse.csc_matrix(regressor / regressor.sum(1, keepdims=True)),
        "f": np.stack([(corner + np.arange(VERTICES)) % VERTICES for corner in range(3)], axis=1).astype(np.uint32),
        "kintree_table": np.array([[ROOT_PARENT, *smpl.PARENTS[1:]], list(range(smpl.COUNT))], np.int64),
        "bs_style": "lbs",
        "bs_type": "lrotmin",
    }


@cache
def toy_body() -> BodyModel:
    return decode(convert(official_content(), "toy.pkl"), "toy.npz")
