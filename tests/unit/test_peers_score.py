"""The ruler of the comparison with other systems, against closed forms."""

import numpy as np
import pytest

from models.messages.observation import Observation
from tests.bench.metrics.position import margin_pct
from tests.bench.peers.clips import FRAMES, make_clip
from tests.bench.peers.score import score_all
from tests.synthetic.gym import T0_NS

TRUTH = np.zeros((20, 13, 3))


def test_a_constant_offset_is_an_error_without_acceleration() -> None:
    joints = TRUTH + np.array((0.003, 0.004, 0.0))
    score = score_all({"a": joints}, {"a": TRUTH})["a"]
    assert score.mpjpe_mm == pytest.approx(5.0)
    assert score.p95_mm == pytest.approx(5.0)
    assert score.acc_error_mm == pytest.approx(0.0, abs=1e-9)


def test_a_parabola_has_its_second_difference_as_acceleration_error() -> None:
    joints = TRUTH.copy()
    joints[:, :, 2] = (0.001 * np.arange(20) ** 2)[:, None]
    assert score_all({"a": joints}, {"a": TRUTH})["a"].acc_error_mm == pytest.approx(2.0)


def test_nobody_gains_by_leaving_out_what_is_hard() -> None:
    bold = TRUTH.copy()
    bold[:, 0, 0] = 1.0
    shy = bold.copy()
    shy[:, 0] = np.nan
    scores = score_all({"bold": bold, "shy": shy}, {"bold": TRUTH, "shy": TRUTH})
    assert scores["bold"].mpjpe_mm == scores["shy"].mpjpe_mm == 0.0
    assert scores["shy"].missing_pct == pytest.approx(100 / 13)
    assert scores["bold"].missing_pct == 0.0


def test_a_frame_with_less_than_nine_joints_is_one_without_pose() -> None:
    joints = TRUTH.copy()
    joints[4, :5] = np.nan
    joints[5, :4] = np.nan
    assert score_all({"a": joints}, {"a": TRUTH})["a"].frames_without_pose == 1


def test_half_the_error_is_a_margin_of_fifty_percent() -> None:
    assert margin_pct(10.0, 20.0) == pytest.approx(50.0)


@pytest.mark.slow
def test_aligned_frames_are_of_one_instant_and_free_ones_of_the_mean_of_their_exposures() -> None:
    aligned, free = (make_clip("walk", 1, aligned=value) for value in (True, False))
    assert np.array_equal(aligned.times_ns[:3] - T0_NS, [0, 33333333, 66666667])
    assert np.abs(np.diff(aligned.times_ns) - 1e9 / 30).max() < 2
    assert len(aligned.keypoints) >= FRAMES - 4
    exact = np.stack([camera.project(aligned.gym.truth(T0_NS)) for camera in aligned.gym.rig])
    assert np.median(np.linalg.norm(aligned.keypoints.points_px[0] - exact, axis=-1)) < 10
    phases = np.array(free.gym.phases_s)
    assert np.ptp(phases) > 0.003
    # Where there is a frame before and after, the nearest is at most half a frame away from camera 0's.
    from_own = free.times_ns[1:-1] - T0_NS - 1e9 * (phases[0] + np.arange(1, len(free.times_ns) - 1) / 30)
    assert np.abs(from_own).max() <= 1e9 / 60
    assert np.ptp(from_own) < 10


def test_the_box_and_the_peers_are_given_the_same_keypoints() -> None:
    clip = make_clip("throw", 2, aligned=True)
    for event in clip.events:
        if isinstance(event, Observation) and event.frame < len(clip.keypoints):
            camera = clip.gym.rig.index(event.camera)
            assert abs(event.t_mid_ns - clip.times_ns[event.frame]) < 2
            assert np.array_equal(clip.keypoints.points_px[event.frame, camera], event.persons[0].keypoints_px)
