"""The files that ship: complete, readable, and about the faults that pupils make."""

import re
from functools import cache
from importlib.resources import files
from itertools import combinations

import pytest

import models.teaching
from models.motions.actions.library import ACTIONS
from models.teaching.schema import Language, Teaching, Text, Vocabulary, decode_teaching
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.signals.catalogue import CATALOGUE
from tests.installed import ROOT

LANGUAGES: tuple[Language, ...] = ("en", "zh", "de", "es")


@cache
def taught(action: str) -> Teaching:
    name = f"{action}.toml"
    data = (files(models.teaching) / "actions" / name).read_bytes()
    return decode_teaching(data, name, Vocabulary(CATALOGUE, FUNCTIONS))


def all_texts(teaching: Teaching) -> list[Text]:
    faults = [text for fault in teaching.fault for text in (fault.cue, fault.praise)]
    return [teaching.title, *faults, *(shown.title for shown in teaching.shown)]


def test_there_is_a_file_for_each_action_and_for_no_other() -> None:
    there = {path.name for path in (files(models.teaching) / "actions").iterdir() if path.name.endswith(".toml")}
    assert there == {f"{action}.toml" for action in ACTIONS}


@pytest.mark.parametrize("action", ACTIONS)
def test_every_fault_that_is_performed_is_looked_for(action: str) -> None:
    assert {fault.name for fault in taught(action).fault} == {fault.name for fault in ACTIONS[action].faults}


@pytest.mark.parametrize("action", ACTIONS)
def test_three_measures_are_shown_with_the_units_that_they_have(action: str) -> None:
    shown = taught(action).shown
    assert len(shown) == 3
    for one in shown:
        unit = FUNCTIONS[one.function].unit if isinstance(one.function, str) else CATALOGUE[str(one.signal)].unit
        assert one.unit == unit, one.name


@pytest.mark.parametrize("action", ACTIONS)
def test_no_two_faults_are_given_the_same_words(action: str) -> None:
    for language in LANGUAGES:
        words = [text.of(language) for fault in taught(action).fault for text in (fault.cue, fault.praise)]
        assert len(set(words)) == len(words)


@pytest.mark.parametrize("action", ACTIONS)
def test_texts_are_in_the_language_that_they_stand_under(action: str) -> None:
    for text in all_texts(taught(action)):
        assert re.search(r"[\u4e00-\u9fff]", text.zh), text
        assert not any(re.search(r"[\u4e00-\u9fff]", text.of(language)) for language in ("en", "de", "es")), text
        if text is not taught(action).title:
            assert all(text.of(one) != text.of(other) for one, other in combinations(LANGUAGES, 2)), text


@pytest.mark.parametrize("action", ACTIONS)
def test_cues_are_short_and_say_what_to_do(action: str) -> None:
    for fault in taught(action).fault:
        assert len(fault.cue.en.split()) <= 13, fault.cue.en
        assert len(fault.cue.zh) <= 25, fault.cue.zh
        assert not re.search(r"\b(don't|do not|never|not|wrong|bad)\b", fault.cue.en.lower()), fault.cue.en
        for language in LANGUAGES:
            assert fault.cue.of(language)[-1] in ".。", fault.cue.of(language)
            assert fault.praise.of(language)[-1] in ".。", fault.praise.of(language)


def test_the_example_of_the_guide_is_what_the_file_says() -> None:
    guide = (ROOT / "docs" / "teaching.md").read_text(encoding="utf-8")
    file = (files(models.teaching) / "actions" / "basketball_shot.toml").read_text(encoding="utf-8")
    evidence = [line.strip() for line in guide.split("```")[1].splitlines() if line.startswith("  {")]
    assert len(evidence) == 2
    assert [line for line in evidence if line not in file] == []
