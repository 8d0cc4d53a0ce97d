"""Fusion against the synthetic gym's ground truth. Bounds are about a quarter above what was measured."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from models.arrays import Bool, Float
from models.messages.motion import JointState
from models.skeleton import coco
from services.fusion.pipeline import Tick
from services.fusion.views import Views, sightings
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.play import DEFAULT, Played, after, errors_mm, nees, play

pytestmark = pytest.mark.slow

FAULTY = Gym(seconds=10.0)
CLEAN = FAULTY.quiet()
FAST = Gym(seconds=10.0, rates_hz=(30.0,)).quiet()


@cache
def _played(gym: Gym) -> Played:
    return play(gym.rig, gym.events())


def _dlt(projections: Float, points: Float, usable: Bool) -> Float:
    """Unweighted linear triangulation of all joints (Hartley and Zisserman, 12.2): the baseline."""
    out = np.full((coco.COUNT, 3), np.nan)
    for joint in range(coco.COUNT):
        rows = [
            points[c, joint, axis] * projections[c, 2] - projections[c, axis]
            for c in range(len(projections))
            if usable[c, joint]
            for axis in (0, 1)
        ]
        if len(rows) >= 4:
            solution = np.linalg.svd(np.array(rows))[2][-1]
            out[joint] = solution[:3] / solution[3]
    return out


def _dlt_errors_mm(gym: Gym) -> Float:
    """DLT on each camera's newest keypoints at every tick, compared with the truth at their mean time."""
    views = Views.of(gym.rig)
    newest: dict[int, tuple[int, Float, Bool]] = {}
    rows = []
    for event in gym.events():
        if not isinstance(event, Tick):
            (person,) = sightings(event, views, DEFAULT.sighting)
            newest[person.camera] = (event.t_mid_ns, person.points_px, person.usable)
        elif len(newest) == len(views) and event.t_ns > T0_NS + 1_000_000_000:
            times, points, usable = zip(*(newest[c] for c in range(len(views))), strict=True)
            found = _dlt(views.projections, np.array(points), np.array(usable))
            rows.append(np.linalg.norm(found - gym.truth(round(float(np.mean(times)))), axis=1) * 1e3)
    return np.array(rows)


def test_smooth_error_is_a_fraction_of_dlt_despite_swaps_distractors_and_occlusion() -> None:
    smooth = np.nanmean(errors_mm(after(_played(FAULTY).smooth, 1.0), FAULTY.truth))
    assert smooth < 18.0
    assert smooth < 0.4 * np.nanmean(_dlt_errors_mm(FAULTY))


def test_live_error_with_faults() -> None:
    live = errors_mm(after(_played(FAULTY).live, 1.0), FAULTY.truth)
    assert np.nanmean(live) < 40.0
    assert np.nanpercentile(live, 95) < 90.0


def test_smooth_error_without_faults() -> None:
    assert np.nanmean(errors_mm(after(_played(CLEAN).smooth, 1.0), CLEAN.truth)) < 15.0
    assert np.nanmean(errors_mm(after(_played(FAST).smooth, 1.0), FAST.truth)) < 10.5


def test_every_joint_is_seen_and_in_every_instant() -> None:
    for motions in (after(_played(FAULTY).live, 1.0), after(_played(FAULTY).smooth, 1.0)):
        states = np.array([motion.states for motion in motions])
        assert (states == JointState.SEEN).mean() > 0.99


@pytest.mark.parametrize("gym", [CLEAN, FAST], ids=["10-15 Hz", "30 Hz"])
def test_covariance_is_honest(gym: Gym) -> None:
    for motions in (_played(gym).live, _played(gym).smooth):
        assert 1.2 < np.median(nees(after(motions, 1.0), gym.truth)) < 3.5


def test_nothing_is_pulled_to_one_side() -> None:
    motions = after(_played(FAST).smooth, 1.0)
    error = np.array([motion.joints_m - FAST.truth(motion.t_ns) for motion in motions])
    assert np.abs(np.median(error, axis=0)).max() < 0.004


def test_smoothing_does_not_flatten_a_throw() -> None:
    """Exact keypoints that are reported as noisy: what is lost of the peak is the smoother's doing."""
    gym = replace(FAST, noise_px=0.0)
    wrist = coco.INDEX["right_wrist"]
    motions = after(_played(gym).smooth, 1.0)
    ours = np.array([motion.joints_m[wrist] for motion in motions], np.float64)
    true = np.array([gym.truth(motion.t_ns)[wrist] for motion in motions])
    speed, true_speed = (np.linalg.norm(np.diff(path, axis=0), axis=1) for path in (ours, true))
    period = 48
    for begin in range(0, len(true_speed) - period, period):
        peak = begin + int(true_speed[begin : begin + period].argmax())
        assert true_speed[peak] * 30 > 7.0
        assert speed[max(peak - 3, 0) : peak + 4].max() == pytest.approx(true_speed[peak], rel=0.03)


def test_limbs_keep_their_length() -> None:
    joints = np.array([motion.joints_m for motion in after(_played(FAULTY).smooth, 1.0)])
    for a, b in coco.LIMBS.values():
        length = np.linalg.norm(joints[:, a] - joints[:, b], axis=1)
        assert length.std() / length.mean() < 0.07
        true = np.linalg.norm(FAULTY.truth(T0_NS)[a] - FAULTY.truth(T0_NS)[b])
        assert np.median(length) == pytest.approx(true, rel=0.03)


def test_lag_and_grid_are_what_they_are_said_to_be() -> None:
    frame_ns = 1e9 / 30
    for output, event in zip(_played(CLEAN).outputs, CLEAN.events(), strict=True):
        for motion in output.motions:
            assert isinstance(event, Tick)
            if motion.kind == "live":
                assert abs(event.t_ns - motion.t_ns - 2 * frame_ns) < 2
            else:
                assert abs(motion.t_ns / frame_ns - round(motion.t_ns / frame_ns)) < 1e-6
                assert 7 * frame_ns - 2 <= event.t_ns - motion.t_ns < 8 * frame_ns + 2
