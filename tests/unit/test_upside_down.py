"""What is measured of somebody upside down is less sure than of somebody who stands."""

from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from models.arrays import Float
from models.skeleton import coco
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import known_track
from services.evaluation.uncertainty import EXACT, NETWORK
from tests.stick_figure import figure

FRAMES: Final = 9
SIGMA_M: Final = 0.01
_HIPS, _SHOULDERS = ([coco.INDEX[f"{side}_{part}"] for side in ("left", "right")] for part in ("hip", "shoulder"))


def _turned(degrees: float) -> Float:
    """(FRAMES, 17, 3) somebody who fell forwards by this angle: 180 is upside down."""
    angle = np.radians(degrees)
    matrix = np.array(((np.cos(angle), 0.0, np.sin(angle)), (0.0, 1.0, 0.0), (-np.sin(angle), 0.0, np.cos(angle))))
    turned = figure() @ matrix.T
    return np.repeat((turned - turned.min(axis=0) * (0.0, 0.0, 1.0))[None], FRAMES, axis=0)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 55.0])
def test_whoever_stands_or_bends_is_measured_as_surely_as_ever(degrees: float) -> None:
    np.testing.assert_array_equal(NETWORK.grown(_turned(degrees)), np.ones((FRAMES, coco.COUNT)))


def test_errors_grow_evenly_until_the_trunk_points_down_and_no_further() -> None:
    grown = np.array([NETWORK.grown(_turned(degrees))[0] for degrees in (0.0, 70.0, 90.0, 110.0, 130.0, 180.0)])
    assert (np.diff(grown, axis=0) >= 0).all()
    np.testing.assert_allclose(grown[-1], NETWORK.upside_down)
    np.testing.assert_allclose(grown[-2], NETWORK.upside_down)
    assert (grown[2] > 1.0).all()
    assert (grown[2] < grown[-1]).all()


def test_where_the_trunk_is_hidden_it_goes_on_as_before_and_after() -> None:
    joints_m = np.concatenate((_turned(0.0), _turned(180.0)))
    whole = NETWORK.grown(joints_m)
    joints_m[2:5, _HIPS] = np.nan
    joints_m[-3:, _SHOULDERS] = np.nan
    np.testing.assert_allclose(NETWORK.grown(joints_m), whole)


def test_of_a_trunk_that_is_never_seen_the_worst_is_assumed() -> None:
    joints_m = _turned(0.0)
    joints_m[:, _HIPS] = np.nan
    np.testing.assert_allclose(NETWORK.grown(joints_m), np.tile(NETWORK.upside_down, (FRAMES, 1)))


def test_truth_is_as_true_upside_down() -> None:
    np.testing.assert_array_equal(EXACT.grown(_turned(180.0)), np.ones((FRAMES, coco.COUNT)))


@pytest.mark.parametrize(
    ("name", "joint"), [("nose_height", "nose"), ("elbow_flexion", "right_elbow"), ("knee_flexion", "right_knee")]
)
def test_a_measure_of_somebody_upside_down_is_vaguer(name: str, joint: str) -> None:
    def sigma(degrees: float) -> float:
        track = known_track(_turned(degrees), 1 / 30, SIGMA_M)
        return float(Reading(track, "right", NETWORK, Stature(1.5, 0.0)).of(CATALOGUE[name], "lead").sigma[FRAMES // 2])

    assert sigma(180.0) == pytest.approx(NETWORK.upside_down[coco.INDEX[joint]] * sigma(0.0), rel=0.35)


def test_a_model_without_a_number_for_each_joint_is_refused() -> None:
    with pytest.raises(ValueError, match="there are 17 joints, not 17, 17, 3"):
        replace(NETWORK, upside_down=(1.0, 1.0, 1.0))
