"""Subjects for tests of motions: people of the shipped body, by age and sex; and, for laws, anybody who performs anyhow."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from hypothesis import strategies as st

from models.body.prior import SEXES, Sex
from models.motions.actions.library import ACTIONS
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


@dataclass(frozen=True)
class Somebody:
    """A random person, by what makes him: Hypothesis prints what it draws, and a `Subject` is tens of kilobytes of numbers.

    Its warning of that, an error here, would break off the replay of what failed, and show as `FlakyStrategyDefinition`.
    """

    age_years: float
    sex: Sex
    seed: int

    def subject(self) -> Subject:
        return some_pupil(self.age_years, self.sex, self.seed)


def people(oldest_years: float = 60.0) -> st.SearchStrategy[Somebody]:
    """Pupils and grown-ups."""
    ages = st.one_of(st.floats(6, 16), st.floats(18, oldest_years))
    return st.builds(Somebody, ages, st.sampled_from(SEXES), st.integers(0, 1000))


@st.composite
def performances(draw: st.DrawFn, action: str, most_faults: int) -> Performance:
    """Of an action, in every way that it may be performed, with so many faults at once or fewer."""
    names = [fault.name for fault in ACTIONS[action].faults]
    return Performance(
        action,
        handed=draw(st.sampled_from(("right", "left"))),
        tempo=draw(st.floats(*TEMPO)),
        amplitude=draw(st.floats(*AMPLITUDE)),
        skill=draw(st.sampled_from((0.0, 0.5, 1.0))),
        faults=draw(st.dictionaries(st.sampled_from(names), st.floats(*SEVERITY), max_size=most_faults)),
        seed=draw(st.integers(0, 1000)),
    )
