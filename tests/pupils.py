"""Subjects for tests of motions: people of the shipped body, by age and sex."""

from functools import cache

import numpy as np

from models.body.prior import Sex
from models.motions.subject import Subject
from tests.bodies import body_model, prior_of


@cache
def pupil(age_years: float = 11.0, sex: Sex = "female") -> Subject:
    """The mean person of this age."""
    likely = prior_of(body_model()).likely(age_years, sex)
    return Subject(body_model().shaped(likely.mean), age_years, sex)


def some_pupil(age_years: float, sex: Sex, seed: int) -> Subject:
    """A random person of this age."""
    likely = prior_of(body_model()).likely(age_years, sex)
    return Subject(body_model().shaped(likely.sample(np.random.default_rng(seed))), age_years, sex)
