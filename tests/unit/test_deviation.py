"""Colours: green only where it is surely so, grey where nobody can tell."""

import numpy as np
import pytest

from models.arrays import Float
from models.messages.feedback import Colour
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.schema import Tolerance
from models.teaching.standard import FRAME_S, Exemplar, Standard
from services.evaluation.alignment import align
from services.evaluation.deviation import Deviation, deviate
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT, NETWORK, Uncertainty

WRIST, ELBOW = coco.INDEX["right_wrist"], coco.INDEX["right_elbow"]
FRAMES = 45


def waving() -> Float:
    """(T, 17, 3) somebody of about 1.5 m who raises his arm to the side and bends his knees a little."""
    places = {
        "nose": (0.1, 0, 1.38), "eye": (0.08, 0.03, 1.42), "ear": (0, 0.07, 1.4), "shoulder": (0, 0.16, 1.22),
        "elbow": (0, 0.18, 0.95), "wrist": (0, 0.2, 0.72), "hip": (0, 0.09, 0.8), "knee": (0, 0.09, 0.43), "ankle": (0, 0.09, 0.08),
    }  # fmt: skip
    joints = np.zeros((FRAMES, coco.COUNT, 3))
    for index, name in enumerate(coco.NAMES):
        x, y, z = places[name.split("_")[-1]]
        joints[:, index] = (x, y if name.startswith("left") else -y, z)
    angle = np.pi * np.sin(np.linspace(0, np.pi, FRAMES)) ** 2
    for index, length in ((ELBOW, 0.27), (WRIST, 0.5)):
        joints[:, index, 1] = -0.16 - length * np.sin(angle)
        joints[:, index, 2] = 1.22 - length * np.cos(angle)
    return joints


def standard(spread_m: float = 0.02) -> Standard:
    moments = (0.0, 0.4, 0.7, 1.4)
    return Standard("wave", 1, "a test", Exemplar(waving(), moments), np.full((FRAMES, coco.COUNT), spread_m), 1.5)


def compared(track: Track, spread_m: float = 0.02, model: Uncertainty = NETWORK) -> Deviation:
    one = standard(spread_m)
    aligned = align(track, one)
    assert aligned is not None
    return deviate(aligned, track, one, Tolerance(), model)


def seen(joints_m: Float, sigma_m: float = 0.005) -> Track:
    return known_track(joints_m, FRAME_S, sigma_m)


def test_who_does_as_the_standard_does_is_green() -> None:
    deviation = compared(seen(waving()))
    assert (deviation.colours == Colour.GREEN).all()
    assert deviation.distance.max() < 0.01


def test_somewhere_else_turned_and_larger_is_green_too() -> None:
    turn = np.array(((0.6, -0.8, 0), (0.8, 0.6, 0), (0, 0, 1)))
    deviation = compared(seen(1.2 * waving() @ turn.T + (3, -2, 0)))
    assert (deviation.colours == Colour.GREEN).all()


def test_slower_is_green_too() -> None:
    slow = np.repeat(waving(), 2, axis=0)
    assert (compared(seen(slow)).colours == Colour.GREEN).mean() > 0.98


def lowered(metres: float) -> Float:
    joints = waving()
    joints[:, WRIST, 2] -= metres
    return joints


def test_a_joint_is_yellow_beyond_its_tolerance_and_red_beyond_twice_of_it() -> None:
    """7 % of 1.5 m are 10.5 cm."""
    still = slice(0, 4)
    for metres, colour in ((0.05, Colour.GREEN), (0.16, Colour.YELLOW), (0.45, Colour.RED)):
        colours = compared(seen(lowered(metres)), model=EXACT).colours
        assert (colours[still, WRIST] == colour).all(), metres
        assert (colours[still, coco.INDEX["left_wrist"]] == Colour.GREEN).all()


def test_what_good_performances_differ_by_is_no_fault() -> None:
    assert (compared(seen(lowered(0.25)), spread_m=0.15).colours[:4, WRIST] == Colour.GREEN).all()


def test_what_was_not_seen_is_grey() -> None:
    track = seen(waving())
    states = track.states.copy()
    states[10:20, WRIST] = JointState.GUESSED
    guessed = compared(Track(track.t_s, track.joints_m, track.covariance_m2, states))
    assert (guessed.colours[10:20, WRIST] == Colour.GREY).all()
    joints = waving()
    joints[10:20, WRIST] = np.nan
    unknown = compared(seen(joints))
    assert (unknown.colours[10:20, WRIST] == Colour.GREY).all()
    assert np.isnan(unknown.distance[10:20, WRIST]).all()
    assert (unknown.colours[:, ELBOW] == Colour.GREEN).all()


def test_what_is_too_uncertain_is_grey_however_near_it_looks() -> None:
    assert (compared(seen(waving(), 0.3)).colours == Colour.GREY).all()


def test_a_standard_that_does_not_know_a_joint_colours_it_grey() -> None:
    joints = waving()
    joints[:, WRIST] = np.nan
    one = Standard("wave", 1, "a test", Exemplar(joints, (0.0, 0.4, 0.7, 1.4)), np.full((FRAMES, coco.COUNT), np.nan), 1.5)
    track = seen(waving())
    aligned = align(track, one)
    assert aligned is not None
    colours = deviate(aligned, track, one, Tolerance()).colours
    assert (colours[:, WRIST] == Colour.GREY).all()
    assert (colours[:, ELBOW] == Colour.GREEN).all()


@pytest.mark.parametrize("sigma_m", [0.005, 0.02, 0.04])
def test_noise_of_the_stated_size_makes_no_wrong_red_and_no_green_of_a_fault(sigma_m: float) -> None:
    random = np.random.default_rng(5)
    faulty = lowered(0.4)
    for joints, never in ((waving(), Colour.RED), (faulty, Colour.GREEN)):
        track = seen(joints + sigma_m * random.standard_normal(joints.shape), sigma_m)
        assert (compared(track).colours[:4, WRIST] != never).all()


def test_an_attempt_that_shows_nothing_is_not_aligned() -> None:
    assert align(seen(np.full((FRAMES, coco.COUNT, 3), np.nan)), standard()) is None
