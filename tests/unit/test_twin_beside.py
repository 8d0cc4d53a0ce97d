"""The twin's attempts, keyframes and cues are held against the rendered ones, and a gap cannot hide."""

import math
from dataclasses import replace

from models.motions.motion import Attempt
from services.evaluation.attempt import FoundAttempt
from services.evaluation.cues import Said
from tests.bench.teaching.cases import Case
from tests.bench.teaching.cues import Result
from tests.bench.teaching.finding import SIX, Decided, Found
from tests.bench.teaching.twin_beside import attempt_figures, gaps_pct, table

TRUE = tuple(Attempt(action, "right", 10.0 * n + 1, 10.0 * n + 2, 10.0 * n + 3, 10.0 * n + 4) for n, action in enumerate(SIX))
WHOLE = Found(
    TRUE,
    tuple(
        Decided(FoundAttempt(one.action, "right", (one.start_s, one.exertion_s, one.peak_s, one.end_s)), one.end_s) for one in TRUE
    ),
    ((),) * len(TRUE),
    70.0,
)
SAID = [
    Result(Case("development", 0, "squat", {"heels_up": 1.0}), Said(cue="heels_up", certainty=0.9), ()),
    Result(Case("development", 0, "squat", {}), Said(praise="heels_up", fine=True), ()),
]


def test_the_same_has_no_gap() -> None:
    figures = attempt_figures([WHOLE], SAID)
    assert figures["attempt_f1"] == figures["keyframe_f1"] == 1.0
    assert all(gap == 0 or math.isnan(gap) for gap in gaps_pct(figures, figures).values())


def test_an_attempt_that_the_twin_loses_is_a_gap_of_attempts_and_of_its_own_keyframes_alone() -> None:
    lost = replace(WHOLE, decided=WHOLE.decided[1:])
    gaps = gaps_pct(attempt_figures([WHOLE], SAID), attempt_figures([lost], SAID))
    assert gaps["attempt_f1"] < 0
    assert gaps[f"keyframe_f1.{SIX[0]}"] == -100
    assert all(gaps[f"keyframe_f1.{action}"] == 0 for action in SIX[1:])


def test_a_cue_that_only_the_twin_names_is_a_gap() -> None:
    silent = [replace(SAID[0], said=Said()), SAID[1]]
    half = attempt_figures([WHOLE], [*SAID, *silent])
    assert gaps_pct(half, attempt_figures([WHOLE], SAID))["cue_accuracy_pct"] == 100


def test_of_what_never_happened_no_share_is_told() -> None:
    assert math.isnan(gaps_pct({"false_cue_pct": 0.0}, {"false_cue_pct": 1.0})["false_cue_pct"])


def test_the_table_has_both_and_the_gap() -> None:
    assert table({"attempt_f1": 0.8}, {"attempt_f1": 1.0}).rows[0][:3] == ("attempt_f1", 0.8, 1.0)
