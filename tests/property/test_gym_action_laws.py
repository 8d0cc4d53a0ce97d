"""Laws of jumps, squat, run, roll and cartwheel: what carries the body neither slides nor sinks, and each fault shows."""

from collections.abc import Mapping
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.body.pose import mirrored
from models.body.prior import SEXES, Sex
from models.motions import mat
from models.motions.figure import figure_of
from models.motions.motion import CONTACTS, RATE_HZ, Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.rolling import trunk_skin
from models.motions.subject import Subject
from models.skeleton import smpl
from tests.action_measures import Seen
from tests.gym_measures import MEASURES, jump_distance_m
from tests.motion_laws import Measured, assert_lawful, intervals, measured
from tests.pupils import Somebody, people, performances, pupil

STANDING = ("squat", "star_jump", "long_jump")
"""Feet and flight only, on the floor: the laws of all such actions hold."""
FLOOR = ("forward_roll", "cartwheel")
HANDS = ("left_hand", "right_hand")


def ground_m(x_m: Float, on_mat: bool) -> Float:
    """Height of the floor or the mat."""
    return np.where(on_mat & (x_m > mat.FROM_M) & (x_m < mat.FROM_M + mat.LENGTH_M), mat.HEIGHT_M, 0.0)


def assert_borne(motion: Motion, subject: Subject, found: Measured, on_mat: bool, sinks_m: float, every: int = 6) -> None:
    """Skin sinks no deeper than told; feet and hands that bear touch the ground, and hands stay where they are."""
    skin = subject.body.model.skin
    carrier = skin.joints[np.arange(len(skin.joints)), skin.weights.argmax(1)]
    ends = {
        "left_foot": ("left_ankle", "left_foot"),
        "right_foot": ("right_ankle", "right_foot"),
        "left_hand": ("left_wrist", "left_hand"),
        "right_hand": ("right_wrist", "right_hand"),
    }
    parts = {name: np.isin(carrier, [smpl.INDEX[joint] for joint in joints]) for name, joints in ends.items()}
    for number in range(0, len(motion.translations_m), every):
        places = subject.body.vertices_m(motion.pose(number))
        heights = places[:, 2] - ground_m(places[:, 0], on_mat)
        assert heights.min() > -sinks_m, (number / RATE_HZ, heights.min(), smpl.NAMES[carrier[heights.argmin()]])
        for contact, name in enumerate(CONTACTS[:4]):
            if motion.contacts[number, contact]:
                assert heights[parts[name]].min() < 0.008, (number / RATE_HZ, name)
    seen = Seen(motion, subject)
    for contact, name in enumerate(CONTACTS):
        if name in HANDS:
            for first, last in intervals(motion.contacts[:, contact]):
                wrist = seen.joint(name.replace("hand", "wrist"))[first:last, :2]
                assert np.linalg.norm(wrist - np.median(wrist, axis=0), axis=1).max() < 0.008, name
    assert found.slide_mm <= 2.0, found
    assert found.beyond_limit_deg <= 4.0, found
    assert max(found.from_stand_deg, found.to_stand_deg) <= 0.1, found
    assert max(found.start_speed_m_s, found.end_speed_m_s) <= 0.01, found


@pytest.mark.parametrize(
    "action", [action if action == "squat" else pytest.param(action, marks=pytest.mark.slow) for action in STANDING]
)
def test_feet_stand_and_bodies_fly(action: str) -> None:
    subject = pupil(10, "female")
    assert_lawful(perform(Performance(action), subject), subject, every=12)


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.timeout(900)
@pytest.mark.parametrize("action", [*STANDING, "run"])
@given(data=st.data(), who=people(oldest_years=50))
@settings(max_examples=12)
def test_feet_stand_and_bodies_fly_for_everybody(action: str, data: st.DataObject, who: Somebody) -> None:
    subject = who.subject()
    motion = perform(data.draw(performances(action, most_faults=1)), subject)
    assert_lawful(motion, subject, every=8, sinks_mm=6.0 if action == "run" else 3.0)


@pytest.mark.slow
@pytest.mark.parametrize("action", FLOOR)
@pytest.mark.parametrize(("age", "sex"), [(7, "male"), (10, "female"), (15, "male"), (30, "female")])
def test_hands_and_feet_neither_slide_nor_sink_on_floor_and_mat(action: str, age: float, sex: Sex) -> None:
    subject = pupil(age, sex)
    motion = perform(Performance(action), subject)
    assert_borne(
        motion, subject, measured(motion, subject, every=1000), action == "forward_roll", sinks_m=0.010 if age < 18 else 0.015
    )


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.timeout(900)
@pytest.mark.parametrize("action", FLOOR)
@given(data=st.data(), who=people(oldest_years=50))
@settings(max_examples=8)
def test_hands_and_feet_neither_slide_nor_sink_for_everybody(action: str, data: st.DataObject, who: Somebody) -> None:
    subject = who.subject()
    motion = perform(data.draw(performances(action, most_faults=1)), subject)
    assert_borne(motion, subject, measured(motion, subject, every=1000), action == "forward_roll", sinks_m=0.025, every=12)


ONCE_BROKEN = {
    "elbows went into the mat": (
        Somebody(18.0, "female", 754),
        Performance("forward_roll", tempo=1.22, amplitude=1.12, faults={"legs_open": 0.8}, seed=574),
    ),
    "shoulders turned 50 degrees too far": (
        Somebody(16.0, "female", 484),
        Performance("forward_roll", tempo=0.7, amplitude=1.11, faults={"legs_open": 1.3}, seed=426),
    ),
    "a hand that bore was lifted by its next turn": (
        Somebody(50.0, "male", 198),
        Performance("forward_roll", tempo=0.94, faults={"hands_to_get_up": 1.9}, seed=535),
    ),
    "landed at the height of a mat that ends before": (
        Somebody(40.1, "male", 83),
        Performance("forward_roll", tempo=1.4, amplitude=0.8, skill=0.0, faults={"head_not_tucked": 2.0}, seed=870),
    ),
    "hips bent too far to get up": (
        Somebody(37.2, "female", 235),
        Performance("forward_roll", "left", tempo=1.32, amplitude=0.8, skill=0.0, seed=494),
    ),
    "legs opened further than hips turn": (
        Somebody(20.5, "female", 108),
        Performance("forward_roll", "left", tempo=0.75, amplitude=0.93, skill=0.5, faults={"legs_open": 2.0}, seed=2),
    ),
    "legs spread further than bent hips turn": (
        Somebody(33.5, "female", 249),
        Performance("cartwheel", "left", tempo=1.28, amplitude=1.13, faults={"no_straight_line": 1.9}, seed=381),
    ),
    "sank deeper than hips bend": (
        Somebody(47.7, "female", 371),
        Performance("squat", tempo=1.12, amplitude=1.2, skill=0.0, seed=620),
    ),
    "knees fell in further than ankles turn": (
        Somebody(42.7, "female", 733),
        Performance("squat", "left", tempo=1.18, amplitude=1.2, faults={"knees_in": 2.0}, seed=306),
    ),
    "landed with hips bent too far": (
        Somebody(21.2, "female", 161),
        Performance("long_jump", "left", tempo=1.15, amplitude=1.1, skill=0.5, seed=853),
    ),
    "a hand went into the floor in landing": (
        Somebody(14.0, "male", 186),
        Performance("long_jump", tempo=1.08, amplitude=0.8, skill=0.0, faults={"no_arm_swing": 0.8}, seed=329),
    ),
}
"""What random searches found, by what was wrong."""


@pytest.mark.slow
@pytest.mark.parametrize("case", ONCE_BROKEN)
def test_who_once_broke_a_law_keeps_it(case: str) -> None:
    who, performance = ONCE_BROKEN[case]
    subject = who.subject()
    motion = perform(performance, subject)
    if performance.action in FLOOR:
        on_mat = performance.action == "forward_roll"
        assert_borne(motion, subject, measured(motion, subject, every=1000), on_mat, sinks_m=0.025)
    else:
        assert_lawful(motion, subject, every=8)


@pytest.mark.slow
@pytest.mark.parametrize(("age", "sex"), [(7, "female"), (10, "male"), (30, "male")])
def test_the_roll_rolls_from_nape_to_seat_and_the_back_does_not_slide(age: float, sex: Sex) -> None:
    subject = pupil(age, sex)
    motion = perform(Performance("forward_roll"), subject)
    ((first, last),) = intervals(motion.contacts[:, CONTACTS.index("trunk")])
    trunk = trunk_skin(figure_of(subject))
    rest = subject.body.rest_vertices_m[trunk]
    places = np.array([subject.body.vertices_m(motion.pose(number))[trunk] for number in range(first, last)])
    lowest = places[..., 2].argmin(1)
    on_body, on_mat = rest[lowest, 2], places[np.arange(len(places)), lowest, 0]
    assert on_body[0] > 0.2 * subject.body.stature_m, "begins on the nape or the upper back"
    assert on_body[-1] < 0.02 * subject.body.stature_m, "ends on the seat"
    assert (on_body - np.minimum.accumulate(on_body)).max() < 0.035 * subject.body.stature_m, (
        "from one end of the back to the other"
    )
    rolled = (on_body[0] - on_body[-1], on_mat[-1] - on_mat[0])
    assert 0.9 < rolled[1] / rolled[0] < 1.8, "as far along the mat as along the curved back"
    for now, then in pairwise(places):
        near = np.exp((now[:, 2].min() - now[:, 2]) / 0.004)
        slid = ((then - now)[:, :2] * near[:, None]).sum(0) / near.sum() * RATE_HZ
        assert np.linalg.norm(slid) < 0.25, slid


@pytest.mark.slow
@pytest.mark.parametrize(("age", "sex"), [(8, "female"), (11, "male"), (30, "female")])
def test_the_cartwheel_goes_foot_hand_hand_foot_on_one_line_upside_down_in_the_middle(age: float, sex: Sex) -> None:
    subject = pupil(age, sex)
    motion = perform(Performance("cartwheel"), subject)
    seen = Seen(motion, subject)
    feet, hands = motion.contacts[:, :2], motion.contacts[:, 2:4]
    right, left = (intervals(hands[:, column])[0] for column in (1, 0))
    assert right[0] < left[0] < seen.peak < right[1] < left[1], "the right hand first, the left one last, both in the middle"
    assert not feet[seen.peak].any()
    assert motion.contacts.any(1).all(), "somebody who turns a cartwheel is never in the air"
    assert seen.joint("pelvis")[seen.peak, 2] > seen.joint("head")[seen.peak, 2] + 0.3 * seen.figure.leg_m
    wrists = [seen.joint(name)[seen.peak] for name in ("left_wrist", "right_wrist")]
    assert abs(wrists[0][0] - wrists[1][0]) < 0.01
    assert seen.joint("pelvis")[-1, 1] < -1.5 * seen.figure.leg_m, "he goes to his right"


@pytest.mark.slow
def test_pupils_jump_as_far_as_pupils_do() -> None:
    for sex in SEXES:
        subject = pupil(9, sex)
        distances = [
            jump_distance_m(Seen(perform(Performance("long_jump", amplitude=amplitude), subject), subject))
            for amplitude in (0.8, 1.0, 1.2)
        ]
        assert 1.2 < distances[1] < 1.5
        assert distances[0] < 0.85 * distances[1] < 0.85 / 1.15 * distances[2]


@pytest.mark.slow
@pytest.mark.parametrize(("age", "sex"), [(7, "male"), (10, "female"), (15, "male"), (30, "female")])
def test_the_run_flies_between_its_steps_and_is_quick(age: float, sex: Sex) -> None:
    subject = pupil(age, sex)
    motion = perform(Performance("run"), subject)
    found = measured(motion, subject, every=8)
    seen = Seen(motion, subject)
    flights = [span for span in intervals(np.asarray(~motion.contacts.any(1))) if span[1] - span[0] > 12]
    assert len(flights) >= 6
    speed = np.gradient(seen.joint("pelvis")[:, 0]) * RATE_HZ
    assert 2.6 < speed[seen.exertion : seen.peak].mean() < 4.2
    assert found.slide_mm <= 2.0, found
    assert found.sunk_mm <= 6.0, found
    assert found.floating_mm <= 5.0, found
    assert found.off_parabola_mm <= 5.0, found
    assert found.take_off_error_m_s <= 0.25, found
    assert found.push < 4.5, found
    assert found.shove < 4.0, found
    assert found.beyond_limit_deg <= 2.0, found
    assert max(found.from_stand_deg, found.to_stand_deg) <= 0.05, found


@pytest.mark.slow
@pytest.mark.parametrize("action", tuple(MEASURES))
def test_who_is_left_handed_does_the_mirrored_motion(action: str) -> None:
    subject = pupil(9, "male")
    right, left = (perform(Performance(action, handed=handed, skill=0.2, seed=3), subject) for handed in ("right", "left"))
    assert np.array_equal(left.contacts[:, [1, 0, 3, 2, 4]], right.contacts)
    for number in range(0, len(right.translations_m), 20):
        assert np.allclose(mirrored(right.pose(number)).vector, left.pose(number).vector, atol=1e-4)
    assert left.attempts[0].handed == "left"


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.parametrize("sex_age", [("female", 8), ("male", 15)])
@pytest.mark.parametrize(("action", "fault"), [(action, fault) for action, faults in MEASURES.items() for fault in faults])
def test_a_fault_grows_with_its_severity(action: str, fault: str, sex_age: tuple[Sex, float]) -> None:
    subject = pupil(sex_age[1], sex_age[0])
    values = [measure(action, fault, subject, {fault: severity}) for severity in (0.0, 0.5, 1.0, 1.5, 2.0)]
    size = values[2] - values[0]
    assert values[1] - values[0] > 0.15 * size > 0
    assert values[2] - values[1] > 0.1 * size
    assert min(np.diff(values)) > -0.03 * size, values


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.parametrize("action", tuple(MEASURES))
def test_natural_variation_is_nearer_to_the_standard_than_to_any_fault(action: str) -> None:
    subject = pupil(11, "male")
    natural = [Seen(perform(Performance(action, skill=0.0, seed=seed), subject), subject) for seed in range(4)]
    assert not np.array_equal(natural[0].motion.rotations_rad[200], natural[1].motion.rotations_rad[200])
    for fault, of_motion in MEASURES[action].items():
        standard, wrong = (measure(action, fault, subject, {fault: severity}) for severity in (0.0, 1.0))
        for seen in natural:
            assert of_motion(seen) < (standard + wrong) / 2, fault


def measure(action: str, fault: str, subject: Subject, faults: Mapping[str, float]) -> float:
    return MEASURES[action][fault](Seen(perform(Performance(action, faults=faults), subject), subject))
