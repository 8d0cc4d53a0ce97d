"""The benchmarks' measures against closed forms, loops and other implementations: a wrong ruler makes every figure wrong."""

from itertools import permutations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial import procrustes
from scipy.spatial.transform import Rotation

from models.arrays import Bool, Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from tests.bench.boxes import inside
from tests.bench.metrics.alignment import aligned, pampjpe_mm
from tests.bench.metrics.bound import sigma_of_distances, triangulation_bound_m
from tests.bench.metrics.correctness import pck_auc_pct, pck_pct, right_parts
from tests.bench.metrics.limbs import limb_variation_pct
from tests.bench.metrics.position import margin_pct, position_error
from tests.bench.metrics.reprojection import reprojection_px, rmse
from tests.bench.metrics.retrieval import Retrieval, intervals, moments, one_to_one, pairs
from tests.bench.metrics.steadiness import (
    acceleration_error_mm,
    jitter_mm,
    largest_jump_mm,
    peak_speed_bias_pct,
    peak_speed_m_s,
)
from tests.property.test_camera_laws import camera
from tests.synthetic.gym import ring_rig

GENERATOR = np.random.default_rng(7)
TRUTH = GENERATOR.normal(size=(6, 17, 3))
FOUND = TRUTH + 0.02 * GENERATOR.normal(size=TRUTH.shape)


def test_mpjpe_is_the_mean_of_all_distances_by_an_explicit_loop() -> None:
    found = FOUND.copy()
    found[2, 3] = np.nan
    told = [
        sum((float(found[f, j, axis]) - float(TRUTH[f, j, axis])) ** 2 for axis in range(3)) ** 0.5
        for f in range(6)
        for j in range(17)
        if (f, j) != (2, 3)
    ]
    error = position_error(found, TRUTH)
    assert error.mpjpe_mm == pytest.approx(1e3 * sum(told) / len(told))
    assert error.p95_mm == pytest.approx(1e3 * float(np.quantile(told, 0.95)))
    assert error.count == len(told) == 6 * 17 - 1
    assert error.missing_pct == pytest.approx(100 / (6 * 17))


def test_frames_without_a_pose_are_named_and_their_joints_still_count() -> None:
    found = TRUTH.copy()
    found[1] = np.nan
    found[4, :9] = np.nan  # eight joints are left
    found[5, :8] = np.nan  # nine are a pose
    found[4, 16] += (0.0, 0.3, 0.4)
    error = position_error(found, TRUTH)
    assert error.without_pose == (1, 4)
    assert error.mpjpe_mm == pytest.approx(500 / error.count)


def test_a_truth_of_few_joints_asks_for_those() -> None:
    truth = TRUTH.copy()
    truth[:, :9] = np.nan
    found = truth.copy()
    found[4, 9] = np.nan
    error = position_error(found, truth)
    assert error.without_pose == (4,)
    assert error.missing_pct == pytest.approx(100 / (6 * 8))


def test_nothing_to_measure_is_no_number_and_not_zero() -> None:
    nothing = np.full((4, 17, 3), np.nan)
    error = position_error(nothing, TRUTH[:4])
    assert np.isnan(error.mpjpe_mm)
    assert error.without_pose == (0, 1, 2, 3)
    assert np.isnan([pampjpe_mm(nothing, TRUTH[:4]), jitter_mm(nothing), largest_jump_mm(nothing)]).all()
    assert np.isnan([peak_speed_m_s(nothing[:, 0], 30.0), rmse(nothing), sigma_of_distances(nothing)]).all()


def test_half_the_error_is_a_margin_of_fifty_percent() -> None:
    assert margin_pct(10.0, 20.0) == pytest.approx(50.0)


def test_aligned_agrees_with_scipys_procrustes_where_no_reflection_is_wanted() -> None:
    for found, truth in zip(FOUND, TRUTH, strict=True):
        left, right, disparity = procrustes(truth, found)
        ours = aligned(found, truth)
        size = np.linalg.norm(truth - truth.mean(axis=0))
        assert np.square(ours - truth).sum() / size**2 == pytest.approx(disparity)
        np.testing.assert_allclose((ours - truth.mean(axis=0)) / size, right, atol=1e-9)
        assert left.shape == truth.shape


def test_aligned_is_the_least_squares_similarity_also_where_a_reflection_would_fit_better() -> None:
    truth = TRUTH[0] * (1.0, 2.0, 3.0)
    found = truth * (1.0, 1.0, -1.0) + 0.01 * FOUND[1]

    def residual(parameters: Float) -> Float:
        turned: Float = np.exp(parameters[0]) * Rotation.from_rotvec(parameters[1:4]).apply(found) + parameters[4:]
        return np.asarray((turned - truth).ravel())

    starts = Rotation.random(12, rng=np.random.default_rng(0)).as_rotvec()
    costs = [least_squares(residual, np.concatenate(([0.0], start, np.zeros(3)))).cost for start in starts]
    assert 0.5 * np.square(aligned(found, truth) - truth).sum() == pytest.approx(min(costs), rel=1e-6)
    assert pampjpe_mm(found[None], truth[None]) > 100, "a mirrored person is another pose"


def test_joints_that_are_missing_take_no_part_in_the_alignment() -> None:
    truth = TRUTH[:1]
    found = 1.3 * truth @ Rotation.from_rotvec((0.2, -1.0, 0.5)).as_matrix().T + 4.0
    found[0, 3] = np.nan
    assert pampjpe_mm(found, truth) == pytest.approx(0.0, abs=1e-9)
    found[0, 3:] = np.nan
    assert np.isnan(pampjpe_mm(found, truth)), "three points can be laid upon nearly anything"


def test_pck_counts_what_is_missing_as_wrong_and_its_area_is_the_integral_over_tolerances() -> None:
    distance = np.array([0.0, 10.0, 40.0, 60.0, np.nan])
    assert pck_pct(distance, 50.0) == pytest.approx(60.0)
    tolerances = np.linspace(0, 50, 20001)
    sampled = np.trapezoid([pck_pct(distance, within) for within in tolerances], tolerances) / 50
    assert pck_auc_pct(distance, 50.0) == pytest.approx(sampled, abs=0.01)
    assert pck_auc_pct(distance, 50.0) == pytest.approx(100 * (1 + 0.8 + 0.2 + 0 + 0) / 5)


def test_a_part_is_right_if_the_mean_of_its_ends_is_within_half_its_length() -> None:
    truth = np.array(((0.0, 0, 0), (0, 0, 0.4), (0, 0, 1.0)))
    found = truth.copy()
    found[1, 0] = 0.39
    ends = np.array(((0, 1), (1, 2)))
    assert right_parts(found, truth, ends).tolist() == [True, True]  # 0.195 of 0.20 and of 0.30
    found[1, 0] = 0.41
    assert right_parts(found, truth, ends).tolist() == [False, True]
    found[2] = np.nan
    assert right_parts(found, truth, ends).tolist() == [False, False]


def test_acceleration_jitter_and_jumps_by_explicit_loops() -> None:
    error = FOUND - TRUTH
    second = [np.linalg.norm(error[f + 1, j] - 2 * error[f, j] + error[f - 1, j]) for f in range(1, 5) for j in range(17)]
    assert acceleration_error_mm(FOUND, TRUTH) == pytest.approx(1e3 * sum(second) / len(second))
    steps = [np.linalg.norm(FOUND[f + 1, j] - FOUND[f, j]) for f in range(5) for j in range(17)]
    assert largest_jump_mm(FOUND) == pytest.approx(1e3 * max(steps))


def test_free_fall_has_its_second_difference_as_jitter() -> None:
    fall = np.zeros((20, 2, 3))
    fall[:, :, 2] = (-0.5 * 9.81 * (np.arange(20) / 30) ** 2)[:, None]
    assert jitter_mm(fall) == pytest.approx(9810 / 900)
    fall[7] = np.nan  # three triples are lost, none is invented
    assert jitter_mm(fall) == pytest.approx(9810 / 900)


def test_peak_speed_of_a_uniform_motion_is_its_speed_and_of_a_swing_that_of_its_middle() -> None:
    line = np.arange(20)[:, None] * np.array((0.1, 0.0, 0.0))
    assert peak_speed_m_s(line, 30.0) == pytest.approx(3.0)
    t_s = np.arange(-300, 301) / 1000
    swing = np.column_stack((np.sin(5 * t_s), np.zeros((601, 2))))
    assert peak_speed_m_s(swing, 1000.0) == pytest.approx(5.0, rel=1e-4)
    assert peak_speed_bias_pct(0.9 * swing, swing, 1000.0) == pytest.approx(-10.0)


def test_a_perfect_reconstruction_has_no_reprojection_error() -> None:
    ours = camera()
    joints = np.random.default_rng(0).uniform(-0.5, 0.5, (4, 17, 3))
    points = ours.project(joints)[:, None]
    assert np.allclose(reprojection_px(Rig((ours,)), joints, points, np.ones((4, 1, 17)), min_score=0.3), 0)


def test_reprojection_is_measured_in_pixels_and_leaves_out_low_scores() -> None:
    ours = camera()
    joints = np.zeros((1, 17, 3))
    points = ours.project(joints)[:, None] + np.array((3.0, 4.0))
    scores = np.full((1, 1, 17), 0.2)
    scores[0, 0, 5] = 0.3
    distance = reprojection_px(Rig((ours,)), joints, points, scores, min_score=0.3)
    assert distance[0, 0, 5] == pytest.approx(5.0)
    assert np.isnan(distance).sum() == 16
    assert rmse(np.array((3.0, 4.0, np.nan))) == pytest.approx(np.sqrt(12.5))


def test_rigid_limbs_do_not_vary_and_a_breathing_one_does() -> None:
    joints = np.random.default_rng(1).uniform(-1, 1, (1, 17, 3)).repeat(50, axis=0)
    assert max(limb_variation_pct(joints).values()) < 1e-9
    joints[:, 9] = joints[:, 7] + np.array((0.25, 0, 0))
    joints[::2, 9] = joints[::2, 7] + np.array((0.35, 0, 0))
    assert limb_variation_pct(joints)["left_forearm"] == pytest.approx(100 * 0.05 / 0.30)


def most_pairs(allowed: Bool) -> int:
    """By trying all."""
    if allowed.shape[0] > allowed.shape[1]:
        allowed = allowed.T
    rows, columns = allowed.shape
    return max((int(allowed[np.arange(rows), list(order)].sum()) for order in permutations(range(columns), rows)), default=0)


def test_one_to_one_finds_the_most_pairs_there_are() -> None:
    generator = np.random.default_rng(3)
    for _ in range(60):
        allowed = generator.random(generator.integers(0, 6, 2)) < 0.35
        found = one_to_one(allowed)
        assert found == Retrieval(most_pairs(allowed), *allowed.shape)


def test_two_keyframes_found_near_one_true_one_are_one_right_and_one_false() -> None:
    found = moments([1.00, 1.05, 3.0], [1.02, 2.0], 0.1)
    assert found == Retrieval(1, 3, 2)
    assert found.precision_pct == pytest.approx(100 / 3)
    assert found.recall_pct == pytest.approx(50.0)
    assert found.f1 == pytest.approx(2 * (1 / 3) * 0.5 / (1 / 3 + 0.5))
    assert (found + Retrieval(1, 1, 1)) == Retrieval(2, 4, 3)
    assert moments([1.0 + 3 / 32], [1.0], 3 / 32).right == 1, "three frames away is within three frames"


def test_an_attempt_is_found_where_half_of_either_is_common() -> None:
    assert intervals([(0, 2)], [(1, 3)]).right == 0  # a third
    assert intervals([(0, 2)], [(0.5, 2.5)]).right == 1  # 1.5 of 2.5
    assert intervals([(0, 4)], [(0, 1.9), (2.1, 4)]) == Retrieval(0, 1, 2)
    assert intervals([], [(0, 1)]).recall_pct == 0.0
    assert np.isnan(intervals([], [(0, 1)]).precision_pct)
    assert np.isnan(Retrieval(0, 0, 0).f1)


def test_precision_and_recall_of_matches() -> None:
    found = pairs({(0, 0), (1, 2), (3, 3)}, {(0, 0), (1, 1), (3, 3), (4, 4)})
    assert found.precision_pct == pytest.approx(200 / 3)
    assert found.recall_pct == pytest.approx(50.0)


def facing(name: str, rotation: Float, distance_m: float) -> Camera:
    matrix = np.array(((1000.0, 0, 500), (0, 1000, 500), (0, 0, 1)))
    return Camera(name, (1000, 1000), matrix, np.zeros(5), rotation, np.array((0.0, 0, distance_m)), np.zeros(2))


def test_the_bound_of_two_cameras_at_right_angles_has_a_closed_form() -> None:
    along_y = np.array(((1.0, 0, 0), (0, 0, -1), (0, 1, 0)))
    along_x = np.array(((0.0, 1, 0), (0, 0, -1), (-1, 0, 0)))
    rig = Rig((facing("a", along_y, 5.0), facing("b", along_x, 5.0)))
    # One pixel is 5 mm. Across: each camera measures its own axis once; upwards both measure.
    bound = triangulation_bound_m(rig, np.zeros(3), np.full(2, 2.0), np.ones(2, np.bool_))
    assert bound == pytest.approx(0.010 * np.sqrt(1 + 1 + 0.5))
    assert np.isnan(triangulation_bound_m(rig, np.zeros(3), np.full(2, 2.0), np.array((True, False))))
    twice = Rig((facing("a", along_y, 5.0), facing("c", along_y, 8.0)))
    assert np.isnan(triangulation_bound_m(twice, np.zeros(3), np.ones(2), np.ones(2, np.bool_))), "both look along one line"


@pytest.mark.slow
def test_the_bound_is_what_the_best_estimator_of_a_point_reaches() -> None:
    rig, point = ring_rig(4), np.array((0.3, -0.2, 1.1))
    sigmas = np.array((1.0, 2.0, 3.0, 1.5))
    exact = np.stack([camera.project_undistorted(point) for camera in rig])
    generator = np.random.default_rng(5)

    def error_m() -> float:
        seen = exact + sigmas[:, None] * generator.normal(size=(4, 2))

        def residual(guess: Float) -> Float:
            projected = np.stack([camera.project_undistorted(guess) for camera in rig])
            return np.asarray(((projected - seen) / sigmas[:, None]).ravel())

        return float(np.linalg.norm(least_squares(residual, point, method="lm").x - point))

    reached = np.sqrt(np.mean([error_m() ** 2 for _ in range(300)]))
    bound = float(triangulation_bound_m(rig, point, sigmas, np.ones(4, np.bool_)))
    assert reached == pytest.approx(bound, rel=0.1)


def test_sigma_of_distances_is_that_of_a_gaussian_and_blind_to_outliers() -> None:
    distance = np.linalg.norm(3.0 * np.random.default_rng(2).normal(size=(20000, 2)), axis=1)
    assert sigma_of_distances(distance) == pytest.approx(3.0, rel=0.02)
    assert sigma_of_distances(np.append(distance, [1e6] * 200)) == pytest.approx(3.0, rel=0.04)


def test_points_on_the_border_of_a_box_are_inside() -> None:
    assert inside(np.array(((0.0, 0.0), (10.0, 5.0), (10.1, 5.0))), np.array((0.0, 0.0, 10.0, 5.0))).tolist() == [True, True, False]
