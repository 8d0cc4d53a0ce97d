"""Who performs: a body of one shape, and the age that its joints' limits and segment masses go by."""

from dataclasses import dataclass

from models.body.model import Body
from models.body.prior import Sex


@dataclass(frozen=True, eq=False)
class Subject:
    """A pupil.

    Attributes:
        body: his shape.
        age_years: for joint limits and segment masses.
        sex: for segment masses.
    """

    body: Body
    age_years: float
    sex: Sex
