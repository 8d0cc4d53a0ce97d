"""The shipped body models, read once."""

from functools import cache
from importlib.resources import files

import numpy as np

import models.body
from models.arrays import Float
from models.body import LARGE, SMALL
from models.body.file import decode
from models.body.model import BodyModel
from models.body.prior import SEXES, ShapePrior

__all__ = ["LARGE", "SMALL", "body_bytes", "body_model", "prior_of", "someone"]


def body_bytes(name: str = SMALL) -> bytes:
    return files(models.body).joinpath(name).read_bytes()


@cache
def body_model(name: str = SMALL) -> BodyModel:
    return decode(body_bytes(name), name)


def prior_of(model: BodyModel) -> ShapePrior:
    assert model.prior is not None
    return model.prior


def someone(model: BodyModel, seed: int) -> Float:
    """The shape of a random person of 5 to 65 years."""
    generator = np.random.default_rng(seed)
    sex = SEXES[int(generator.integers(2))]
    return prior_of(model).likely(float(generator.uniform(5, 65)), sex).sample(generator)
