"""What is refused of a performance, and what a thing and an attempt are like by construction."""

from collections.abc import Mapping

import numpy as np
import pytest

from models.errors import UserError
from models.motions.actions import volleyball_spike
from models.motions.actions.library import ACTIONS
from models.motions.flights import bouncing, shuttlecock
from models.motions.motion import RATE_HZ, Attempt, Handed, Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.things import BASKETBALL_RADIUS_M
from models.skeleton import smpl
from tests.pupils import pupil, some_pupil

HANDS = ("left_wrist", "left_hand", "right_wrist", "right_hand")


def test_an_unknown_action_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(UserError, match=r"there is no action 'backflip'; there are .*soccer_kick"):
        perform(Performance("backflip"), pupil(10, "male"))


def test_an_unknown_fault_is_refused_with_those_of_the_action() -> None:
    with pytest.raises(UserError, match="soccer_kick has no fault 'elbow_out'; it has lean_back, no_backswing"):
        perform(Performance("soccer_kick", faults={"elbow_out": 1.0}), pupil(10, "male"))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tempo": 2.0}, "tempo is 2; it may be 0.7 to 1.4"),
        ({"amplitude": float("nan")}, "amplitude is nan"),
        ({"skill": -0.1}, "skill is -0.1; it may be 0 to 1"),
        ({"faults": {"lean_back": 3.0}}, "severity of 'lean_back' is 3; it may be 0 to 2"),
        ({"handed": "both"}, "handed is 'both'"),
    ],
)
def test_an_impossible_parameter_is_refused_with_its_bounds(change: Mapping[str, object], words: str) -> None:
    with pytest.raises(UserError, match=words):
        Performance("soccer_kick", **change)  # type: ignore[arg-type]


def test_every_fault_says_what_is_done_wrong_and_how_much() -> None:
    for action in ACTIONS.values():
        assert len(action.faults) >= 3
        assert len({fault.name for fault in action.faults}) == len(action.faults)
        for fault in action.faults:
            assert fault.what
            assert "\n" not in fault.what


def test_moments_of_an_attempt_follow_one_another() -> None:
    with pytest.raises(ValueError, match="moments of a squat must follow one another"):
        Attempt("squat", "right", 0.5, 0.4, 1.0, 2.0)


@pytest.fixture(scope="module")
def shot() -> Motion:
    return perform(Performance("basketball_shot"), pupil(11, "female"))


def test_the_ball_leaves_at_the_release_and_flies_through_the_basket(shot: Motion) -> None:
    ball, release = shot.things[0].translations_m, round(shot.attempts[0].peak_s * RATE_HZ)
    flown = ball[release : release + round(0.6 * RATE_HZ)]
    assert np.allclose(np.diff(flown, 2, axis=0) * RATE_HZ**2, (0, 0, -9.81), atol=1e-3)
    jump = np.linalg.norm(np.diff(ball, axis=0), axis=1)
    assert np.nanmax(jump) < 0.05
    assert np.nanmin(ball[:, 2]) > BASKETBALL_RADIUS_M - 1e-6
    high_and_far = ball[(ball[:, 0] > 3.3) & (ball[:, 2] > 2.0)]
    assert np.abs(high_and_far[:, 2] - 2.6).min() < 0.1


def test_the_ball_lies_on_both_palms_until_then(shot: Motion) -> None:
    body, attempt = pupil(11, "female").body, shot.attempts[0]
    skin = body.model.skin
    carrier = skin.joints[np.arange(len(skin.joints)), skin.weights.argmax(1)]
    for at_s in np.linspace(attempt.start_s, attempt.peak_s - 0.06, 6):
        number = round(at_s * RATE_HZ)
        from_ball = np.linalg.norm(body.vertices_m(shot.pose(number)) - shot.things[0].translations_m[number], axis=1)
        for side in ("left", "right"):
            palm = np.isin(carrier, [smpl.INDEX[f"{side}_{name}"] for name in ("wrist", "hand")])
            assert abs(from_ball[palm].min() - BASKETBALL_RADIUS_M) < 0.025, (at_s, side)
        assert from_ball[~np.isin(carrier, [smpl.INDEX[name] for name in HANDS])].min() > BASKETBALL_RADIUS_M


@pytest.mark.slow
@pytest.mark.parametrize("action", ["badminton_clear", "basketball_shot", "volleyball_spike", "soccer_kick"])
@pytest.mark.parametrize("handed", ["right", "left"])
def test_things_stay_above_the_floor_and_never_leap(action: str, handed: Handed) -> None:
    for thing in perform(Performance(action, handed=handed), pupil(8, "male")).things:
        there = thing.translations_m[np.isfinite(thing.translations_m).all(1)]
        assert there[:, 2].min() > 0.03
        assert np.linalg.norm(np.diff(there, axis=0), axis=1).max() * RATE_HZ < 30
        assert np.isfinite(thing.rotations_rad).all()


def test_a_ball_bounces_lower_each_time_and_never_sinks() -> None:
    after = np.arange(0, 3, 1 / RATE_HZ)
    path = bouncing(np.array((0.0, 0.0, 2.0)), np.array((0.5, 0.0, 0.0)), 0.11, after)
    assert path[:, 2].min() >= 0.11 - 1e-9
    tops = [path[k, 2] for k in range(1, len(path) - 1) if path[k - 1, 2] < path[k, 2] >= path[k + 1, 2]]
    assert len(tops) >= 2
    assert (np.diff(tops) < 0).all()


def test_a_shuttlecock_leaves_as_it_was_hit_is_slowed_and_falls_cork_first() -> None:
    after = np.arange(0, 1.2, 1 / RATE_HZ)
    place, turned = shuttlecock(np.array((0.0, 0.0, 2.2)), np.array((18.0, 0.0, 12.0)), after)
    speed = np.linalg.norm(np.diff(place, axis=0), axis=1) * RATE_HZ
    assert speed[0] == pytest.approx(np.hypot(18, 12), rel=0.02)
    assert speed[-1] < 0.5 * speed[0]
    assert turned.shape == place.shape


@pytest.mark.slow
def test_a_spike_whose_shoulders_would_turn_too_far_is_refused_and_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    subject = some_pupil(43.0, "female", 855)
    faults = {"hit_behind": 1.9466, "late_hit": 1.9466}
    performance = Performance("volleyball_spike", tempo=0.82, amplitude=0.957, skill=0.0, faults=faults, seed=855)
    motion = perform(performance, subject)
    assert beyond_deg(motion, subject, "shoulder", 1, sides=("left",)) < volleyball_spike.BEYOND_DEG
    monkeypatch.setattr(volleyball_spike, "_ROUNDS", 1)
    with pytest.raises(UserError, match=r"somebody of 43 would turn .* degrees too far; ask for less of hit_behind"):
        perform(performance, subject)
