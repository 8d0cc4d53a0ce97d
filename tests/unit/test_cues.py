"""At most one thing to correct, and only what is sure; what was good comes first."""

import itertools
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from models.messages.feedback import VERDICTS, Judgement, MeasureResult, Verdict
from models.teaching.schema import Fault, Teaching, decode_teaching
from services.evaluation.cues import CALLED, POSSIBLE, VAGUE, Said, above, choose
from tests.teaching_texts import GOOD, VOCABULARY

FILE = decode_teaching(GOOD.encode(), "squat.toml", VOCABULARY)


def teaching(**importances: float) -> Teaching:
    one = FILE.fault[0]
    faults = tuple(
        Fault(name=name, importance=importance, cue=one.cue, praise=one.praise, evidence=one.evidence)
        for name, importance in importances.items()
    )
    return Teaching(version=1, action="squat", title=FILE.title, shown=FILE.shown, fault=faults)


def said(importances: dict[str, float], numbers: Sequence[Verdict] = (), /, **judged: tuple[float, float] | None) -> Said:
    judgements = [Judgement(name, *(one or (None, None))) for name, one in judged.items()]
    return choose(teaching(**importances), judgements, [number(place, verdict) for place, verdict in enumerate(numbers)])


def number(place: int, verdict: Verdict) -> MeasureResult:
    """Of which somebody may say this, about none of the faults."""
    value = None if verdict == "unknown" else 1.0
    return MeasureResult(f"number_{place}", value, None if value is None else 0.1, "deg", verdict)


def test_what_is_surely_a_fault_is_corrected() -> None:
    one = said({"a": 1, "b": 1}, a=(0.0, 0.1), b=(1.0, 0.1))
    assert (one.cue, one.praise) == ("b", "a")
    assert one.certainty > 0.99


def test_silence_where_nobody_can_be_sure() -> None:
    assert said({"a": 1, "b": 1}, a=(0.6, 0.5), b=(0.45, 0.3)) == Said()


def test_silence_where_what_looks_large_is_vague() -> None:
    assert said({"a": 1, "b": 3}, a=(0.9, 0.2), b=(2.0, 0.6)).cue == "a"
    assert said({"b": 3}, b=(2.0, 0.6)).cue == ""


def test_silence_where_nothing_was_seen() -> None:
    assert said({"a": 1, "b": 1}, a=None, b=None) == Said()


def test_silence_without_a_fault() -> None:
    assert said({"a": 1, "b": 1}, a=(0.1, 0.1), b=(0.3, 0.1)).cue == ""


def test_the_more_important_of_two_faults_is_corrected() -> None:
    assert said({"a": 1, "b": 3}, a=(1.0, 0.1), b=(1.0, 0.1)).cue == "b"


def test_the_larger_of_two_faults_is_corrected() -> None:
    assert said({"a": 2, "b": 2}, a=(0.7, 0.05), b=(1.2, 0.05)).cue == "b"


def test_the_surer_of_two_faults_is_corrected() -> None:
    assert said({"a": 2, "b": 2}, a=(1.0, 0.45), b=(1.0, 0.05)).cue == "b"


def test_the_first_of_two_equal_faults_is_corrected() -> None:
    assert said({"a": 2, "b": 2}, a=(1.0, 0.1), b=(1.0, 0.1)).cue == "a"


def test_a_mad_severity_does_not_outrank_what_is_important() -> None:
    assert said({"a": 1, "b": 3}, a=(2.5, 0.1), b=(0.9, 0.1)).cue == "b"


def test_praise_is_of_the_most_important_point_that_was_good() -> None:
    assert said({"a": 1, "b": 3, "c": 2}, a=(0.0, 0.1), b=(0.0, 0.1), c=(0.0, 0.1)).praise == "b"


def test_a_point_of_which_nothing_is_known_is_not_praised_however_good_it_looks() -> None:
    """-1 is where a measure is cut off that went mad."""
    assert said({"a": 3}, a=(-1.0, 0.9)).praise == ""
    assert said({"a": 3, "b": 1}, a=(-1.0, 0.9), b=(0.0, 0.1)).praise == "b"


def test_what_is_beyond_good_is_no_better_than_what_is_right() -> None:
    assert said({"a": 2, "b": 3}, a=(-1.0, 0.05), b=(0.0, 0.05)).praise == "b"


def either_way(severity: float, sigma: float) -> Said:
    """Of a fault of which the opposite is a mistake, too."""
    only = structs.replace(FILE, fault=(structs.replace(FILE.fault[0], either_way=True),))
    return choose(only, [Judgement(FILE.fault[0].name, severity, sigma)], [])


@pytest.mark.parametrize(("severity", "sigma"), [(-1.0, 0.1), (-0.6, 0.05), (-0.45, 0.2)])
def test_the_opposite_of_a_fault_is_neither_praised_nor_fine_where_it_is_a_mistake_too(severity: float, sigma: float) -> None:
    assert either_way(severity, sigma) == Said()


@pytest.mark.parametrize(("severity", "sigma"), [(0.0, 0.2), (-0.3, 0.2), (-0.45, 0.05)])
def test_what_is_a_little_beyond_good_is_praised_also_where_the_opposite_is_a_mistake(severity: float, sigma: float) -> None:
    assert either_way(severity, sigma) == Said(praise=FILE.fault[0].name, fine=True)


def test_what_may_have_been_wrong_is_not_praised() -> None:
    assert said({"a": 3, "b": 1}, a=(0.35, 0.1), b=(0.0, 0.1)).praise == "b"
    assert said({"a": 3}, a=(0.0, 0.5)).praise == ""


judgements = st.one_of(st.none(), st.tuples(st.floats(-1, 2.5), st.floats(0, 1)))


@given(st.lists(st.tuples(st.floats(0.1, 5), judgements), min_size=1, max_size=6))
def test_what_is_corrected_is_never_praised_and_always_called(faults: list[tuple[float, tuple[float, float] | None]]) -> None:
    names = "abcdef"[: len(faults)]
    importances = {name: importance for name, (importance, _) in zip(names, faults, strict=True)}
    judged = dict(zip(names, (one for _, one in faults), strict=True))
    one = said(importances, **judged)
    assert one == said(importances, **judged)
    assert not one.cue or one.cue != one.praise
    if one.cue:
        severity = judged[one.cue]
        assert severity is not None
        assert severity[0] > 0.5
        assert severity[1] <= VAGUE
        assert one.certainty >= 0.75
    else:
        assert one.certainty == 0
    if one.praise:
        praised = judged[one.praise]
        assert praised is not None
        assert praised[0] < 0.4
        assert praised[1] <= VAGUE


@given(st.floats(0.51, 1.5), st.floats(0.51, 1.5), st.floats(0.01, 0.5))
def test_a_worse_fault_is_never_called_less_surely(one: float, other: float, sigma: float) -> None:
    worse, slighter = max(one, other), min(one, other)
    assert above(Judgement("a", worse, sigma), 0.5) >= above(Judgement("a", slighter, sigma), 0.5)


def test_how_likely_a_severity_is() -> None:
    assert above(Judgement("a", 0.5, 0.2), 0.5) == pytest.approx(0.5)
    assert above(Judgement("a", 0.7, 0.2), 0.5) == pytest.approx(0.8413, abs=1e-4)
    assert above(Judgement("a", 0.7, 0.0), 0.5) == 1
    assert above(Judgement("a", None, None), 0.5) == 0.5


def test_the_order_of_the_file_does_not_change_what_is_said() -> None:
    importances, judged = {"a": 1.0, "b": 3.0, "c": 2.0}, {"a": (0.9, 0.1), "b": (0.8, 0.2), "c": (0.0, 0.1)}
    every = {
        said({name: importances[name] for name in order}, **{name: judged[name] for name in order})
        for order in itertools.permutations("abc")
    }
    assert len(every) == 1


def test_where_all_was_seen_and_nothing_was_wrong_silence_is_approval() -> None:
    assert said({"a": 1, "b": 1}, ["good", "fair", "unknown"], a=(0.1, 0.2), b=(-0.5, 0.1)).fine


@pytest.mark.parametrize(
    ("numbers", "judged"),
    [
        (["good", "poor"], {"a": (0.0, 0.1), "b": (0.0, 0.1)}),
        (["good"], {"a": (0.0, 0.1), "b": None}),
        (["good"], {"a": (0.0, 0.1), "b": (0.4, 0.2)}),  # 31 % for the fault
        (["good"], {"a": (0.0, 0.1), "b": (-0.9, 0.6)}),  # hardly seen, however good it looks
        (["good"], {"a": (0.6, 0.2), "b": (0.6, 0.2)}),  # each with 69 %, which is not sure enough to be said
        (["good"], {"a": (0.0, 0.1), "b": (1.0, 0.1)}),  # that is corrected
    ],
)
def test_silence_is_no_approval(numbers: list[Verdict], judged: dict[str, tuple[float, float] | None]) -> None:
    assert not said({"a": 1, "b": 1}, numbers, **judged).fine


seen = st.one_of(st.none(), st.tuples(st.floats(-1, 0.8), st.floats(0, 0.6)))
attempts = st.tuples(
    st.lists(st.tuples(st.floats(0.1, 5), seen), min_size=1, max_size=3), st.lists(st.sampled_from(VERDICTS), max_size=2)
)


@given(attempts)
def test_fine_is_never_beside_a_poor_number_or_what_nobody_judged_or_a_fault_that_may_have_been_made(
    attempt: tuple[list[tuple[float, tuple[float, float] | None]], list[Verdict]],
) -> None:
    faults, numbers = attempt
    names = "abc"[: len(faults)]
    judged = dict(zip(names, (one for _, one in faults), strict=True))
    one = said({name: importance for name, (importance, _) in zip(names, faults, strict=True)}, numbers, **judged)
    if one.fine:
        assert one.cue == ""
        assert "poor" not in numbers
        assert None not in judged.values()
        assert all(above(Judgement(name, *(each or (None, None))), CALLED) <= POSSIBLE for name, each in judged.items())


@given(st.lists(st.tuples(st.floats(0.1, 5), st.tuples(st.floats(-1, 0.2), st.floats(0, 0.4))), min_size=1, max_size=6))
def test_who_does_all_well_is_told_so(faults: list[tuple[float, tuple[float, float]]]) -> None:
    names = "abcdef"[: len(faults)]
    importances = {name: importance for name, (importance, _) in zip(names, faults, strict=True)}
    assert said(importances, ["good"], **dict(zip(names, (one for _, one in faults), strict=True))).fine
