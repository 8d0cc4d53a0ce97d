"""Severities: 0 as it should be, 1 the fault; what was not seen is not judged."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.schema import Evidence, Fault, Teaching, decode_teaching
from services.evaluation import faults
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.signals.reading import Reading
from services.evaluation.track import Track, known_track
from tests.teaching_texts import GOOD, VOCABULARY

TEACHING = decode_teaching(GOOD.encode(), "squat.toml", VOCABULARY)
SHALLOW = TEACHING.fault[0]
ATTEMPT = FoundAttempt("squat", "right", (0.2, 0.5, 1.0, 1.8))


def measured(value: float, sigma: float = 2.0, known: bool = True) -> Measured:
    return Measured("x", value, sigma, "deg", known, "" if known else "hidden")


def judged(*values: Measured) -> tuple[float | None, float | None]:
    one = faults._judged(SHALLOW, list(values))
    return one.severity, one.sigma


def test_what_is_good_is_nothing_and_what_is_the_fault_is_one() -> None:
    assert judged(measured(110), measured(40))[0] == pytest.approx(0)
    assert judged(measured(80), measured(20))[0] == pytest.approx(1)
    assert judged(measured(95), measured(30))[0] == pytest.approx(0.5)


def test_evidence_counts_by_its_weight() -> None:
    assert judged(measured(80), measured(40))[0] == pytest.approx(2 / 3)
    assert judged(measured(110), measured(20))[0] == pytest.approx(1 / 3)


def test_a_single_mad_measure_does_not_decide_alone() -> None:
    severity, _ = judged(measured(-5000), measured(40))
    assert severity == pytest.approx(2 * 2.5 / 3)


def test_what_is_mostly_hidden_is_not_judged() -> None:
    assert judged(measured(np.nan, np.nan, False), measured(40)) == (None, None)
    assert judged(measured(np.nan, np.nan, False), measured(np.nan, np.nan, False)) == (None, None)


def test_what_is_partly_hidden_is_judged_with_less_certainty() -> None:
    whole, part = judged(measured(80), measured(20)), judged(measured(80), measured(np.nan, np.nan, False))
    assert part[0] == pytest.approx(1)
    assert part[1] is not None
    assert whole[1] is not None
    assert part[1] > 2 * whole[1]


@given(st.floats(0, 20), st.floats(0, 20))
def test_certainty_grows_with_the_measures(first: float, second: float) -> None:
    """Between errors that have nothing to do with one another and errors that are the same."""
    _, sigma = judged(measured(100, first), measured(30, second))
    one, other = 2 * first / 30 / 3, second / 20 / 3
    assert sigma is not None
    assert np.hypot(one, other) - 1e-9 <= sigma <= one + other + 1e-9


def test_a_value_may_be_good_above_or_below() -> None:
    above, below = SHALLOW.evidence[0], Evidence(signal="knee_flexion", at="peak", good=10, fault=30)
    assert [faults.severity(above, value) for value in (110, 95, 80)] == [0, 0.5, 1]
    assert [faults.severity(below, value) for value in (10, 20, 30)] == [0, 0.5, 1]


def standing() -> Track:
    """Somebody of 1.5 m who stands still for two seconds."""
    places = {
        "nose": (0.1, 0, 1.38), "eye": (0.08, 0.03, 1.42), "ear": (0, 0.07, 1.4), "shoulder": (0, 0.16, 1.22),
        "elbow": (0, 0.18, 0.95), "wrist": (0, 0.2, 0.72), "hip": (0, 0.09, 0.8), "knee": (0, 0.09, 0.43), "ankle": (0, 0.09, 0.08),
    }  # fmt: skip
    joints = np.zeros((60, coco.COUNT, 3))
    for index, name in enumerate(coco.NAMES):
        x, y, z = places[name.split("_")[-1]]
        joints[:, index] = (x, y if name.startswith("left") else -y, z)
    return known_track(joints, 1 / 30, 0.005)


def test_an_attempt_is_judged_fault_by_fault() -> None:
    shallow, forward = faults.judge(TEACHING, Reading(standing(), "right"), ATTEMPT)
    assert (shallow.fault, forward.fault) == ("too_shallow", "trunk_forward")
    assert shallow.severity is not None
    assert shallow.severity > 1.5  # he stands: knees are straight, the trunk upright
    assert forward.severity == pytest.approx(-1)  # further from the fault than any measure counts
    assert shallow.sigma is not None
    assert 0.01 < shallow.sigma < 0.5


def test_who_was_not_seen_is_not_judged() -> None:
    track = standing()
    hidden = Track(track.t_s, track.joints_m, track.covariance_m2, np.ones_like(track.states))
    unknown = known_track(np.full((60, coco.COUNT, 3), np.nan), 1 / 30)
    for one in (hidden, unknown):
        for judgement in faults.judge(TEACHING, Reading(one, "right"), ATTEMPT):
            assert judgement.severity is None


def test_an_attempt_beyond_the_track_is_not_judged() -> None:
    late = FoundAttempt("squat", "right", (10.0, 11.0, 12.0, 13.0))
    assert all(one.severity is None for one in faults.judge(TEACHING, Reading(standing(), "right"), late))


def test_the_side_that_leads_is_the_one_that_is_measured() -> None:
    track = standing()
    bent = track.joints_m.copy()
    bent[:, coco.INDEX["left_ankle"]] = bent[:, coco.INDEX["left_knee"]] + (-0.35, 0, 0)
    evidence = Evidence(signal="knee_flexion", side="lead", at="peak", good=0.0, fault=90.0)
    one = Fault(name="bent", importance=1, cue=SHALLOW.cue, praise=SHALLOW.praise, evidence=(evidence,))
    teaching = Teaching(version=1, action="squat", title=TEACHING.title, shown=TEACHING.shown, fault=(one,))
    by_side: dict[Handed, float | None] = {}
    sides: tuple[Handed, Handed] = ("left", "right")
    for side in sides:
        reading = Reading(known_track(bent, 1 / 30, 0.005), side)
        by_side[side] = faults.judge(teaching, reading, replace(ATTEMPT, handed=side))[0].severity
    assert by_side["left"] == pytest.approx(1, abs=0.01)
    assert by_side["right"] == pytest.approx(0, abs=0.01)
