"""A report says what was measured, how sure that is, and nothing of what is not known."""

from collections.abc import Iterator
from typing import Any, get_args

import msgspec
import pytest

from models.errors import UserError
from models.teaching.schema import Language
from services.evaluation.report import json_file
from services.evaluation.report.document import FORMAT, VERSION, Report
from services.evaluation.report.sheet import LessonFacts, Tried, sheet_of
from tests.reported import BEGUN, FACTS, attempt, sheet
from tests.taught import shipped

ESTIMATES = (("value", "sigma"), ("score", "score_sigma"), ("severity", "sigma"))


def read(data: bytes) -> Any:
    return msgspec.json.decode(data)


def objects(value: Any) -> Iterator[dict[str, Any]]:
    if isinstance(value, dict):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from objects(inner)


def test_json_is_read_back_as_it_was_and_says_its_version() -> None:
    report = sheet(attempt(), attempt("squat", after_s=80)).report
    data = json_file.encode(report)
    assert msgspec.json.decode(data, type=Report) == report
    assert (read(data)["format"], read(data)["version"]) == (FORMAT, VERSION) == ("kinebox-report", 1)


def test_no_number_stands_without_its_sigma() -> None:
    document = read(json_file.encode(sheet(attempt(hidden=("left_knee", "right_knee")), attempt("squat")).report))
    found = 0
    for value, sigma in ESTIMATES:
        for one in objects(document):
            if value in one:
                found += one[value] is not None
                assert (one[value] is None) == (one[sigma] is None)
    assert found > 5


def test_what_was_not_seen_is_null_and_never_nought() -> None:
    told = attempt(hidden=("left_knee", "right_knee"))
    (document,) = read(json_file.encode(sheet(told).report))["attempts"]
    (knee,) = [one for one in document["measures"] if one["name"] == "knee_bend"]
    assert (knee["value"], knee["sigma"], knee["verdict"]) == (None, None, "unknown")
    (bend,) = [one for one in document["judgements"] if one["fault"] == "no_knee_bend"]
    assert (bend["severity"], bend["sigma"]) == (None, None)


def test_what_an_empty_cue_means_is_in_the_file() -> None:
    said = (
        attempt(cue="no_knee_bend", cue_certainty=0.9, praise=""),
        attempt(cue="", cue_certainty=0.0, score=80.0, score_sigma=4.0),
    )
    document = read(json_file.encode(sheet(*said).report))
    assert [(one["cue"] is None, one["silence"]) for one in document["attempts"]] == [(False, None), (True, "unsure")]


def test_an_attempt_without_a_score_has_none_in_the_summary_either() -> None:
    report = sheet(attempt(score=None, score_sigma=None)).report
    (action,) = report.pupils[0].actions
    assert (action.attempts, action.scored, action.score, action.score_sigma) == (1, 0, None, None)


def test_more_attempts_make_the_mean_score_no_surer() -> None:
    told = attempt(score=80.0, score_sigma=4.0), attempt(score=60.0, score_sigma=6.0), attempt(score=None, score_sigma=None)
    report = sheet(*((one, "P07") for one in told)).report
    (action,) = report.pupils[0].actions
    assert (action.attempts, action.scored, action.score, action.score_sigma) == (3, 2, 70.0, 5.0)


def test_the_scores_of_nobody_have_no_mean_since_they_are_of_several_pupils() -> None:
    report = sheet(attempt(score=80.0, score_sigma=4.0), attempt(score=60.0, score_sigma=6.0)).report
    (action,) = report.pupils[0].actions
    assert (report.pupils[0].pupil, action.attempts, action.scored) == (None, 2, 2)
    assert (action.score, action.score_sigma) == (None, None)


@pytest.mark.parametrize("language", get_args(Language))
def test_titles_and_texts_are_in_the_language_asked_for(language: Language) -> None:
    told = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="elbow_out")
    (one,) = sheet(told, language=language).report.attempts
    taught = shipped().teachings["basketball_shot"]
    faults = {fault.name: fault for fault in taught.fault}
    assert one.cue is not None
    assert one.praise is not None
    assert one.title == taught.title.of(language)
    assert (one.cue.text, one.praise.text) == (faults["no_knee_bend"].cue.of(language), faults["elbow_out"].praise.of(language))
    assert [measure.title for measure in one.measures] == [shown.title.of(language) for shown in taught.shown]


def test_times_count_from_the_lessons_begin_and_the_clock_is_the_rooms() -> None:
    told = attempt(after_s=3700.0)
    (one,) = sheet(told).report.attempts
    start_s = (told.keyframes_ns[0] - FACTS.begun_ns) * 1e-9
    assert one.keyframes_s.start == pytest.approx(start_s, abs=0.0006)
    assert one.keyframes_s.start < one.keyframes_s.exertion < one.keyframes_s.peak < one.keyframes_s.end
    assert one.begun.startswith("2026-11-20T11:06:")
    assert one.begun.endswith("+01:00")


def test_keyframes_that_nobody_saw_are_named_beside_the_sigma_that_is_not_theirs() -> None:
    document = read(json_file.encode(sheet(attempt(keyframes_unseen=("peak",)), attempt()).report))
    assert [one["keyframes_s"]["unseen"] for one in document["attempts"]] == [["peak"], []]


def test_attempts_are_grouped_by_pupil_who_was_not_named_comes_last() -> None:
    report = sheet((attempt(), "-"), (attempt("squat"), "P12"), (attempt(), "P07"), (attempt("squat"), "P07")).report
    assert [(one.pupil, one.attempts) for one in report.pupils] == [("P07", 2), ("P12", 1), (None, 1)]
    assert [one.action for one in report.pupils[0].actions] == ["basketball_shot", "squat"]


def test_the_attempts_of_one_pupil_keep_their_numbers_and_nobody_else_is_in_it() -> None:
    report = sheet((attempt(), "P12"), (attempt("squat"), "P07"), (attempt(), "P12"), pupil="P12").report
    assert [(one.number, one.pupil) for one in report.attempts] == [(1, "P12"), (3, "P12")]
    assert [one.pupil for one in report.pupils] == ["P12"]


def test_an_unknown_pupil_is_one_line_that_names_those_there_are() -> None:
    with pytest.raises(UserError, match=r"no attempt of pupil 'P99'; its pupils are '-', 'P12'"):
        sheet((attempt(), "P12"), attempt(), pupil="P99")


def test_a_lesson_without_attempts_is_refused() -> None:
    with pytest.raises(UserError, match="2026-11-20-7b has no attempt to report"):
        sheet()


def test_the_most_frequent_cue_counts_and_of_equals_the_later_one_does() -> None:
    def said(cue: str) -> Any:
        return attempt(cue=cue, cue_certainty=0.9 if cue else 0.0, praise="")

    (often,) = sheet(said("elbow_out"), said("no_knee_bend"), said("elbow_out"), said("")).report.pupils[0].actions
    assert (often.cue, often.cue_count, often.attempts) == ("elbow_out", 2, 4)
    (equal,) = sheet(said("elbow_out"), said("no_knee_bend")).report.pupils[0].actions
    assert (equal.cue, equal.cue_count) == ("no_knee_bend", 1)
    assert equal.cue_text
    (none,) = sheet(said("")).report.pupils[0].actions
    assert (none.cue, none.cue_text, none.cue_count) == (None, None, 0)


def test_what_is_not_taught_any_more_is_reported_without_texts() -> None:
    told = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="elbow_out")
    (one,) = sheet_of(FACTS, [Tried(told)], {}, "en").report.attempts
    assert one.title is None
    assert one.cue is not None
    assert (one.cue.fault, one.cue.text) == ("no_knee_bend", None)
    assert one.praise is not None
    assert (one.praise.point, one.praise.text) == ("elbow_out", None)
    assert {measure.title for measure in one.measures} == {None}


def test_an_attempt_that_began_before_the_lesson_has_a_negative_start() -> None:
    facts = LessonFacts("late", "", BEGUN, attempt().keyframes_ns[1], 1.0, "0.1.0", "recorded")
    (one,) = sheet_of(facts, [Tried(attempt())], shipped().teachings, "en").report.attempts
    assert one.keyframes_s.start < 0 <= one.keyframes_s.exertion
    assert one.begun < BEGUN.isoformat()


def test_codes_are_in_the_order_in_which_people_count() -> None:
    report = sheet((attempt(), "12"), (attempt(), "B10"), (attempt(), "7"), (attempt(), "B2"), (attempt(), "-")).report
    assert [one.pupil for one in report.pupils] == ["7", "12", "B2", "B10", None]
