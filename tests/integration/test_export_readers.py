"""Exports as other programs read them: ezc3d, Khronos' validator, three.js. What they see must be where the pupil was."""

import json
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from services.evaluation.track import Track
from services.lesson.export import bvh, c3d, glb
from services.lesson.export.axes import FIGURES
from services.lesson.export.labels import LABELS
from services.lesson.export.take import Take
from tests.installed import ROOT
from tests.takes import moving, performed

ezc3d = pytest.importorskip("ezc3d", reason="there is no wheel of ezc3d for this processor")
WEB = ROOT / "services/tablet/web"
BONES = {
    "left_shoulder": "LeftArm",
    "right_elbow": "RightForeArm",
    "left_wrist": "LeftHand",
    "right_wrist": "RightHand",
    "left_hip": "LeftUpLeg",
    "right_knee": "RightLeg",
    "left_ankle": "LeftFoot",
    "right_ankle": "RightFoot",
    "nose": "Nose",
    "left_ear": "LeftEar",
}
SKIN_M = 0.03
"""Points of a skinned body are on it, and bones of the tree keep their lengths: so far apart they may be."""

needs_node = pytest.mark.skipif(not (WEB / "node_modules/gltf-validator").is_dir(), reason="the page's packages are not installed")


def node(script: str, *words: str) -> Any:
    done = subprocess.run(
        ["node", f"tests/exports/{script}", *words], cwd=WEB, capture_output=True, text=True, check=True, timeout=100
    )
    return json.loads(done.stdout)


def written(folder: Path, kind: ModuleType, take: Take) -> Path:
    file = folder / f"{take.name}{kind.SUFFIX}"
    file.write_bytes(kind.encode(take))
    return file


def half_unknown() -> Take:
    """The left wrist is gone from the tenth frame to the twentieth, the right ankle all the time."""
    whole = performed()
    states = whole.track.states.copy()
    states[9:20, coco.INDEX["left_wrist"]] = JointState.UNKNOWN
    states[:, coco.INDEX["right_ankle"]] = JointState.UNKNOWN
    return Take(Track(whole.track.t_s, whole.track.joints_m, whole.track.covariance_m2, states), "gaps", "P07", whole.attempts)


def test_ezc3d_reads_the_same_points_and_units_and_knows_which_are_unknown(tmp_path: Path) -> None:
    take = Take(moving(7, 50, 0.5), "motion", "P07")
    read = ezc3d.c3d(str(written(tmp_path, c3d, take)))
    point = read["parameters"]["POINT"]
    assert tuple(point["LABELS"]["value"]) == LABELS
    assert point["UNITS"]["value"] == ["mm"]
    assert point["RATE"]["value"] == [30.0]
    assert point["DESCRIPTIONS"]["value"][5] == "COCO keypoint left shoulder"
    assert read["parameters"]["SUBJECTS"]["NAMES"]["value"] == ["P07"]
    joints_m = np.moveaxis(read["data"]["points"][:3], 0, -1).swapaxes(0, 1) / 1000
    residuals = read["data"]["meta_points"]["residuals"][0].T
    known = take.known
    np.testing.assert_allclose(joints_m[known], take.track.joints_m[known], atol=1e-6)
    assert (residuals[~known] == -1).all()
    # Of floats it does not read the value, only the sign (its issue 386).
    assert (residuals[known] >= 0).all()


def test_ezc3d_finds_the_keyframes_as_events_at_their_times(tmp_path: Path) -> None:
    take = performed()
    event = ezc3d.c3d(str(written(tmp_path, c3d, take)))["parameters"]["EVENT"]
    assert event["USED"]["value"] == [4]
    assert event["LABELS"]["value"] == ["start", "exertion", "peak", "end"]
    assert event["DESCRIPTIONS"]["value"][0].strip() == "badminton_clear 1"
    minutes, seconds = event["TIMES"]["value"]
    np.testing.assert_allclose(60 * minutes + seconds, take.attempts[0].moments_s, atol=1e-5)


@pytest.mark.slow
@needs_node
@pytest.mark.parametrize("gaps", [False, True], ids=["all known", "gaps"])
def test_khronos_validator_finds_no_error_and_no_warning(tmp_path: Path, gaps: bool) -> None:
    report = node("validate.mjs", str(written(tmp_path, glb, half_unknown() if gaps else performed())))
    issues = report["issues"]
    assert (issues["numErrors"], issues["numWarnings"], issues["truncated"]) == (0, 0, False), issues["messages"]
    assert report["info"]["animationCount"] == 1
    assert 100 < report["info"]["totalTriangleCount"] < 300


def played(folder: Path, kind: ModuleType, take: Take) -> list[dict[str, list[float]]]:
    found: list[dict[str, list[float]]] = node(
        "play.mjs", str(written(folder, kind, take)), str(len(take.track)), str(take.rate_hz)
    )
    return found


@pytest.mark.slow
@needs_node
@pytest.mark.parametrize(("kind", "unit_m"), [(glb, 1.0), (bvh, 0.01)], ids=["glb", "bvh"])
def test_three_js_moves_the_figure_as_the_pupil_moved(tmp_path: Path, kind: ModuleType, unit_m: float) -> None:
    take = performed()
    frames = played(tmp_path, kind, take)
    for name, bone in BONES.items():
        there_m = np.array([frame[bone][:3] for frame in frames]) * unit_m
        truth_m = FIGURES.to(take.track.joints_m[:, coco.INDEX[name]])
        off_m = np.linalg.norm(there_m - truth_m, axis=1)
        assert off_m.max() < SKIN_M, f"{name} is off by {off_m.max():.3f} m"
        assert np.median(off_m) < SKIN_M / 3, name


@pytest.mark.slow
@needs_node
def test_a_limb_is_not_drawn_while_it_is_unknown_and_one_that_never_was_known_is_not_there(tmp_path: Path) -> None:
    frames = played(tmp_path, glb, half_unknown())
    drawn = [frame["LeftForeArm_shape"][3] for frame in frames]
    np.testing.assert_allclose(drawn[9:20], 0, atol=1e-9)
    np.testing.assert_allclose(drawn[:9] + drawn[20:], 1, atol=1e-6)
    assert "RightFoot" not in frames[0]
    assert "RightLeg_shape" not in frames[0]
    assert "RightUpLeg_shape" in frames[0]


def length_m(frames: list[dict[str, list[float]]], near: str, far: str) -> Float:
    return np.array([np.linalg.norm(np.subtract(frame[near][:3], frame[far][:3])) for frame in frames])


@pytest.mark.slow
@needs_node
def test_bones_keep_their_lengths_in_every_frame_and_gaps_keep_the_last_turn(tmp_path: Path) -> None:
    frames = played(tmp_path, bvh, half_unknown())
    for near, far in (("LeftArm", "LeftForeArm"), ("LeftForeArm", "LeftHand"), ("LeftUpLeg", "LeftLeg"), ("LeftLeg", "LeftFoot")):
        assert np.ptp(length_m(frames, near, far)) < 1e-3
    # In the gap the forearm goes on with the upper arm as one piece.
    assert np.ptp(length_m(frames[8:20], "LeftArm", "LeftHand")) < 1e-2
    assert np.ptp(length_m(frames, "LeftArm", "LeftHand")) > 1.0
