"""The score falls with faults and says nothing where too little was seen."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Float
from models.messages.feedback import Colour, Judgement
from models.teaching.schema import decode_teaching
from services.evaluation.deviation import Deviation
from services.evaluation.score import Score, score
from tests.teaching_texts import GOOD, VOCABULARY

TEACHING = decode_teaching(GOOD.encode(), "squat.toml", VOCABULARY)


def deviation(distance: Float | float, colour: Colour = Colour.GREEN) -> Deviation:
    apart = np.broadcast_to(distance, (30, 17)).astype(float)
    return Deviation(apart, np.full((30, 17), 0.1), np.full((30, 17), colour, np.uint8))


def scored(first: float | None, second: float | None, near: Deviation | None = None, sigma: float = 0.1) -> Score | None:
    judged = [
        Judgement(fault.name, severity, None if severity is None else sigma)
        for fault, severity in zip(TEACHING.fault, (first, second), strict=True)
    ]
    return score(TEACHING, judged, near)


def points(first: float | None, second: float | None, near: Deviation | None = None) -> float:
    found = scored(first, second, near)
    assert found is not None
    return found.points


def test_without_a_fault_and_near_the_standard_it_is_a_hundred() -> None:
    assert points(0.0, 0.0, deviation(0.2)) == pytest.approx(100)
    assert points(-0.5, 0.1, deviation(0.2)) == pytest.approx(100)


def test_with_everything_wrong_it_is_nothing() -> None:
    assert points(2.0, 2.0, deviation(5.0, Colour.RED)) == pytest.approx(0)


def test_the_more_important_fault_costs_more() -> None:
    assert points(1.0, 0.0) < points(0.0, 1.0) < 100


def test_joints_far_from_the_standard_cost() -> None:
    assert points(0.0, 0.0, deviation(1.5, Colour.YELLOW)) == pytest.approx(85)


@given(st.floats(-1, 2.5), st.floats(-1, 2.5), st.floats(-1, 2.5))
def test_it_never_grows_with_a_fault(one: float, other: float, second: float) -> None:
    slighter, worse = min(one, other), max(one, other)
    assert 0 <= points(worse, second) <= points(slighter, second) <= 100


def test_too_little_is_no_score() -> None:
    assert scored(None, None) is None
    assert scored(None, 0.0) is None
    assert score(TEACHING, [Judgement(fault.name, None, None) for fault in TEACHING.fault], deviation(0.2)) is None


def test_what_nobody_judged_makes_it_less_sure() -> None:
    whole, part = scored(0.0, 0.0), scored(0.0, None)
    assert whole is not None
    assert part is not None
    assert part.sigma > whole.sigma + 10


def test_uncertain_severities_make_an_uncertain_score() -> None:
    sure, unsure = scored(0.8, 0.8, sigma=0.05), scored(0.8, 0.8, sigma=0.4)
    assert sure is not None
    assert unsure is not None
    assert unsure.sigma > 4 * sure.sigma > 0


def test_grey_joints_have_no_part_in_it() -> None:
    assert points(0.0, 0.0, deviation(5.0, Colour.GREY)) == pytest.approx(points(0.0, 0.0))
    assert points(0.0, 0.0, deviation(np.nan, Colour.GREY)) == pytest.approx(points(0.0, 0.0))


def test_who_is_hidden_does_not_score_better() -> None:
    """What nobody judged counted as if it had been done well: 22 points where everything that was seen was wrong."""
    assert points(2.0, None) == pytest.approx(0)
    assert points(0.35, None) == pytest.approx(points(0.35, 0.35))
    assert points(0.0, None) == pytest.approx(100)
