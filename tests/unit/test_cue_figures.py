"""What the bench of cues counts."""

import math

import numpy as np
import pytest

from models.messages.feedback import Judgement
from models.motions.actions.library import ACTIONS
from services.evaluation.cues import Said
from services.evaluation.uncertainty import NETWORK
from tests.bench.teaching.cases import Case
from tests.bench.teaching.cues import Result, confusion, figures, response
from tests.bench.teaching.noise import SIGMA_M, as_fused
from tests.bench.teaching.tune import candidates

SQUAT = [fault.name for fault in ACTIONS["squat"].faults]


def one(faults: dict[str, float], cue: str = "", praise: str = "", severity: float = 1.0, *, fine: bool = False) -> Result:
    judged = tuple(Judgement(name, severity if name in faults else 0.0, 0.1) for name in SQUAT)
    return Result(Case("development", 0, "squat", faults), Said(praise, cue, 0.9 if cue else 0.0, fine), judged)


RESULTS = [
    one({}),
    one({}, praise="knees_in", fine=True),
    one({}, cue="heels_up"),
    one({"knees_in": 1.0}, cue="knees_in"),
    one({"heels_up": 1.0}, cue="knees_in"),
    one({"heels_up": 1.0}, fine=True),
    one({"heels_up": 0.5}, cue="heels_up", severity=0.6),
    one({"heels_up": 1.0, "knees_in": 1.0}, cue="knees_in"),
    one({"heels_up": 1.0, "too_shallow": 1.0}, cue="knees_in"),
]


def test_named_faults_false_cues_and_doubles_are_counted_apart() -> None:
    found = figures(RESULTS)
    assert found["cue_accuracy_pct"] == pytest.approx(100 / 3)
    assert found["false_cue_pct"] == pytest.approx(100 / 3)
    assert found["wrong_cue_pct"] == pytest.approx(100 / 3)
    assert found["cue_double_pct"] == pytest.approx(50)
    assert found["praised_pct"] == pytest.approx(100 / 3)
    assert found["fine_pct"] == pytest.approx(100 / 3)
    assert found["false_fine_pct"] == pytest.approx(100 / 5)


def test_what_was_not_measured_is_no_figure() -> None:
    assert all(math.isnan(value) for value in figures([]).values())


def test_the_confusion_matrix_has_a_row_of_a_hundred_percent_for_each_fault() -> None:
    (table,) = confusion(RESULTS)
    assert table.columns == ("performed", "n", *SQUAT, "silence")
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["faultless"][0] == 3
    heels = dict(zip(table.columns[1:], rows["heels_up"], strict=True))
    assert (heels["n"], heels["knees_in"], heels["silence"], heels["heels_up"]) == (2, 50, 50, 0)
    assert rows["back_rounded"][1:] == (None,) * (len(SQUAT) + 1)


def test_the_response_is_told_by_severity() -> None:
    rows = response(RESULTS).rows
    assert [row[0] for row in rows] == ["0.5", "1"]
    assert rows[0][2] == pytest.approx(0.6)
    assert rows[0][5] == 100
    assert rows[1][5] == pytest.approx(100 / 3)


def test_noise_is_as_large_as_it_says_and_smooth() -> None:
    still = np.zeros((3000, 17, 3))
    track = as_fused(still, 1 / 30, np.random.default_rng(0))
    wrist = track.joints_m[:, 10]
    expected = math.hypot(SIGMA_M, NETWORK.landmark_m[10])
    assert wrist.std(axis=0) == pytest.approx([expected] * 3, rel=0.12)
    assert np.diff(wrist, axis=0).std() < 0.6 * expected
    assert np.allclose(track.covariance_m2[0, 0], SIGMA_M**2 * np.eye(3))


def test_candidates_are_measures_that_a_file_may_have() -> None:
    found = list(candidates())
    assert len(found) > 1000
    assert len(set(found)) == len(found)
