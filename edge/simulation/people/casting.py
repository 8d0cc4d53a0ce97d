"""Who is on camera: pupils of 6 to 16 years and grown-ups, drawn by seed, for development and for tests apart.

| | development | test |
|---|---|---|
| body | on the model: drawn from its prior | off the model: drawn, then altered (`edge.simulation.people.off_model`) |
| clothes | colours of twelve hues | colours of the twelve hues between those |
| random numbers | streams of "development" | streams of "test" |

So nobody who is measured on was ever developed on, nor does anybody wear the same colour, but for white and greys.
"""

import colorsys
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np

import models.body
from edge.simulation.people.clothing import PRINTS, Footwear, Legwear, Shirt
from edge.simulation.people.hair import Style
from edge.simulation.people.look import Look
from edge.simulation.people.off_model import altered, draw_alteration
from edge.simulation.people.skin import Colour
from edge.simulation.split import SPLITS, Split, generator
from models.arrays import Float
from models.body import LARGE
from models.body.file import coco_regressor, decode
from models.body.model import BodyModel
from models.body.prior import SEXES, Sex
from models.motions.subject import Subject

PUPIL_YEARS: Final = (6.0, 16.0)
ADULT_YEARS: Final = (19.0, 58.0)
_ADULT_SHARE: Final = 0.15
_HUES: Final = 12
_USUAL_DISTANCE: Final = 3.4
"""Mahalanobis distance within which a drawn shape is kept, less than the usual one of 16 coefficients: nobody of a rare build."""

_TONES: Final = np.array(
    ((0.94, 0.78, 0.69), (0.90, 0.71, 0.60), (0.83, 0.63, 0.50), (0.71, 0.51, 0.38), (0.56, 0.39, 0.29), (0.42, 0.29, 0.22))
)
_DARK_HAIR: Final = ((0.09, 0.07, 0.06), (0.14, 0.10, 0.08))
_LIGHT_HAIR: Final = (
    (0.09, 0.07, 0.06),
    (0.22, 0.15, 0.10),
    (0.34, 0.23, 0.14),
    (0.47, 0.34, 0.19),
    (0.66, 0.52, 0.32),
    (0.48, 0.24, 0.12),
)
_GREY_HAIR: Final = (0.52, 0.51, 0.50)
_IRIS: Final = ((0.24, 0.15, 0.09), (0.33, 0.22, 0.12), (0.35, 0.42, 0.30), (0.38, 0.48, 0.56))
_GREYS: Final = (0.10, 0.16, 0.30, 0.55, 0.93)
_STYLES: Final[dict[Sex, tuple[tuple[Style, float], ...]]] = {
    "male": (("cropped", 0.28), ("short", 0.44), ("fringe", 0.24), ("bob", 0.04)),
    "female": (("pony_tail", 0.42), ("bob", 0.20), ("bun", 0.16), ("fringe", 0.08), ("scarf", 0.14)),
}


@dataclass(frozen=True, eq=False)
class Member:
    """One of the cast.

    Attributes:
        name: split and seed.
        subject: body, age, sex.
        look: skin, hair, clothes.
    """

    name: str
    subject: Subject
    look: Look

    def in_bib(self, colour: Colour, number: int) -> "Member":
        """In a training bib; two pupils may wear the same."""
        return replace(self, look=replace(self.look, bib=colour, number=number))


def cast(split: Split, seed: int, age_years: float | None = None, sex: Sex | None = None) -> Member:
    """One of the cast.

    Args:
        split: for whom; bodies and clothes of the splits differ by construction.
        seed: of the person.
        age_years: 5 to 65, or None to draw: mostly a pupil, sometimes a grown-up.
        sex: None to draw.
    """
    random = generator(split, "cast", seed)
    ages = ADULT_YEARS if random.random() < _ADULT_SHARE else PUPIL_YEARS
    drawn_age, drawn_sex = float(random.uniform(*ages)), SEXES[int(random.integers(len(SEXES)))]
    age, of_sex = age_years if age_years is not None else drawn_age, sex or drawn_sex
    body = body_model().shaped(_shape(age, of_sex, random))
    if split == "test":
        body = altered(body, draw_alteration(split, seed), _regressor())
    return Member(f"{split}-{seed}", Subject(body, age, of_sex), _look(split, seed, age, of_sex))


@cache
def body_model() -> BodyModel:
    """The model with about 6,000 vertices."""
    return decode(_body_bytes(), LARGE)


@cache
def _regressor() -> Float:
    return coco_regressor(_body_bytes(), LARGE)


def _body_bytes() -> bytes:
    return files(models.body).joinpath(LARGE).read_bytes()


def _shape(age_years: float, sex: Sex, random: np.random.Generator) -> Float:
    prior = body_model().prior
    if prior is None:
        raise ValueError("the shipped body has no prior")
    likely = prior.likely(age_years, sex)
    shape = likely.sample(random)
    beyond = likely.distance(shape) / _USUAL_DISTANCE
    return likely.mean + (shape - likely.mean) / max(beyond, 1.0)


def _look(split: Split, seed: int, age_years: float, sex: Sex) -> Look:
    random = generator(split, "look", seed)
    darkness = float(random.beta(1.1, 1.5))
    place = darkness * (len(_TONES) - 1)
    tone = np.array([np.interp(place, np.arange(len(_TONES)), channel) for channel in _TONES.T])
    hairs = _DARK_HAIR if darkness > 0.45 else _LIGHT_HAIR
    hair: Colour = hairs[int(random.integers(len(hairs)))]
    if age_years > 48:
        hair = _GREY_HAIR
    iris = _IRIS[int(random.integers(2 if darkness > 0.4 else len(_IRIS)))]
    styles, shares = zip(*_STYLES[sex], strict=True)
    style = styles[int(random.choice(len(styles), p=shares))]
    cloth = _Colours(split, random)
    shirt_colour = cloth.vivid()
    warm = random.random() < 0.22
    shirt = Shirt(
        colour=shirt_colour,
        trim=shirt_colour if random.random() < 0.5 else cloth.any(),
        sleeve=2.0 if warm else float(random.uniform(0.5, 0.85)),
        ease=float(random.uniform(0.35, 0.75) if warm else random.uniform(0.1, 0.95)),
        length=float(random.uniform(0.2, 1.0)),
        print=PRINTS[int(random.integers(len(PRINTS)))],
        hood=bool(warm and random.random() < 0.6),
    )
    return Look(
        tone=_colour(tone),
        hair=hair,
        style=style,
        scarf=cloth.any(),
        iris=iris,
        shirt=shirt,
        legwear=_legwear(sex, cloth, random),
        footwear=Footwear(
            cloth.any(), _grey(0.93), _grey(0.93 if random.random() < 0.7 else 0.12), float(random.uniform(0.05, 0.6))
        ),
        number=int(random.integers(1, 24)),
        seed=int(random.integers(2**31)),
    )


def _legwear(sex: Sex, cloth: "_Colours", random: np.random.Generator) -> Legwear:
    colour = cloth.calm()
    stripe = _grey(0.93) if random.random() < 0.4 else None
    kind = random.random()
    if sex == "female" and kind < 0.4:
        return Legwear(colour, None, float(random.uniform(1.5, 1.97)), 0.0)
    if kind < 0.65:
        return Legwear(colour, stripe, float(random.uniform(0.45, 0.95)), float(random.uniform(0.3, 0.95)))
    return Legwear(colour, stripe, 1.97, float(random.uniform(0.25, 0.75)))


class _Colours:
    """Colours of cloth, of the hues that a split may use."""

    def __init__(self, split: Split, random: np.random.Generator) -> None:
        self._first = SPLITS.index(split) / len(SPLITS) / _HUES
        self._random = random

    def vivid(self) -> Colour:
        """For shirts: a strong or a light colour, sometimes white or grey."""
        if self._random.random() < 0.25:
            return _grey(_GREYS[int(self._random.integers(2, len(_GREYS)))])
        return self._of(self._random.uniform(0.35, 0.85), self._random.uniform(0.55, 0.95))

    def calm(self) -> Colour:
        """For legwear: dark more often than not."""
        if self._random.random() < 0.5:
            return _grey(_GREYS[int(self._random.integers(len(_GREYS) - 1))])
        return self._of(self._random.uniform(0.4, 0.8), self._random.uniform(0.22, 0.6))

    def any(self) -> Colour:
        """For shoes, trims, scarfs."""
        return self.vivid() if self._random.random() < 0.5 else self.calm()

    def _of(self, saturation: float, value: float) -> Colour:
        hue = self._first + int(self._random.integers(_HUES)) / _HUES
        return colorsys.hsv_to_rgb(hue, float(saturation), float(value))


def _grey(value: float) -> Colour:
    return (value, value, value)


def _colour(values: Float) -> Colour:
    red, green, blue = (float(value) for value in values)
    return (red, green, blue)
