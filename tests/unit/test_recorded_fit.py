"""A body fitted to recorded markers: made-up markers give the motion back that they were made from."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.body.model import Body
from models.body.pose import Pose
from models.errors import UserError
from models.motions.motion import RATE_HZ
from models.motions.recorded.fit import MarkerFit, fit
from models.motions.recorded.marker_spots import landmarks_of, spot_of
from models.motions.recorded.markers import LONGEST_GAP_S, Markers
from models.motions.recorded.replay import motion_of
from models.skeleton import smpl
from tests.bodies import LARGE, SMALL, body_model, prior_of

PLUG_IN_GAIT = (
    *(f"{side}{name}" for side in "LR" for name in ("ASI", "PSI", "THI", "KNE", "TIB", "ANK", "HEE", "TOE", "SHO", "FHD", "BHD")),
    *(f"{side}{name}" for side in "LR" for name in ("UPA", "ELB", "FRM", "WRA", "WRB", "FIN")),
    *("C7", "T10", "CLAV", "STRN", "RBAK"),
)
OPENCAP = (
    *(f"{side}_{name}" for side in "Lr" for name in ("knee", "ankle", "calc", "5meta", "toe", "sh2", "sh3", "thigh1", "thigh2")),
    *(f"{side}_{name}" for side in "LR" for name in ("Shoulder", "Sternum", "humerus", "elbow_med", "elbow_lat")),
    *(f"{side}_{name}" for side in "LR" for name in ("forearm", "wrist_radius", "wrist_ulna")),
    *("L.ASIS", "r.ASIS", "L.PSIS", "r.PSIS", "C7"),
)
FITTED_HZ = 50.0


def moving(seconds: float) -> list[Pose]:
    """Turns on the spot, swings the arms, bends the knees."""
    times = np.arange(int(seconds * FITTED_HZ)) / FITTED_HZ
    poses = []
    for time in times:
        turns = np.zeros((smpl.COUNT, 3))
        swing = np.sin(2 * np.pi * time / 1.2)
        turns[0, 2] = 2.5 + 2.0 * time
        for side, sign in (("left", 1.0), ("right", -1.0)):
            turns[smpl.INDEX[f"{side}_shoulder"]] = (-sign * (0.9 + 0.3 * swing), 0.2 * sign, -sign * 0.5 * swing)
            turns[smpl.INDEX[f"{side}_elbow"], 2] = -sign * (0.7 + 0.4 * swing)
            turns[smpl.INDEX[f"{side}_hip"], 1] = -0.4 - 0.3 * swing * sign
            turns[smpl.INDEX[f"{side}_knee"], 1] = 0.6 + 0.3 * swing
        poses.append(Pose(np.array((3.0 + 0.4 * time, -2.0, 0.95)), turns))
    return poses


def recording(names: tuple[str, ...], seconds: float, seed: int) -> tuple[Body, list[Pose], Markers]:
    """Markers of somebody whose own are up to two centimetres from where the set has them."""
    generator = np.random.default_rng(seed)
    model = body_model()
    body = model.shaped(prior_of(model).likely(25, "female").sample(generator))
    landmarks = landmarks_of(tuple(spot for name in names if (spot := spot_of(name)) is not None), body)
    own = replace(landmarks, offsets=landmarks.offsets + generator.normal(0, 0.007, landmarks.offsets.shape))
    poses = moving(seconds)
    return body, poses, Markers(names, FITTED_HZ, np.array([body.landmarks_m(pose, own) for pose in poses]))


def fitted(markers: Markers) -> MarkerFit:
    model = body_model()
    return fit(markers, model, prior_of(model).likely(25))


def joint_errors_m(found: MarkerFit, body: Body, poses: list[Pose]) -> Float:
    """(T, 24)."""
    theirs = [found.body.joints_m(Pose(vector[:3], vector[3:].reshape(-1, 3))) for vector in found.poses]
    return np.asarray(np.linalg.norm(np.array(theirs) - [body.joints_m(pose) for pose in poses], axis=-1))


@pytest.mark.parametrize("size", [SMALL, pytest.param(LARGE, marks=pytest.mark.slow)], ids=("small", "large"))
@pytest.mark.parametrize("names", [PLUG_IN_GAIT, OPENCAP], ids=("plug_in_gait", "opencap"))
def test_every_marker_of_a_set_is_known_and_on_the_skin_of_its_side(size: str, names: tuple[str, ...]) -> None:
    model = body_model(size)
    body = model.shaped(prior_of(model).likely(25, "male").mean)
    spots = [spot_of(name) for name in names]
    assert None not in spots
    places = body.landmarks_m(Pose(np.zeros(3), np.zeros((smpl.COUNT, 3))), landmarks_of(tuple(s for s in spots if s), body))
    for name, place in zip(names, places, strict=True):
        assert np.linalg.norm(body.rest_vertices_m - place, axis=1).min() < 0.04
        if name not in {"C7", "T10", "CLAV", "STRN"}:
            assert (place[1] > 0) == (name[0] == "L"), name


@pytest.mark.slow
def test_a_fit_gives_shape_and_pose_back() -> None:
    body, poses, markers = recording(PLUG_IN_GAIT, 0.6, seed=3)
    found = fitted(markers)
    assert found.residual_mm < 1.5
    assert found.body.stature_m == pytest.approx(body.stature_m, abs=0.03)
    errors = joint_errors_m(found, body, poses)
    assert np.median(errors) < 0.010
    limbs = [smpl.INDEX[f"{side}_{joint}"] for side in ("left", "right") for joint in ("knee", "ankle", "elbow", "wrist")]
    assert errors[:, limbs].max() < 0.03


@pytest.mark.slow
def test_gaps_and_a_marker_that_flies_off_do_not_move_the_body() -> None:
    body, poses, markers = recording(OPENCAP, 0.6, seed=4)
    clean = joint_errors_m(fitted(markers), body, poses)
    spoilt = markers.positions_m.copy()
    spoilt[5:9, markers.names.index("r_toe")] = np.nan
    spoilt[12:16, markers.names.index("L_humerus")] += 0.3
    found = fitted(replace(markers, positions_m=spoilt))
    assert np.isnan(found.errors_m[5:9, found.names.index("r_toe")]).all()
    assert found.errors_m[13, found.names.index("L_humerus")] > 0.2
    assert np.abs(joint_errors_m(found, body, poses) - clean).max() < 0.015


def test_short_gaps_are_bridged_and_long_ones_stay() -> None:
    times = np.arange(200) / 100
    places = np.stack((np.sin(3 * times), times, np.ones_like(times)), axis=-1)[:, None]
    torn = places.copy()
    torn[50:60], torn[100:140], torn[190:] = np.nan, np.nan, np.nan
    filled = Markers(("C7",), 100.0, torn).filled()
    assert np.abs(filled[:100] - places[:100]).max() < 0.002
    assert np.isnan(filled[100:140]).all()
    assert np.isnan(filled[190:]).all()
    assert 40 / 100 > LONGEST_GAP_S > 11 / 100


def test_too_few_markers_are_refused_with_their_names() -> None:
    with pytest.raises(UserError, match="1 of the markers C7, nose are known, needed are 12"):
        fitted(Markers(("C7", "nose"), 100.0, np.zeros((3, 2, 3))))


def test_a_recording_that_begins_without_the_trunk_is_refused() -> None:
    markers = recording(PLUG_IN_GAIT, 0.2, seed=3)[2]
    hidden = markers.positions_m.copy()
    hidden[0] = np.nan
    with pytest.raises(UserError, match="first frame shows fewer than three markers of the trunk"):
        fitted(replace(markers, positions_m=hidden))


def known_fit(poses: list[Pose], body: Body) -> MarkerFit:
    names = ("C7",)
    vectors = np.array([pose.vector for pose in poses])
    return MarkerFit(body, FITTED_HZ, names, landmarks_of((spot_of("C7"),), body), vectors, np.zeros((len(poses), 1)))  # type: ignore[arg-type]


def test_a_replayed_motion_goes_through_every_frame_without_a_jump() -> None:
    model = body_model()
    body, poses = model.shaped(np.zeros(model.shape_count)), moving(1.2)
    motion = motion_of(known_fit(poses, body))
    assert motion.duration_s == pytest.approx((len(poses) - 1) / FITTED_HZ, abs=1 / RATE_HZ)
    joints = np.array([body.joints_m(motion.pose(number)) for number in range(len(motion.times_s))])
    truth = np.array([body.joints_m(pose) for pose in poses])
    for frame in range(0, len(poses) - 1, 5):  # five frames at 50 Hz are 24 poses
        assert np.abs(joints[frame * 24 // 5] - truth[frame]).max() < 1e-9
    peak = np.linalg.norm(np.diff(truth, axis=0), axis=-1).max() * FITTED_HZ
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() * RATE_HZ == pytest.approx(peak, rel=0.02)


def test_feet_that_are_still_bear_and_feet_that_fly_do_not() -> None:
    model = body_model()
    body = model.shaped(np.zeros(model.shape_count))
    heights = np.concatenate(
        (np.zeros(25), 1.5 * np.arange(20) / 50, np.full(3, 0.6), 0.6 - 1.5 * np.arange(20) / 50, np.zeros(25))
    )
    poses = [Pose(np.array((0.0, 0.0, 0.95 + height)), np.zeros((smpl.COUNT, 3))) for height in heights]
    contacts = motion_of(known_fit(poses, body)).contacts
    assert contacts[:100, :2].all()
    assert not contacts[130:310, :2].any()
    assert contacts[-100:, :2].all()
    assert not contacts[:, 2:].any()
