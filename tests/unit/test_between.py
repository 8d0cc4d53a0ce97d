"""What pupils do between attempts obeys the floor, keeps within the joints' limits, and ends where and when it was told to."""

from functools import partial

import numpy as np
import pytest

from models.arrays import Bool, Float
from models.body.limits import excess_rad, limits_rad
from models.errors import UserError
from models.motions import rotations
from models.motions.actions.library import ACTIONS
from models.motions.between import LEAST_S, PASTIMES, Between, Go, Pass, Pastime, idle_time, spend
from models.motions.figure import Figure
from models.motions.motion import RATE_HZ, Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.sequence import Act, Sequence
from models.motions.standing import stand
from models.motions.standpoint import Standpoint, standpoint_of
from models.motions.subject import Subject
from models.skeleton import smpl
from tests.pupils import pupil, some_pupil

HERE = Standpoint(2.0, -1.0, 0.7)
QUICK = ("bend",)
"""The pastime that the fast tests look at; the others take as long and are like it."""
EVERY_S = 12
"""Samples between those on which the skin is looked at."""


def with_skin(what: Between, subject: Subject) -> tuple[Motion, Float]:
    motion = spend(what, subject, HERE)
    numbers = range(0, len(motion.times_s), EVERY_S)
    return motion, np.array([subject.body.vertices_m(motion.pose(number)) for number in numbers])


def feet(subject: Subject) -> list[Bool]:
    """(V,) which vertices are of the left and the right foot."""
    skin = subject.body.model.skin
    joints = [[smpl.INDEX[f"{side}_{name}"] for name in ("ankle", "foot")] for side in ("left", "right")]
    return [np.asarray((np.isin(skin.joints, pair) * skin.weights).sum(1) > 0.5) for pair in joints]


def assert_obeys_the_floor(motion: Motion, skin: Float, subject: Subject) -> None:
    assert skin[:, :, 2].min() > -0.004
    placed = Figure(subject).place(motion.translations_m, motion.rotations_rad)
    for side, mine in enumerate(feet(subject)):
        bears = motion.contacts[:, side]
        lowest = skin[:, mine, 2].min(1)
        assert lowest[bears[::EVERY_S]].max() < 0.004  # a foot that bears is down
        ankle, ball = (smpl.INDEX[f"{('left', 'right')[side]}_{name}"] for name in ("ankle", "foot"))
        rest = subject.body.rest_vertices_m[mine]
        lever = rest[np.argmin(rest[:, 0])] - subject.body.rest_joints_m[ankle]
        heel = placed.joints_m[:, ankle] + placed.turns[:, ankle] @ lever
        speeds = [np.linalg.norm(np.diff(track[:, :2], axis=0), axis=-1) * RATE_HZ for track in (heel, placed.joints_m[:, ball])]
        slides = np.minimum(*speeds)[bears[1:] & bears[:-1]]
        assert slides.max() < 0.08  # metres a second: the heel or the ball on which it turns stands still
    assert not motion.contacts[:, 2:].any()


def assert_is_human(motion: Motion, subject: Subject, fastest_m_s: float) -> None:
    limits = limits_rad(subject.age_years)
    assert np.abs([excess_rad(turned, limits) for turned in motion.rotations_rad[::EVERY_S]]).max() < np.radians(0.5)
    placed = Figure(subject).place(motion.translations_m, motion.rotations_rad)
    speeds = np.linalg.norm(np.diff(placed.joints_m, axis=0), axis=-1) * RATE_HZ
    assert speeds.max() < fastest_m_s
    assert np.linalg.norm(np.diff(placed.joints_m, n=2, axis=0), axis=-1).max() * RATE_HZ**2 < 400


def assert_ends_standing(motion: Motion, subject: Subject, at: Standpoint) -> None:
    pose, home = motion.pose(len(motion.times_s) - 1), stand(subject)
    wanted = at.pose(home)
    assert np.abs(pose.translation_m - wanted.translation_m).max() < 1e-4
    turned = rotations.matrices(pose.rotations_rad).swapaxes(-1, -2) @ rotations.matrices(wanted.rotations_rad)
    assert np.abs(rotations.vectors(turned)).max() < 1e-3
    assert np.abs(motion.pose(0).vector - home.vector).max() < 1e-4


@pytest.mark.parametrize("how", [pytest.param(how, marks=[pytest.mark.slow] if how not in QUICK else []) for how in PASTIMES])
def test_passing_time_keeps_the_feet_where_they_are_and_ends_on_time(how: Pastime) -> None:
    subject = pupil()
    motion, skin = with_skin(Pass(how, 2.6, seed=1), subject)
    assert motion.duration_s == pytest.approx(2.6, abs=0.5 / RATE_HZ)
    assert motion.attempts == ()
    assert_obeys_the_floor(motion, skin, subject)
    assert_is_human(motion, subject, fastest_m_s=11.0)
    assert_ends_standing(motion, subject, Standpoint())
    figure = Figure(subject)
    weight = figure.centres_of_mass_m(figure.place(motion.translations_m, motion.rotations_rad))[::EVERY_S, :2]
    soles = skin[0][feet(subject)[0] | feet(subject)[1]][:, :2]
    assert (weight > soles.min(0)).all()
    assert (weight < soles.max(0)).all()


@pytest.mark.parametrize(
    ("to", "jogs"),
    [(Standpoint(2.9, -0.4, 0.7), False), pytest.param(Standpoint(6.0, -3.0, 2.0), True, marks=pytest.mark.slow)],
)
def test_going_somewhere_arrives_there(to: Standpoint, jogs: bool) -> None:
    subject = pupil()
    motion, skin = with_skin(Go(to, jogs, seed=3), subject)
    assert_obeys_the_floor(motion, skin, subject)
    assert_is_human(motion, subject, fastest_m_s=11.0)
    assert_ends_standing(motion, subject, to.within(HERE))
    flies = ~(motion.contacts[:, 0] | motion.contacts[:, 1])
    assert flies.any() == jogs


@pytest.mark.slow
@pytest.mark.parametrize(("age", "sex", "seed"), [(6, "female", 2), (9, "male", 5), (15, "female", 7), (45, "male", 11)])
def test_people_of_all_sizes_go_and_wait_by_the_same_laws(age: float, sex: str, seed: int) -> None:
    subject = some_pupil(age, "male" if sex == "male" else "female", seed)
    generator = np.random.default_rng(seed)
    acts: list[Between] = [Pass(how, 3.0, seed) for how in ("scratch", "bend", "pick_up", "stretch")]
    acts += [Go(Standpoint(*(float(v) for v in generator.uniform(-3, 3, 3))), jogs, seed) for jogs in (False, True)]
    acts += [Go(Standpoint(HERE.x_m, HERE.y_m, -2.3), False, seed), Go(HERE.of(Standpoint(0.2, 0.1, 0.0)), True, seed)]
    for act in acts:
        motion, skin = with_skin(act, subject)
        assert_obeys_the_floor(motion, skin, subject)
        assert_is_human(motion, subject, fastest_m_s=12.0)
        assert_ends_standing(motion, subject, act.to.within(HERE) if isinstance(act, Go) else Standpoint())


@pytest.mark.slow
def test_walking_speed_and_steps_grow_with_the_leg() -> None:
    speeds = []
    for age in (6.0, 11.0, 30.0):
        subject = pupil(age, "female")
        motion = spend(Go(Standpoint(8.0, 0.0, 0.0), seed=2), subject, Standpoint())
        inside = (motion.translations_m[:, 0] > 2) & (motion.translations_m[:, 0] < 6)
        speeds.append(4.0 / (inside.sum() / RATE_HZ))
        landings = np.flatnonzero(np.diff(motion.contacts[:, 0].astype(int)) > 0)
        stride_m = float(np.median(np.diff(motion.translations_m[landings, 0])[1:-1]))
        assert 0.55 < stride_m / subject.body.stature_m < 0.95
    assert speeds == sorted(speeds)
    assert 0.6 < speeds[0] < speeds[-1] < 1.7


def test_a_seed_gives_one_wait_and_another_seed_another() -> None:
    one, again, other = (spend(Pass("wait", 1.8, seed), pupil(), HERE) for seed in (1, 1, 2))
    np.testing.assert_array_equal(one.rotations_rad, again.rotations_rad)
    assert np.abs(one.rotations_rad - other.rotations_rad).max() > 0.05


@pytest.mark.parametrize("how", PASTIMES)
def test_too_short_a_time_is_refused_with_what_it_takes(how: Pastime) -> None:
    with pytest.raises(UserError, match=f"between attempts: '{how}' takes .* s or more, not 0 s"):
        Pass(how, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("how", PASTIMES[1:])
def test_the_shortest_time_is_enough(how: Pastime) -> None:
    motion = spend(Pass(how, LEAST_S[how]), pupil(), HERE)
    assert motion.duration_s == pytest.approx(LEAST_S[how], abs=0.5 / RATE_HZ)
    assert_is_human(motion, pupil(), fastest_m_s=12.0)


def test_idle_time_is_long_enough_varied_and_seeded() -> None:
    def anywhere(generator: np.random.Generator) -> Standpoint:
        return Standpoint(*(float(value) for value in generator.uniform(-3, 3, 3)))

    acts = idle_time(1800.0, anywhere, seed=5)
    assert acts == idle_time(1800.0, anywhere, seed=5)
    assert acts != idle_time(1800.0, anywhere, seed=6)
    assert {act.how for act in acts if isinstance(act, Pass)} == set(PASTIMES)
    assert {act.jogs for act in acts if isinstance(act, Go)} == {True, False}
    assert 1700 < sum(act.seconds if isinstance(act, Pass) else 6.5 for act in acts) < 1900


def attempt_at(performance: Performance, subject: Subject) -> Act:
    return lambda _: perform(performance, subject)


@pytest.mark.slow
def test_a_lesson_of_attempts_and_what_is_between_them_is_one_motion() -> None:
    subject, start = pupil(), Standpoint(1.0, 2.0, -0.5)
    actions = sorted(ACTIONS)[::3]
    acts: list[Act] = []
    for number, action in enumerate(actions):
        acts += [partial(spend, what, subject) for what in (Go(Standpoint(float(number), 0.0, 1.0)), Pass("wait", 1.0, number))]
        acts.append(attempt_at(Performance(action, seed=number), subject))
    whole = Sequence(acts, start)
    assert [attempt.action for attempt in whole.attempts] == actions
    begins = dict(zip(actions, whole.seams_s[2::3], strict=True))
    for attempt in whole.attempts:
        assert attempt.start_s >= begins[attempt.action]
        at = standpoint_of(whole.pose_at(begins[attempt.action]))
        assert (at.x_m, at.y_m) == pytest.approx((float(actions.index(attempt.action)), 0.0), abs=1e-4)
        assert at.heading_rad == pytest.approx(1.0, abs=1e-4)
    joints = [subject.body.joints_m(whole.pose_at(at_s)) for at_s in np.arange(0, whole.duration_s, 1 / 30)]
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() * 30 < 30
