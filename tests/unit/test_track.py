"""Tracks: what is unknown stays unknown, and frames stand where their time says."""

import numpy as np
import pytest

from models.messages.motion import CameraUse, JointState, Motion
from models.skeleton import coco
from services.evaluation.track import Track, known_track, track_of

FRAME_S = 1 / 30
FRAME_NS = round(1e9 * FRAME_S)


def motion(frame: int, unknown: tuple[int, ...] = (), epoch: int = 0, late_ns: int = 0) -> Motion:
    joints = np.full((coco.COUNT, 3), float(frame), np.float32)
    states = np.full(coco.COUNT, JointState.SEEN, np.uint8)
    states[list(unknown)] = JointState.UNKNOWN
    joints[list(unknown)] = 0.0
    t_ns = 5_000_000_000 + frame * FRAME_NS + late_ns
    covariance = np.tile(np.eye(3, dtype=np.float32) * 1e-4, (coco.COUNT, 1, 1))
    views = np.full(coco.COUNT, 3, np.uint32)
    return Motion("smooth", frame, epoch, t_ns, t_ns, t_ns, joints, covariance, states, views, (CameraUse("cam01", True, 5.0),))


def test_a_missing_frame_is_unknown_and_the_next_stands_at_its_own_time() -> None:
    track = track_of([motion(0), motion(1), motion(4)], FRAME_S)
    assert len(track) == 5
    assert np.isnan(track.joints_m[2:4]).all()
    assert (track.states[2:4] == JointState.UNKNOWN).all()
    assert (track.joints_m[4] == 4.0).all()
    assert track.t_s[4] == pytest.approx(5.0 + 4 * FRAME_S)


def test_an_unknown_joint_is_nan_and_not_the_origin() -> None:
    track = track_of([motion(0, unknown=(9,)), motion(1)], FRAME_S)
    assert np.isnan(track.joints_m[0, 9]).all()
    assert np.isnan(track.covariance_m2[0, 9]).all()
    assert not track.seen[0, 9]
    assert track.seen[1].all()


@pytest.mark.parametrize(
    "motions",
    [
        pytest.param([], id="none"),
        pytest.param([motion(0), motion(1, epoch=1)], id="two epochs"),
        pytest.param([motion(1), motion(0)], id="backwards"),
        pytest.param([motion(0), motion(1, late_ns=FRAME_NS // 2)], id="beside the grid"),
    ],
)
def test_motions_that_are_no_stretch_are_refused(motions: list[Motion]) -> None:
    with pytest.raises(ValueError, match="track"):
        track_of(motions, FRAME_S)


def test_a_part_keeps_its_times() -> None:
    track = known_track(np.zeros((10, coco.COUNT, 3)), FRAME_S)
    part = track.part(3, 7)
    assert len(part) == 4
    assert part.t_s[0] == track.t_s[3]
    assert track.frame_at(float(track.t_s[3])) == pytest.approx(3.0)


def test_a_recording_with_holes_says_what_is_not_known() -> None:
    joints = np.zeros((4, coco.COUNT, 3))
    joints[1, 2, 0] = np.nan
    track = known_track(joints, FRAME_S, sigma_m=0.01)
    assert np.isnan(track.joints_m[1, 2]).all()
    assert track.covariance_m2[0, 0, 0, 0] == pytest.approx(1e-4)
    assert track.seen.sum() == 4 * coco.COUNT - 1


def test_uneven_frames_are_refused() -> None:
    even = known_track(np.zeros((4, coco.COUNT, 3)), FRAME_S)
    with pytest.raises(ValueError, match="evenly"):
        Track(np.array([0.0, 1.0, 2.0, 4.0]), even.joints_m, even.covariance_m2, even.states)
