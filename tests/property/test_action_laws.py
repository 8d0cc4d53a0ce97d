"""Laws of the performed actions, for every subject and every way to perform them."""

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.body.pose import mirrored
from models.body.prior import Sex
from models.motions.actions.library import ACTIONS
from models.motions.motion import Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.subject import Subject
from tests import gym_measures
from tests.action_measures import MEASURES, Seen
from tests.motion_laws import assert_lawful, measured
from tests.pupils import Somebody, people, performances, pupil

UPRIGHT = tuple(MEASURES)
ONE_FAST = [pytest.param(action, marks=[pytest.mark.slow] * (action != "soccer_kick")) for action in UPRIGHT]
MIRROR = np.array((1.0, -1.0, 1.0))


def test_every_fault_of_every_action_has_a_measure_and_every_measure_a_fault() -> None:
    measures = {action: set(of_faults) for action, of_faults in (*MEASURES.items(), *gym_measures.MEASURES.items())}
    assert measures == {name: {fault.name for fault in action.faults} for name, action in ACTIONS.items()}


@pytest.mark.parametrize("action", UPRIGHT)
def test_feet_stand_bodies_fly_and_joints_turn_as_they_can(action: str) -> None:
    subject = pupil(10, "female")
    assert_lawful(perform(Performance(action), subject), subject, every=12)


@pytest.mark.slow
@pytest.mark.parametrize("age", [7, 12, 30])
@pytest.mark.parametrize("action", [*UPRIGHT, "squat", "star_jump", "run"])
def test_the_floor_bears_the_body_and_never_holds_it_down(action: str, age: float) -> None:
    subject = pupil(age, "male")
    found = measured(perform(Performance(action), subject), subject, every=1000)
    assert found.pull < 0.1
    assert found.push < 4.5
    assert found.shove < (4.0 if action == "run" else 2.0)


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.timeout(900)
@pytest.mark.parametrize("action", UPRIGHT)
@given(data=st.data(), who=people())
@settings(max_examples=25)
def test_feet_stand_bodies_fly_and_joints_turn_as_they_can_for_everybody(action: str, data: st.DataObject, who: Somebody) -> None:
    subject = who.subject()
    assert_lawful(perform(data.draw(performances(action, most_faults=2)), subject), subject)


ONCE_BROKEN = {
    "a late hit behind the head was lowered and raised again within hundredths of a second": (
        Somebody(15.356439813506825, "male", 0),
        Performance(
            "volleyball_spike",
            tempo=0.7,
            amplitude=0.9569712109237094,
            skill=0.0,
            faults={"hit_behind": 2.0, "late_hit": 2.0},
            seed=0,
        ),
    ),
    "both shoulders turned further than a grown-up's": (
        Somebody(43.0, "female", 855),
        Performance(
            "volleyball_spike", tempo=0.82, amplitude=0.957, skill=0.0, faults={"hit_behind": 1.9466, "late_hit": 1.9466}, seed=855
        ),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", ONCE_BROKEN)
def test_who_once_broke_a_law_keeps_it(case: str) -> None:
    who, performance = ONCE_BROKEN[case]
    subject = who.subject()
    assert_lawful(perform(performance, subject), subject, every=8)


@pytest.mark.parametrize("action", ONE_FAST)
def test_who_is_left_handed_does_the_mirrored_motion(action: str) -> None:
    fault = next(iter(MEASURES[action]))
    subject = pupil(9, "male")
    right, left = (
        perform(Performance(action, handed=handed, skill=0.2, seed=3, faults={fault: 0.7}), subject)
        for handed in ("right", "left")
    )  # fmt: skip
    assert np.array_equal(left.contacts[:, [1, 0, 3, 2, 4]], right.contacts)
    for number in range(0, len(right.translations_m), 20):
        ours, theirs = mirrored(right.pose(number)), left.pose(number)
        assert np.allclose(ours.vector, theirs.vector, atol=1e-4)
    for mine, other in zip(right.things, left.things, strict=True):
        assert np.allclose(mine.translations_m * MIRROR, other.translations_m, atol=1e-4, equal_nan=True)
    assert right.attempts[0].handed == "right"
    assert left.attempts[0].handed == "left"
    assert right.attempts[0].peak_s == left.attempts[0].peak_s


@pytest.mark.parametrize("action", ONE_FAST)
def test_a_fault_of_no_severity_is_the_standard(action: str) -> None:
    subject = pupil(10, "female")
    none = dict.fromkeys(MEASURES[action], 0.0)
    assert same(perform(Performance(action, faults=none), subject), perform(Performance(action), subject))


@pytest.mark.slow
@pytest.mark.parametrize("action", UPRIGHT)
def test_a_seed_varies_natural_performances_and_not_the_standard(action: str) -> None:
    subject = pupil(10, "female")
    first, again, other = (perform(Performance(action, skill=0.3, seed=seed), subject) for seed in (1, 1, 2))
    assert same(first, again)
    assert not same(first, other)
    assert same(perform(Performance(action, seed=1), subject), perform(Performance(action, seed=2), subject))


@pytest.mark.slow
@pytest.mark.parametrize("action", UPRIGHT)
def test_tempo_shortens_what_muscles_do_and_leaves_gravity_alone(action: str) -> None:
    subject = pupil(10, "female")
    slow, fast = (perform(Performance(action, tempo=tempo), subject) for tempo in (0.8, 1.25))
    assert fast.duration_s < 0.85 * slow.duration_s
    in_air = [np.count_nonzero(~motion.contacts.any(1)) for motion in (slow, fast)]
    assert abs(in_air[0] - in_air[1]) <= 2


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.parametrize("sex_age", [("female", 8), ("male", 30)])
@pytest.mark.parametrize(("action", "fault"), [(action, fault) for action in UPRIGHT for fault in MEASURES[action]])
def test_a_fault_grows_with_its_severity(action: str, fault: str, sex_age: tuple[Sex, float]) -> None:
    subject = pupil(sex_age[1], sex_age[0])
    values = [measure(action, fault, subject, {fault: severity}) for severity in (0.0, 0.5, 1.0, 1.5, 2.0)]
    size = values[2] - values[0]
    assert values[1] - values[0] > 0.15 * size
    assert values[2] - values[1] > 0.1 * size
    assert min(np.diff(values)) > -0.03 * size, values


@pytest.mark.slow
@pytest.mark.motions
@pytest.mark.parametrize(("action", "fault"), [(action, fault) for action in UPRIGHT for fault in MEASURES[action]])
def test_natural_variation_is_nearer_to_the_standard_than_to_the_fault(action: str, fault: str) -> None:
    subject = pupil(11, "male")
    standard, wrong = (measure(action, fault, subject, {fault: severity}) for severity in (0.0, 1.0))
    for seed in range(6):
        natural = MEASURES[action][fault](Seen(perform(Performance(action, skill=0.0, seed=seed), subject), subject))
        assert natural < (standard + wrong) / 2, (seed, standard, natural, wrong)


def measure(action: str, fault: str, subject: Subject, faults: Mapping[str, float]) -> float:
    return MEASURES[action][fault](Seen(perform(Performance(action, faults=faults), subject), subject))


def same(first: Motion, second: Motion) -> bool:
    """To the last bit."""
    return np.array_equal(first.translations_m, second.translations_m) and np.array_equal(first.rotations_rad, second.rotations_rad)
