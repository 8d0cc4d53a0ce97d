"""Subjects for tests of motions: people of the shipped body, by age and sex; and, for laws, anybody who performs anyhow."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from hypothesis import strategies as st

from models.body.prior import SEXES, Sex
from models.motions.actions.library import ACTIONS
from models.motions.motion import Handed
from models.motions.performance import AMPLITUDE, SEVERITY, TEMPO, Performance
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


def subjects(oldest_years: float = 60.0) -> st.SearchStrategy[Subject]:
    """Pupils and grown-ups."""
    ages = st.one_of(st.floats(6, 16), st.floats(18, oldest_years))
    return st.builds(some_pupil, ages, st.sampled_from(SEXES), st.integers(0, 1000))


@dataclass(frozen=True)
class Way:
    """How an action is performed, whichever it is: a fault is named by its number among the action's, counted round."""

    handed: Handed
    tempo: float
    amplitude: float
    skill: float
    faults: dict[int, float]
    seed: int

    def of(self, action: str) -> Performance:
        names = [fault.name for fault in ACTIONS[action].faults]
        faults = {names[number % len(names)]: severity for number, severity in self.faults.items()}
        return Performance(action, self.handed, self.tempo, self.amplitude, self.skill, faults, self.seed)


def ways(most_faults: int) -> st.SearchStrategy[Way]:
    """Every way to perform, with so many faults at once or fewer.

    Drawn with the subject before a test begins: Hypothesis replays what failed from the arguments, and calls a test that draws
    more by `st.data` on its way flaky, which hides what failed.
    """
    return st.builds(
        Way,
        handed=st.sampled_from(("right", "left")),
        tempo=st.floats(*TEMPO),
        amplitude=st.floats(*AMPLITUDE),
        skill=st.sampled_from((0.0, 0.5, 1.0)),
        faults=st.dictionaries(st.integers(0, 11), st.floats(*SEVERITY), max_size=most_faults),
        seed=st.integers(0, 1000),
    )
