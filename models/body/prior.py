"""Which shapes are likely: mean and covariance of the shape coefficients by age and sex.

The people from whom the tables are made are Anny's, whose distribution by age is fitted to the WHO's figures; what was measured
on them stands in `data/figures.json`.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from models.arrays import Float

Sex = Literal["male", "female"]
SEXES: tuple[Sex, ...] = get_args(Sex)


@dataclass(frozen=True, eq=False)
class Likely:
    """A normal distribution of shapes.

    Attributes:
        mean: (S,).
        covariance: (S, S), positive definite.
    """

    mean: Float
    covariance: Float

    def sample(self, generator: np.random.Generator) -> Float:
        """(S,) a shape drawn from it."""
        return self.mean + np.linalg.cholesky(self.covariance) @ generator.standard_normal(len(self.mean))

    def distance(self, shape: Float) -> float:
        """Mahalanobis distance of a shape: 1 is usual, far beyond sqrt(S) is nobody."""
        difference = shape - self.mean
        return float(np.sqrt(difference @ np.linalg.solve(self.covariance, difference)))

    def given(self, direction: Float, value: float, sigma: float) -> "Likely":
        """What is likely once `direction @ shape` has been measured as `value` with standard deviation `sigma`."""
        spread = self.covariance @ direction
        gain = spread / (direction @ spread + sigma**2)
        covariance = self.covariance - np.outer(gain, spread)
        return Likely(self.mean + gain * (value - direction @ self.mean), (covariance + covariance.T) / 2)


@dataclass(frozen=True, eq=False)
class ShapePrior:
    """The tables.

    Attributes:
        ages_years: (A,) ascending.
        means: (2, A, S) for the sexes in the order of `SEXES`.
        covariances: (2, A, S, S).
        stature_direction: (S,) metres of stature by each coefficient.
        stature_of_mean_m: of the mean shape.
    """

    ages_years: Float
    means: Float
    covariances: Float
    stature_direction: Float
    stature_of_mean_m: float

    def likely(self, age_years: float, sex: Sex | None = None, stature_m: float | None = None) -> Likely:
        """Shapes of people of this age.

        Args:
            age_years: between the table's first and last age.
            sex: None if it is not known: the mixture of both, as one normal distribution.
            stature_m: standing height if it was measured (to `STATURE_SIGMA_M`).

        Raises:
            ValueError: the age is outside the table.
        """
        if not self.ages_years[0] <= age_years <= self.ages_years[-1]:
            raise ValueError(f"age_years is {age_years:g}, known are {self.ages_years[0]:g} to {self.ages_years[-1]:g}")
        means, covariances = (self._at(age_years, table) for table in (self.means, self.covariances))
        if sex is None:
            apart = (means[0] - means[1]) / 2
            likely = Likely(means.mean(0), covariances.mean(0) + np.outer(apart, apart))
        else:
            place = SEXES.index(sex)
            likely = Likely(means[place], covariances[place])
        if stature_m is None:
            return likely
        return likely.given(self.stature_direction, stature_m - self.stature_of_mean_m, STATURE_SIGMA_M)

    def _at(self, age_years: float, table: Float) -> Float:
        """Linear between the table's ages; a mean of covariances is a covariance."""
        above = min(int(np.searchsorted(self.ages_years, age_years, side="right")), len(self.ages_years) - 1)
        low, high = self.ages_years[above - 1], self.ages_years[above]
        share = (age_years - low) / (high - low)
        return np.asarray((1 - share) * table[:, above - 1] + share * table[:, above])


STATURE_SIGMA_M = 0.005
"""How well a school measures a pupil's height."""
