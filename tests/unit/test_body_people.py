"""The people of the shipped body: as tall and heavy as people of their age, and jointed as people are."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Float
from models.body.kinematics import place_joints
from models.body.limits import CHILD_WIDER_DEGREES, excess_rad, limits_rad
from models.body.masses import SEGMENTS, centre_of_mass_m, mass_shares, segment_centres_m
from models.body.model import Body
from models.body.pose import Pose, mirrored, t_pose
from models.body.prior import Sex
from models.skeleton import coco, coco_feet, smpl
from tests.bodies import LARGE, SMALL, body_model, prior_of, someone


def mean_body(age_years: float, sex: Sex, name: str = LARGE) -> Body:
    model = body_model(name)
    return model.shaped(prior_of(model).likely(age_years, sex).mean)


@pytest.mark.parametrize(
    ("sex", "age_years", "stature_m", "mass_kg"),
    [("male", 9, 1.357, 31), ("female", 9, 1.317, 28), ("male", 30, 1.779, 70)],
)
def test_usual_people_are_as_tall_and_heavy_as_measured_on_the_full_model(
    sex: Sex, age_years: float, stature_m: float, mass_kg: float
) -> None:
    body = mean_body(age_years, sex)
    assert body.stature_m == pytest.approx(stature_m, abs=0.02)
    assert body.mass_kg == pytest.approx(mass_kg, rel=0.05)


WHO_MEDIAN_M = {
    "male": {5: 1.103, 7: 1.217, 9: 1.326, 11: 1.431, 13: 1.560, 15: 1.690, 16: 1.729, 17: 1.752, 18: 1.761},
    "female": {5: 1.096, 7: 1.208, 9: 1.325, 11: 1.450, 13: 1.564, 15: 1.617, 16: 1.625, 17: 1.629, 18: 1.631},
}
"""WHO Growth Reference 2007, height for age, 5-19 years, medians."""


@pytest.mark.parametrize("sex", ["male", "female"])
def test_children_grow_within_eight_centimetres_of_the_who_medians(sex: Sex) -> None:
    for age_years, stature_m in WHO_MEDIAN_M[sex].items():
        assert mean_body(age_years, sex, SMALL).stature_m == pytest.approx(stature_m, abs=0.08), age_years


@pytest.mark.parametrize("stature_m", [1.20, 1.35, 1.50])
@pytest.mark.parametrize("sex", ["male", "female", None])
def test_a_measured_stature_is_met_and_leaves_a_child(stature_m: float, sex: Sex | None) -> None:
    model = body_model()
    likely = prior_of(model).likely(9.5, sex, stature_m)
    assert model.shaped(likely.mean).stature_m == pytest.approx(stature_m, abs=0.012)
    assert 15 < model.shaped(likely.mean).mass_kg < 60
    spread = [model.shaped(likely.sample(np.random.default_rng(seed))).stature_m for seed in range(40)]
    assert np.std(spread) < 0.02


def test_drawn_people_spread_as_the_prior_says() -> None:
    likely = prior_of(body_model()).likely(12.3, "female")
    drawn = np.array([likely.sample(np.random.default_rng(seed)) for seed in range(4000)])
    sigmas = np.sqrt(np.diag(likely.covariance))
    assert np.allclose(drawn.mean(0), likely.mean, atol=4 * sigmas / np.sqrt(4000))
    assert np.mean([likely.distance(shape) ** 2 for shape in drawn]) == pytest.approx(len(likely.mean), rel=0.05)


def test_ages_between_the_tables_rows_are_between_them_and_others_are_refused() -> None:
    prior = prior_of(body_model())
    low, middle, high = (prior.likely(age, "male") for age in (8, 8.5, 9))
    assert np.allclose(middle.mean, (low.mean + high.mean) / 2)
    assert np.array_equal(prior.likely(65, "male").mean, prior.means[0, -1])
    for age in (4.9, 65.1):
        with pytest.raises(ValueError, match="age_years is"):
            prior.likely(age)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_both_resolutions_are_the_same_person(seed: int) -> None:
    shape = someone(body_model(), seed)
    small, large = (body_model(name).shaped(shape) for name in (SMALL, LARGE))
    pose = Pose(np.zeros(3), np.random.default_rng(seed).normal(0, 0.5, (smpl.COUNT, 3)))
    assert np.allclose(small.joints_m(pose), large.joints_m(pose), atol=1e-9)
    apart = np.linalg.norm(small.coco_m(pose) - large.coco_m(pose), axis=1)
    assert apart.mean() < 0.5e-3
    assert apart.max() < 3e-3
    assert small.stature_m == pytest.approx(large.stature_m, abs=4e-3)
    assert small.volume_m3 == pytest.approx(large.volume_m3, rel=0.02)


def test_coco_points_are_where_a_person_has_them() -> None:
    body = mean_body(9, "female")
    points, joints = body.coco_m(t_pose()), body.rest_joints_m
    at = dict(zip(coco_feet.NAMES, points, strict=True))
    assert at["nose"][0] > at["left_eye"][0] > at["left_ear"][0]
    assert at["left_eye"][2] > at["nose"][2] > at["left_shoulder"][2] > at["left_hip"][2] > at["left_knee"][2] > at["left_ankle"][2]
    assert at["left_big_toe"][0] > at["left_small_toe"][0] > at["left_heel"][0]
    assert at["left_small_toe"][1] > at["left_big_toe"][1] > 0 > at["right_big_toe"][1]
    for name in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle"):
        for side in ("left", "right"):
            apart = np.linalg.norm(at[f"{side}_{name}"] - joints[smpl.INDEX[f"{side}_{name}"]])
            assert apart < 0.06, f"{side}_{name}"
    assert coco_feet.NAMES[: coco.COUNT] == coco.NAMES


def test_in_the_t_pose_limbs_lie_along_the_axes() -> None:
    joints = mean_body(12, "male").rest_joints_m
    for names, axis in (
        (("left_shoulder", "left_elbow", "left_wrist", "left_hand"), (0.0, 1.0, 0.0)),
        (("right_hip", "right_knee", "right_ankle"), (0.0, 0.0, -1.0)),
    ):
        for near, far in pairwise(names):
            bone = joints[smpl.INDEX[far]] - joints[smpl.INDEX[near]]
            assert np.allclose(bone / np.linalg.norm(bone), axis, atol=0.03), near


def bend(joint: str, axis: int, degrees: float) -> Pose:
    rotations = np.zeros((smpl.COUNT, 3))
    rotations[smpl.INDEX[joint], axis] = np.radians(degrees)
    return Pose(np.zeros(3), rotations)


@pytest.mark.parametrize(
    ("joint", "axis", "degrees", "point", "direction"),
    [
        ("left_elbow", 2, -90, "left_wrist", (1, 0, 0)),
        ("left_shoulder", 0, -80, "left_wrist", (0, 0, -1)),
        ("left_shoulder", 2, -90, "left_wrist", (1, 0, 0)),
        ("left_hip", 1, -90, "left_ankle", (1, 0, 0)),
        ("left_hip", 0, 40, "left_ankle", (0, 1, 0)),
        ("left_knee", 1, 90, "left_ankle", (-1, 0, 0)),
        ("left_ankle", 1, -20, "left_big_toe", (0, 0, 1)),
        ("spine1", 1, 30, "nose", (1, 0, 0)),
    ],
)
def test_joints_bend_the_way_their_limits_say_and_no_further(
    joint: str, axis: int, degrees: float, point: str, direction: tuple[int, int, int]
) -> None:
    body, pose, limits = mean_body(30, "female"), bend(joint, axis, degrees), limits_rad(30)
    moved = body.coco_m(pose) - body.coco_m(t_pose())
    assert moved[coco_feet.INDEX[point]] @ np.array(direction) > 0.03
    for allowed in (pose, mirrored(pose)):
        assert not excess_rad(allowed.rotations_rad, limits).any()
    too_far = bend(joint, axis, 3.0 * degrees if abs(degrees) < 60 else 2.2 * degrees)
    for forbidden in (too_far, mirrored(too_far)):
        excess = excess_rad(forbidden.rotations_rad, limits)
        assert np.count_nonzero(excess) == 1
        assert np.sign(excess.sum()) == np.sign(forbidden.rotations_rad.sum())


def test_children_bend_further_and_the_pelvis_turns_freely() -> None:
    child, adult = limits_rad(6), limits_rad(30)
    assert np.allclose(np.degrees(child[1:, :, 1] - adult[1:, :, 1]), CHILD_WIDER_DEGREES)
    assert np.array_equal(child[0], adult[0])
    assert (adult[:, :, 0] < 0).all()
    assert (adult[:, :, 1] > 0).all()


@pytest.mark.parametrize("sex", ["male", "female"])
def test_a_childs_head_weighs_more_and_its_legs_less_than_an_adults(sex: Sex) -> None:
    ages = [5, 6, 9, 12, 15, 20, 40]
    shares = np.array([mass_shares(age, sex) for age in ages])
    assert np.allclose(shares.sum(1), 1.0)
    assert (np.diff(shares[1:5, SEGMENTS.index("head")]) < 0).all()
    assert (np.diff(shares[1:5, SEGMENTS.index("left_thigh")]) > 0).all()
    assert np.array_equal(shares[0], shares[1])
    assert np.array_equal(shares[-1], shares[-2])
    assert mass_shares(40, "male")[SEGMENTS.index("right_thigh")] == pytest.approx(0.1416, abs=1e-3)


@pytest.mark.parametrize(("age_years", "sex"), [(6, "male"), (9, "female"), (12, "male"), (30, "male"), (30, "female")])
def test_the_centre_of_mass_from_joints_is_the_mesh_volumes(age_years: float, sex: Sex) -> None:
    body = mean_body(age_years, sex)
    squat = np.zeros((smpl.COUNT, 3))
    for side in ("left", "right"):
        squat[smpl.INDEX[f"{side}_hip"], 1] = -1.6
        squat[smpl.INDEX[f"{side}_knee"], 1] = 1.9
        squat[smpl.INDEX[f"{side}_shoulder"], 2] = -1.4 if side == "left" else 1.4
    for pose in (t_pose(), Pose(np.zeros(3), squat)):
        by_volume = volume_centre(body.vertices_m(pose), body.model.faces)
        by_segments = centre_of_mass_m(body.joints_m(pose), body.coco_m(pose), age_years, sex)
        assert np.linalg.norm(by_segments - by_volume) < 0.035 * body.stature_m


def volume_centre(vertices: Float, faces: np.ndarray) -> Float:
    """Centroid of a closed mesh: tetrahedra from the origin."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    volumes = np.sum(a * np.cross(b, c), axis=1)
    return np.asarray(volumes @ (a + b + c) / (4 * volumes.sum()))


def test_segments_have_their_centres_on_their_own_side_and_mirror() -> None:
    body = mean_body(10, "male")
    centres = segment_centres_m(body.rest_joints_m, body.coco_m(t_pose()), "male")
    for left, right in zip(range(2, len(SEGMENTS), 2), range(3, len(SEGMENTS), 2), strict=True):
        assert np.allclose(centres[left] * (1, -1, 1), centres[right], atol=1e-4)
        assert centres[left, 1] > 0.03


def test_forward_kinematics_agrees_with_a_chain_of_matrices() -> None:
    body = mean_body(10, "male", SMALL)
    rotations = np.random.default_rng(0).normal(0, 0.8, (smpl.COUNT, 3))
    places, world, _ = place_joints(np.array(smpl.PARENTS), body.rest_joints_m, np.array((1.0, 2.0, 3.0)), rotations)
    chain: list[tuple[Float, Rotation]] = []
    for joint, parent in enumerate(smpl.PARENTS):
        own = Rotation.from_rotvec(rotations[joint])
        if parent < 0:
            chain.append((np.array((1.0, 2.0, 3.0)), own))
        else:
            place, turn = chain[parent]
            chain.append((place + turn.apply(body.rest_joints_m[joint] - body.rest_joints_m[parent]), turn * own))
    assert np.allclose(places, [place for place, _ in chain])
    assert np.allclose(world, [turn.as_matrix() for _, turn in chain])
