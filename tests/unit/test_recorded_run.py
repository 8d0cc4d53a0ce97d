"""The exporter of the run's cycle, on recordings whose meaning is known, and the cycle as it is in the repository."""

import json

import numpy as np
import pytest

from models.body.pose import Pose
from models.motions.actions.run_cycle import HARMONICS
from models.motions.build import export, humanoid
from models.skeleton import smpl
from tests.bodies import body_model

UPRIGHT = [1 / 30, 0.0, 0.9, 0.0]
TURNS = {"pelvis": 4, "spine": 4, "neck": 4}
LIMBS = {"hip": 4, "knee": 1, "ankle": 4, "shoulder": 4, "elbow": 1}


def frame(**turned: list[float]) -> list[float]:
    joints = TURNS | {f"{side}_{limb}": size for side in ("right", "left") for limb, size in LIMBS.items()}
    rest = {4: [1.0, 0.0, 0.0, 0.0], 1: [0.0]}
    return UPRIGHT + [number for joint, size in joints.items() for number in turned.get(joint, rest[size])]


def joints_of(**turned: list[float]) -> dict[str, np.ndarray]:
    recording = humanoid.read(json.dumps({"Frames": [frame(**turned)] * 2}))
    assert recording.step_s == pytest.approx(1 / 30)
    body = body_model().shaped(np.zeros(body_model().shape_count))
    return dict(zip(smpl.NAMES, body.joints_m(Pose(np.zeros(3), recording.rotations_rad[0])), strict=True))


def about_z(degrees: float) -> list[float]:
    half = np.radians(degrees) / 2
    return [float(np.cos(half)), 0.0, 0.0, float(np.sin(half))]


def test_the_humanoid_at_rest_stands_with_hanging_arms() -> None:
    at = joints_of()
    for side in ("left", "right"):
        arm = at[f"{side}_wrist"] - at[f"{side}_shoulder"]
        assert arm[2] < -0.95 * np.linalg.norm(arm)


def test_hinges_and_ball_joints_bend_the_way_of_people() -> None:
    at = joints_of(right_knee=[-1.5], left_elbow=[1.5], right_hip=about_z(60), left_shoulder=about_z(-40))
    thigh = at["right_knee"] - at["right_hip"]
    assert thigh[0] > 0.7 * np.linalg.norm(thigh), "a positive turn about z lifts the thigh forwards"
    assert (at["right_ankle"] - at["right_knee"])[2] < 0
    assert (at["right_ankle"] - at["right_knee"])[0] < 0, "a negative knee bends the shank backwards"
    assert (at["left_elbow"] - at["left_shoulder"])[0] < 0, "a negative turn about z swings the arm backwards"
    forearm, upper = at["left_wrist"] - at["left_elbow"], at["left_elbow"] - at["left_shoulder"]
    assert np.cross(upper, forearm)[1] < 0, "a positive elbow bends the forearm forwards and up"


def test_another_humanoid_is_refused() -> None:
    with pytest.raises(ValueError, match="44 numbers"):
        humanoid.read(json.dumps({"Frames": [[0.0] * 43] * 2}))


def test_harmonics_give_a_smooth_cycle_back_and_both_halves_count() -> None:
    phase = np.arange(24) * 2 * np.pi / 24
    cycle = np.zeros((24, smpl.COUNT, 3))
    cycle[:, smpl.INDEX["left_knee"], 1] = 0.8 + 0.5 * np.cos(phase) - 0.2 * np.sin(3 * phase)
    cycle[:, smpl.INDEX["right_knee"], 1] = np.roll(cycle[:, smpl.INDEX["left_knee"], 1], 12) + 0.2
    knee = export.harmonics(cycle)["left_knee"][1]
    np.testing.assert_allclose(knee, [0.9, 0.5, 0, 0, 0, 0, -0.2, 0, 0], atol=1e-12)


def test_the_cycle_in_the_repository_runs() -> None:
    knee, hip, elbow = (np.array(HARMONICS[joint]) for joint in ("left_knee", "left_hip", "left_elbow"))
    assert np.degrees(knee[1, 0]) == pytest.approx(48, abs=5)
    assert not knee[[0, 2]].any(), "a knee is a hinge"
    assert np.degrees(hip[1, 0]) == pytest.approx(-35, abs=5)
    assert np.degrees(elbow[2, 0]) == pytest.approx(-78, abs=8)
