"""The score falls with faults and says nothing where too little was seen."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from models.arrays import Float
from models.messages.feedback import Colour, Judgement, MeasureResult, Verdict
from models.skeleton import coco
from models.teaching.schema import Teaching, decode_teaching
from services.evaluation.alignment import align
from services.evaluation.attempt import FoundAttempt
from services.evaluation.deviation import Deviation, deviate
from services.evaluation.score import Score, score
from services.evaluation.track import Track
from tests.bench.teaching.noise import as_fused
from tests.taught import performance, shipped
from tests.teaching_texts import GOOD, VOCABULARY

TEACHING = decode_teaching(GOOD.encode(), "squat.toml", VOCABULARY)


def deviation(distance: Float | float, colour: Colour = Colour.GREEN, sigma: float = 0.1) -> Deviation:
    apart = np.broadcast_to(distance, (30, 17)).astype(float)
    return Deviation(apart, np.full((30, 17), sigma), np.full((30, 17), colour, np.uint8))


def scored(
    first: float | None,
    second: float | None,
    near: Deviation | None = None,
    sigma: float = 0.1,
    verdicts: tuple[Verdict, ...] = (),
    teaching: Teaching = TEACHING,
) -> Score | None:
    judged = [
        Judgement(fault.name, severity, None if severity is None else sigma)
        for fault, severity in zip(teaching.fault, (first, second), strict=True)
    ]
    measures = [MeasureResult(f"number_{place}", 1.0, 0.1, "deg", verdict) for place, verdict in enumerate(verdicts)]
    return score(teaching, judged, near, measures)


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
    assert score(TEACHING, [Judgement(fault.name, None, None) for fault in TEACHING.fault], deviation(0.2), ()) is None


def test_what_nobody_judged_makes_it_less_sure() -> None:
    whole, part = scored(0.0, 0.0, deviation(0.2)), scored(0.0, None, deviation(0.2))
    assert whole is not None
    assert part is not None
    assert part.sigma > whole.sigma + 10


def test_uncertain_severities_make_an_uncertain_score() -> None:
    sure, unsure = (scored(0.8, 0.8, deviation(0.2), sigma=sigma) for sigma in (0.05, 0.4))
    assert sure is not None
    assert unsure is not None
    assert unsure.sigma > 4 * sure.sigma > 0


def sigma_of(near: Deviation | None) -> float:
    """Of a score whose faults are known exactly."""
    found = scored(0.0, 0.0, near, sigma=0.0)
    assert found is not None
    return found.sigma


def test_joints_whose_distance_is_not_sure_make_the_score_less_sure() -> None:
    """Three tenths of it are made of them, and their errors were in no sigma."""
    sure, unsure = (sigma_of(deviation(1.5, Colour.YELLOW, sigma)) for sigma in (0.05, 0.5))
    assert unsure > 4 * sure > 0
    assert sigma_of(deviation(0.2, sigma=0.05)) == pytest.approx(0, abs=1e-6), "what is surely within the limit"


def test_the_fewer_joints_are_judged_the_less_sure_is_the_score() -> None:
    """Too few to count were said to be as sure as all."""
    grey = []
    for hidden in (0, 6, 11, 13, 17):
        near = deviation(0.2)
        near.colours[:, :hidden] = Colour.GREY
        grey.append(sigma_of(near))
    assert grey == sorted(grey)
    assert grey[0] < grey[1] < grey[2] < grey[3]
    assert sigma_of(None) == grey[-1]


@pytest.mark.parametrize("action", ["squat", "badminton_clear", "star_jump", "basketball_shot"])
def test_errors_as_fusion_has_them_move_the_score_no_further_than_its_sigma_says(action: str) -> None:
    """Of somebody else than the standard, with limbs where they should not be; nor is the sigma much larger."""
    track, attempt = performance(action, number=1)
    joints = track.joints_m.copy()
    joints[:, [coco.INDEX[f"{side}_{part}"] for side in ("left", "right") for part in ("elbow", "wrist", "knee")]] += 0.08
    random = np.random.default_rng(3)
    off, told = [], []
    true = of_colours(replace(track, joints_m=joints), attempt)
    for _ in range(12):
        seen = of_colours(as_fused(joints, track.frame_s, random), attempt)
        off.append(seen.points - true.points)
        told.append(seen.sigma)
    usual = float(np.sqrt(np.mean(np.square(off))))
    assert usual / 2 < np.mean(told) < usual + 3.0


def of_colours(track: Track, attempt: FoundAttempt) -> Score:
    """The score of an attempt without a fault."""
    teaching, standard = shipped().teachings[attempt.action], shipped().standards[attempt.action]
    aligned = align(track, standard)
    assert aligned is not None
    judged = [Judgement(one.name, 0.0, 0.0) for one in teaching.fault]
    found = score(teaching, judged, deviate(aligned, track, standard, teaching.tolerance), ())
    assert found is not None
    return found


def test_grey_joints_have_no_part_in_it() -> None:
    assert points(0.0, 0.0, deviation(5.0, Colour.GREY)) == pytest.approx(points(0.0, 0.0))
    assert points(0.0, 0.0, deviation(np.nan, Colour.GREY)) == pytest.approx(points(0.0, 0.0))


def test_who_is_hidden_does_not_score_better() -> None:
    """What nobody judged counted as if it had been done well: 22 points where everything that was seen was wrong."""
    assert points(2.0, None) == pytest.approx(0)
    assert points(0.35, None) == pytest.approx(points(0.35, 0.35))
    assert points(0.0, None) == pytest.approx(100)


def test_the_opposite_of_a_fault_costs_where_it_is_a_mistake_too() -> None:
    """Arms that came before the legs had a hundred points, and were told that this was no praise."""
    both_ways = structs.replace(TEACHING, fault=(structs.replace(TEACHING.fault[0], either_way=True), TEACHING.fault[1]))
    one_way, opposite, fault = (
        scored(severity, 0.0, deviation(0.2), teaching=taught)
        for taught, severity in ((TEACHING, -0.9), (both_ways, -0.9), (both_ways, 0.9))
    )
    assert one_way is not None
    assert opposite is not None
    assert one_way.points == pytest.approx(100)
    assert fault is not None
    assert (opposite.points, opposite.sigma) == pytest.approx((fault.points, fault.sigma))
    assert opposite.points < 80


@pytest.mark.parametrize(
    ("verdicts", "most"), [(("good", "fair"), 95), (("poor", "fair", "unknown"), 85), (("good", "unknown"), 100)]
)
def test_no_hundred_stands_beside_a_number_that_is_not_good(verdicts: tuple[Verdict, ...], most: float) -> None:
    best, bad = (scored(severity, severity, deviation(0.2), verdicts=verdicts) for severity in (0.0, 1.0))
    assert best is not None
    assert bad is not None
    assert best.points == pytest.approx(most)
    assert bad.points == pytest.approx(points(1.0, 1.0, deviation(0.2)))
