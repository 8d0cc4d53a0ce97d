"""Signals of poses whose angles and distances are known by construction."""

import numpy as np
import pytest

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.signals.catalogue import CATALOGUE, of
from services.evaluation.signals.posture import SideAsked
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import known_track
from services.evaluation.uncertainty import EXACT
from tests.stick_figure import DOWN, FRONT, LEFT, UP, figure, still, turned, unit

RIGHT = -LEFT
STATURE = Stature(1.5, 0.0)


def value(name: str, joints_m: Float, side: SideAsked = "right") -> float:
    reading = Reading(still(joints_m), "right", EXACT, STATURE)
    return float(reading.of(CATALOGUE[name], side).value[4])


@pytest.mark.parametrize("bend", [0.0, 1e-5, 20.0, 90.0, 140.0, 180.0])
def test_a_knee_and_an_elbow_are_as_bent_as_they_are(bend: float) -> None:
    limbs = {"right_shank": turned(bend, LEFT, DOWN), "right_forearm": turned(-bend, LEFT, DOWN)}
    assert value("knee_flexion", figure(limbs)) == pytest.approx(bend, abs=1e-6)
    assert value("elbow_flexion", figure(limbs)) == pytest.approx(bend, abs=1e-6)
    assert value("knee_flexion", figure(limbs), "left") == pytest.approx(0, abs=1e-6)
    assert value("knee_flexion", figure(limbs), "both") == pytest.approx(bend / 2, abs=1e-6)


@pytest.mark.parametrize("degrees", [-30.0, 0.0, 45.0, 120.0])
def test_a_hip_is_flexed_to_the_front_and_extended_behind(degrees: float) -> None:
    assert value("hip_flexion", figure({"right_thigh": turned(-degrees, LEFT, DOWN)})) == pytest.approx(degrees, abs=1e-6)


def test_a_bent_trunk_flexes_the_hips() -> None:
    assert value("hip_flexion", figure(trunk=turned(40, LEFT, UP))) == pytest.approx(40, abs=1e-6)


@pytest.mark.parametrize(("side", "out"), [("right", RIGHT), ("left", LEFT)])
def test_an_arm_is_raised_out_and_to_the_front(side: SideAsked, out: Float) -> None:
    limb = f"{side}_upper_arm"
    for name, direction, expected in (
        ("shoulder_elevation", out, 90),
        ("shoulder_elevation", unit(FRONT + UP), 135),
        ("shoulder_abduction", unit(out + UP), 135),
        ("shoulder_abduction", -out, -90),
        ("shoulder_flexion", FRONT, 90),
        ("shoulder_flexion", unit(DOWN - FRONT), -45),
        ("upper_arm_azimuth", FRONT, 0),
        ("upper_arm_azimuth", out, 90),
        ("upper_arm_azimuth", unit(FRONT - out), -45),
    ):
        assert value(name, figure({limb: direction}), side) == pytest.approx(expected, abs=1e-6), name


@pytest.mark.parametrize(("side", "out"), [("right", RIGHT), ("left", LEFT)])
def test_a_knee_that_falls_in_has_valgus(side: SideAsked, out: Float) -> None:
    knock_kneed = figure({f"{side}_thigh": DOWN - 0.2 * out, f"{side}_shank": DOWN + 0.2 * out})
    expected = 2 * np.degrees(np.arctan(0.2))
    assert value("knee_valgus", knock_kneed, side) == pytest.approx(expected, abs=1e-6)


def test_a_trunk_leans_to_where_it_leans() -> None:
    forward, aside = figure(trunk=turned(30, LEFT, UP)), figure(trunk=turned(20, FRONT, UP))
    assert value("trunk_inclination", forward) == pytest.approx(30, abs=1e-6)
    assert value("trunk_forward", forward) == pytest.approx(30, abs=1e-6)
    assert value("trunk_forward", figure(trunk=turned(-15, LEFT, UP))) == pytest.approx(-15, abs=1e-6)
    assert value("trunk_side", aside, "right") == pytest.approx(20, abs=1e-6)
    assert value("trunk_side", aside, "left") == pytest.approx(-20, abs=1e-6)


@pytest.mark.parametrize("degrees", [-40.0, 70.0])
def test_a_twist_is_positive_with_the_leading_shoulder_back(degrees: float) -> None:
    right_back = figure(shoulders=turned(-degrees, UP, LEFT))
    assert value("trunk_twist", right_back, "right") == pytest.approx(degrees, abs=1e-6)
    assert value("trunk_twist", right_back, "left") == pytest.approx(-degrees, abs=1e-6)


def test_a_turn_is_followed_beyond_half_a_turn() -> None:
    angles = np.linspace(0, 500, 40)
    joints = np.stack([figure() @ np.array([turned(-angle, UP, axis) for axis in np.eye(3)]) for angle in angles])
    heading = of("heading", known_track(joints, 1 / 30), "lead", "right").value
    np.testing.assert_allclose(heading, angles, atol=1e-6)


def test_heights_and_reaches_are_shares_of_the_stature() -> None:
    reaching = figure({"right_upper_arm": FRONT, "right_forearm": FRONT})
    assert value("wrist_forward", reaching) == pytest.approx(100 * 0.52 / 1.5)
    assert value("hip_height", reaching) == pytest.approx(100 * 0.85 / 1.5)
    assert value("wrist_height", reaching) == pytest.approx(100 * 1.35 / 1.5)
    assert value("ankle_apart", reaching) == pytest.approx(100 * 0.24 / 1.5)
    assert value("hip_drop", reaching) == pytest.approx(0, abs=1e-9)
    assert value("elbow_behind_shoulder", figure({"right_upper_arm": -FRONT})) == pytest.approx(100 * 0.28 / 1.5)


def test_speeds_and_accelerations_are_those_of_a_fall() -> None:
    t_s = np.arange(20) / 30
    joints = figure()[None] - np.array([0, 0, 4.905]) * t_s[:, None, None] ** 2
    reading = Reading(known_track(joints, 1 / 30), "right", EXACT, STATURE)
    inside = slice(2, -2)
    np.testing.assert_allclose(reading.of(CATALOGUE["com_rise_speed"], "lead").value[inside], -9.81 * t_s[inside], atol=1e-9)
    np.testing.assert_allclose(reading.of(CATALOGUE["wrist_acceleration"], "lead").value[inside], 9.81, atol=1e-8)
    assert np.isnan(reading.of(CATALOGUE["com_speed"], "lead").value[[0, -1]]).all()


def test_a_leg_that_straightens_has_a_positive_angular_speed() -> None:
    joints = np.stack([figure({"right_shank": turned(90 - 3 * frame, LEFT, DOWN)}) for frame in range(20)])
    speed = of("knee_angular_speed", known_track(joints, 1 / 30), "right", "right").value
    np.testing.assert_allclose(speed[2:-2], 90.0, atol=1e-6)


def test_the_papers_centre_of_mass_is_the_mean_of_the_joints() -> None:
    joints = figure()
    paper = Reading(still(joints), "right", EXACT, STATURE, masses=np.full(coco.COUNT, 1 / coco.COUNT))
    height = 100 * joints[:, 2].mean() / 1.5
    assert paper.of(CATALOGUE["com_height"], "lead").value[0] == pytest.approx(height)
    assert value("com_height", joints) < height - 3, "segment masses put it lower"


def test_who_is_upside_down_or_lies_has_signals_without_a_warning() -> None:
    for joints in (figure() * (1, 1, -1), figure()[:, [2, 1, 0]], np.zeros((17, 3))):
        for name in CATALOGUE:
            value(name, joints)
