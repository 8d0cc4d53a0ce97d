"""What is said and what stands beside it on the page never contradict one another, in no file that ships."""

from collections.abc import Iterator

import msgspec
import numpy as np
import pytest

from models.messages.feedback import Judgement, MeasureResult, Verdict
from models.motions.actions.library import ACTIONS
from models.teaching.measure import Measure
from models.teaching.schema import Evidence, Shown, Teaching
from services.evaluation.agreement import about, alike, beside_cue, unpraised
from services.evaluation.appraisal import verdict_of
from services.evaluation.cues import choose
from services.evaluation.faults import severity
from services.evaluation.measures.measured import Measured
from tests.taught import shipped

SIGMA_OF_WIDTH = 0.05


def taught(action: str) -> Teaching:
    return shipped().teachings[action]


def pairs(action: str) -> Iterator[tuple[Shown, str, Evidence]]:
    """Every number on the page with what of it is evidence of a fault."""
    teaching = taught(action)
    for shown in teaching.shown:
        for fault in teaching.fault:
            yield from ((shown, fault.name, evidence) for evidence in fault.evidence if alike(shown, evidence))


def result(shown: Shown, value: float) -> MeasureResult:
    sigma = SIGMA_OF_WIDTH * (shown.good[1] - shown.good[0])
    verdict = verdict_of(Measured(shown.name, value, sigma, shown.unit, known=True), *shown.good)
    return MeasureResult(shown.name, value, sigma, shown.unit, verdict, *shown.good)


@pytest.mark.parametrize("action", ACTIONS)
def test_what_is_still_called_good_is_no_fault_by_half(action: str) -> None:
    """A knee bend of 92 degrees was "Good", beside "Go down until your thighs are level."."""
    for shown, fault, evidence in pairs(action):
        worse = 1 if evidence.fault > evidence.good else -1
        same = shown.take == evidence.take
        nearer = (shown.take, worse) in {("max", -1), ("min", 1)}  # what is shown is further from the fault than what is judged
        if same or nearer or shown.take in {"at", "mean"}:
            bound = shown.good[1] if worse > 0 else shown.good[0]
            most = 0.5 if same and (shown.function or shown.stretch == evidence.stretch) else 0.6
            assert severity(evidence, bound) <= most + 1e-9, f"{action}: {shown.name} is good to {bound:g}, {fault} {evidence}"


def test_the_numbers_on_the_page_are_about_the_faults_that_are_looked_for() -> None:
    found = {(action, shown.name, fault) for action in ACTIONS for shown, fault, _ in pairs(action)}
    for expected in (
        ("squat", "knee_bend", "too_shallow"),
        ("squat", "trunk", "trunk_forward"),
        ("squat", "knees", "knees_in"),
        ("long_jump", "knee_bend", "no_crouch"),
        ("long_jump", "landing", "stiff_landing"),
        ("star_jump", "landing", "stiff_landing"),
        ("run", "trunk", "leans_back"),
        ("volleyball_spike", "hand_ahead", "hit_behind"),
        ("basketball_shot", "hand_height", "ball_from_chest"),
    ):
        assert expected in found
    for other in (
        ("long_jump", "knee_bend", "stiff_landing"),  # knees before the jump, and after it
        ("badminton_clear", "elbow_bend", "hit_too_low"),  # how far it is bent, and how straight it gets
        ("badminton_clear", "hand_height", "no_follow_through"),  # at the hit, and after it
        ("basketball_shot", "hand_height", "no_follow_through"),
    ):
        assert other not in found


@pytest.mark.parametrize("action", ACTIONS)
def test_nothing_is_praised_beside_a_number_that_says_otherwise(action: str) -> None:
    """Somebody who bends forward by 30 degrees in a run does not lean back, and is not to be told that he leans nicely."""
    teaching = taught(action)
    for shown in teaching.shown:
        width = shown.good[1] - shown.good[0]
        for value in np.linspace(shown.good[0] - 1.5 * width, shown.good[1] + 1.5 * width, 41):
            measures = [result(one, float(value) if one is shown else sum(one.good) / 2) for one in teaching.shown]
            judgements = [
                Judgement(
                    fault.name, _mean([severity(one, float(value)) if alike(shown, one) else 0.0 for one in fault.evidence]), 0.1
                )
                for fault in teaching.fault
            ]
            said = choose(teaching, judgements, measures)
            praised = [fault for fault in teaching.fault if fault.name == said.praise]
            verdict = next(one.verdict for one in measures if one.name == shown.name)
            assert not any(about(shown, fault) for fault in praised) or verdict == "good", (shown.name, value, said)
            assert not (said.fine and any(one.verdict == "poor" for one in measures)), (shown.name, value)


def _mean(values: list[float]) -> float:
    return sum(values) / len(values)


def test_who_overdoes_it_is_not_praised_more_than_who_does_it_right() -> None:
    teaching = taught("run")
    names = [fault.name for fault in teaching.fault]
    judged = [Judgement(name, -1.0 if name == "leans_back" else 0.0, 0.01) for name in names]
    praised = choose(teaching, judged, []).praise
    assert praised == choose(teaching, [Judgement(name, 0.0, 0.01) for name in names], []).praise == "no_knee_lift"


@pytest.mark.parametrize("verdict", ["good", "fair", "poor", "unknown"])
def test_no_number_is_called_good_that_the_cue_is_about(verdict: Verdict) -> None:
    teaching = taught("squat")
    measures = [
        MeasureResult(shown.name, None if verdict == "unknown" else 1.0, None if verdict == "unknown" else 0.1, shown.unit, verdict)
        for shown in teaching.shown
    ]
    beside = {one.name: one.verdict for one in beside_cue(teaching, "too_shallow", measures)}
    assert beside["knee_bend"] == ("fair" if verdict == "good" else verdict)
    assert beside["trunk"] == beside["knees"] == verdict
    assert beside_cue(teaching, "", measures) == tuple(measures)
    assert ("too_shallow" in unpraised(teaching, measures)) == (verdict in {"fair", "poor"})


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ({"at": "peak"}, {"at": "peak"}, True),
        ({"at": "peak"}, {"at": "peak", "shift_s": 0.1}, False),
        ({"at": "peak"}, {"over": ["start", "peak"], "take": "max"}, True),
        ({"over": ["start", "peak"], "take": "max"}, {"over": ["peak", "end"], "take": "max"}, False),
        ({"over": ["start", "peak"], "take": "max"}, {"over": ["exertion", "end"], "take": "mean"}, True),
        ({"over": ["start", "peak"], "take": "max"}, {"over": ["exertion", "end"], "take": "min"}, False),
        ({"over": ["start", "peak"], "take": "max"}, {"over": ["start", "peak"], "take": "range"}, False),
        ({"at": "peak", "side": "lead"}, {"at": "peak", "side": "other"}, False),
        ({"at": "peak", "side": "lead"}, {"at": "peak", "side": "both"}, True),
        ({"at": "peak", "side": "left"}, {"at": "peak", "side": "right"}, False),
    ],
)
def test_what_is_the_same_number(one: dict[str, object], other: dict[str, object], same: bool) -> None:
    first, second = (msgspec.convert({"signal": "knee_flexion", **each}, Measure) for each in (one, other))
    assert alike(first, second) == alike(second, first) == same


def test_sides_do_not_count_of_what_has_none_and_functions_are_alike_by_name() -> None:
    assert alike(Measure(signal="trunk_forward", at="peak", side="lead"), Measure(signal="trunk_forward", at="peak", side="other"))
    assert not alike(Measure(signal="trunk_forward", at="peak"), Measure(signal="knee_flexion", at="peak"))
    assert alike(Measure(function="hand_ahead"), Measure(function="hand_ahead"))
    assert not alike(Measure(function="hand_ahead"), Measure(function="jump_height"))
    assert not alike(Measure(function="hand_ahead"), Measure(signal="knee_flexion", at="peak"))
