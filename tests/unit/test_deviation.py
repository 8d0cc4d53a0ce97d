"""Colours: green only where it is surely so, grey where nobody can tell."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.messages.feedback import Colour
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.schema import Tolerance
from models.teaching.standard import FRAME_S, Exemplar, Standard
from services.evaluation.alignment import align
from services.evaluation.deviation import Deviation, _covariance_m2, deviate
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT, NETWORK, Uncertainty
from tests.taught import shallow_squat, shipped

WRIST, ELBOW, HIP, KNEE = (coco.INDEX[f"right_{part}"] for part in ("wrist", "elbow", "hip", "knee"))
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


def guessed(joints_m: Float, joints: tuple[int, ...], frames: slice) -> Track:
    track = seen(joints_m)
    states = track.states.copy()
    states[frames, joints] = JointState.GUESSED
    return Track(track.t_s, track.joints_m, track.covariance_m2, states)


def test_by_hips_that_were_only_guessed_no_joint_is_coloured() -> None:
    """All are compared from the middle of the hips: 12 cm off, they would move the whole body."""
    hips, frames = (coco.INDEX["left_hip"], HIP), slice(20, 28)
    joints = waving()
    joints[frames, hips, 0] += 0.12
    colours = compared(guessed(joints, hips, frames)).colours
    assert (colours[frames] == Colour.GREY).all()
    assert (np.delete(colours, np.r_[frames], axis=0) == Colour.GREEN).mean() > 0.98


def half_turned(frames: slice) -> Float:
    """The left shoulder and hip are some 40 degrees too far back in some frames."""
    joints = waving()
    joints[frames, coco.INDEX["left_shoulder"], 0] -= 0.25
    joints[frames, coco.INDEX["left_hip"], 0] -= 0.15
    return joints


def test_a_heading_is_that_of_the_frames_in_which_the_trunk_was_seen() -> None:
    left = (coco.INDEX["left_shoulder"], coco.INDEX["left_hip"])
    colours = compared(guessed(half_turned(slice(0, 6)), left, slice(0, 6))).colours
    assert (colours[:6] == Colour.GREY).all()
    assert (colours[6:] == Colour.GREEN).mean() > 0.98


def test_by_a_heading_that_was_only_guessed_nobody_is_coloured() -> None:
    shoulder = (coco.INDEX["left_shoulder"],)
    colours = compared(guessed(waving(), shoulder, slice(0, 20))).colours
    assert (colours == Colour.GREY).all()


def test_what_is_too_uncertain_is_grey_however_near_it_looks() -> None:
    assert (compared(seen(waving(), 0.3)).colours == Colour.GREY).all()


def unsure_ahead(joints_m: Float, sigma_m: float) -> Track:
    """The right wrist is so unsure to the front, and known to half a centimetre aside and in height."""
    track = seen(joints_m)
    covariance = track.covariance_m2.copy()
    covariance[:, WRIST] = np.diag((sigma_m**2, 0.005**2, 0.005**2))
    return Track(track.t_s, track.joints_m, covariance, track.states)


def test_what_is_too_uncertain_in_one_direction_is_grey_however_near_it_looks_in_another() -> None:
    """The wrist is 2 cm too low, and nobody knows how far in front of the body it is."""
    colours = compared(unsure_ahead(lowered(0.02), 0.3)).colours
    assert (colours[:, WRIST] == Colour.GREY).all()
    assert (np.delete(colours, WRIST, axis=1) == Colour.GREEN).all()


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


def test_a_movement_that_is_too_small_is_not_green_where_it_should_be_largest() -> None:
    """A squat to half the depth passes the same poses, and is nowhere as deep."""
    squat, tolerance = shipped().standards["squat"], shipped().teachings["squat"].tolerance
    for depth, never in ((0.5, Colour.GREEN), (1.0, Colour.RED)):
        track = seen(shallow_squat(depth))
        aligned = align(track, squat)
        assert aligned is not None
        colours = deviate(aligned, track, squat, tolerance).colours
        lowest = int(track.joints_m[:, HIP, 2].argmin())
        assert (colours[lowest - 2 : lowest + 3, [HIP, KNEE]] != never).all(), depth
        assert (colours[:3] == Colour.GREEN).all(), "he stands as he should"
    assert (colours == Colour.GREEN).mean() > 0.99


def test_a_movement_that_is_too_small_is_no_better_for_a_frame_that_was_lost_at_its_end() -> None:
    squat, tolerance = shipped().standards["squat"], shipped().teachings["squat"].tolerance
    joints = shallow_squat(0.5)
    lowest = int(joints[:, HIP, 2].argmin())
    for lost in (slice(lowest, lowest + 1), slice(lowest - 2, lowest + 3)):
        gap = joints.copy()
        gap[lost] = np.nan
        track = seen(gap)
        aligned = align(track, squat)
        assert aligned is not None
        colours = deviate(aligned, track, squat, tolerance).colours
        assert (colours[lost] == Colour.GREY).all()
        assert (colours[[lost.start - 1, lost.stop], HIP] != Colour.GREEN).all()


def test_nobody_is_judged_against_a_standard_that_faces_elsewhere() -> None:
    """Who is seen only once he has turned: to where he looked at first is not known."""
    turn = np.linspace(0, np.pi / 2, FRAMES)
    joints = waving()
    x, y = joints[..., 0].copy(), joints[..., 1].copy()
    joints[..., 0], joints[..., 1] = np.cos(turn)[:, None] * x - np.sin(turn)[:, None] * y, np.sin(turn)[:, None] * x
    joints[..., 1] += np.cos(turn)[:, None] * y
    joints[:20, coco.INDEX["left_shoulder"]] = np.nan
    assert align(seen(joints), standard()) is None
    joints = waving()
    joints[:5, coco.INDEX["left_shoulder"]] = np.nan
    assert align(seen(joints), standard()) is not None


@pytest.mark.parametrize("part", ["wrist", "ankle", "nose"])
def test_where_a_body_faces_how_large_it_is_and_where_its_hips_are_is_as_unsure_as_its_landmarks(part: str) -> None:
    """A wrist that is stretched out is moved by what hips and shoulders are wrong by."""
    random = np.random.default_rng(3)
    landmarks = replace(NETWORK, timing_s=0.0)
    raised, joint = FRAMES // 4, coco.INDEX["nose" if part == "nose" else f"right_{part}"]
    exact = align(seen(waving(), 0.0), standard())
    assert exact is not None
    apart = []
    for _ in range(150):
        errors = np.array(NETWORK.landmark_m)[:, None] * (NETWORK.mixed @ random.standard_normal((coco.COUNT, 3)))
        found = align(seen(waving() + errors, 0.0), standard())
        assert found is not None
        apart.append((found.joints_m - exact.joints_m)[raised, joint])
    stated = np.sqrt(np.diagonal(_covariance_m2(exact, seen(waving(), 0.0), landmarks)[raised, joint]))
    ratio = stated / np.std(apart, axis=0)
    assert (ratio > 0.8).all(), ratio
    assert (ratio < 1.6).all(), ratio


@pytest.mark.parametrize("part", ["wrist", "ankle"])
def test_where_a_body_faces_is_as_unsure_as_its_beginning_is_noisy(part: str) -> None:
    """Landmarks, and in the frames of which the heading is the mean 2 cm of noise, which changes as slowly as fusion's does."""
    random = np.random.default_rng(4)
    model = replace(NETWORK, timing_s=0.0, noise_scale=(1.0,) * coco.COUNT)
    raised, joint, sigma_m = FRAMES // 4, coco.INDEX[f"right_{part}"], 0.02
    exact = align(seen(waving(), 0.0), standard())
    assert exact is not None
    beginning = len(exact.placing.frames)
    assert beginning <= raised
    smooth = np.linalg.cholesky(model.alike(np.arange(beginning, dtype=np.float64) * FRAME_S)[0] + 1e-9 * np.eye(beginning))
    apart = []
    for _ in range(150):
        noisy = waving() + np.array(model.landmark_m)[:, None] * (model.mixed @ random.standard_normal((coco.COUNT, 3)))
        noisy[:beginning] += sigma_m * model.mixed @ np.tensordot(smooth, random.standard_normal((beginning, coco.COUNT, 3)), 1)
        found = align(seen(noisy, 0.0), standard())
        assert found is not None
        apart.append((found.joints_m - exact.joints_m)[raised, joint])
    track = seen(waving(), 0.0)
    covariance = track.covariance_m2.copy()
    covariance[:beginning] = sigma_m**2 * np.eye(3)
    told = Track(track.t_s, track.joints_m, covariance, track.states)
    ratio = np.sqrt(np.diagonal(_covariance_m2(exact, told, model)[raised, joint])) / np.std(apart, axis=0)
    assert (ratio > 0.8).all(), ratio
    assert (ratio < 1.6).all(), ratio
