"""What a teacher gets wrong in a teaching file is one line that names the file and the key, and says what to do."""

import gc

import pytest

from models.errors import UserError
from models.teaching.measure import Measure
from models.teaching.schema import Teaching, decode_teaching
from tests.teaching_texts import GOOD, VOCABULARY


def decoded(text: str, name: str = "squat.toml") -> Teaching:
    return decode_teaching(text.encode(), name, VOCABULARY)


def test_what_a_file_says_is_read() -> None:
    teaching = decoded(GOOD)
    shallow, forward = teaching.fault
    assert (teaching.action, shallow.importance, shallow.evidence[0].weight, forward.evidence[0].weight) == ("squat", 3, 2, 1)
    assert shallow.evidence[0].stretch == ("start", 0, "peak", 0)
    assert shallow.evidence[1].stretch == ("peak", -0.1, "peak", 0.1)
    assert forward.cue.of("de") == "Nimm die Brust hoch."
    assert teaching.tolerance.wrist == 7
    assert [fault.either_way for fault in teaching.fault] == [False, False]
    either_way = decoded(GOOD.replace('praise.es = "Bien abajo."', 'praise.es = "Bien abajo."\neither_way = true'))
    assert [fault.either_way for fault in either_way.fault] == [True, False]


WRONG = {
    "an unknown key": ("good = 110,", "good = 110, sometimes = 3,", "fault 'too_shallow', evidence 1: there is no key `sometimes`"),
    "an unknown table": ("[[shown]]", "[[schown]]", "there is no key `schown`"),
    "an unknown signal": (
        'signal = "knee_flexion", over',
        'signal = "knee_flexoin", over',
        "no signal 'knee_flexoin'; docs/measures.md has",
    ),
    "an unknown function": ('signal = "trunk_forward", at = "peak", good', 'function = "jump_hight", good', "such as jump_height"),
    "an unknown phase": ('at = "peak", good', 'at = "peek", good', "fault 'trunk_forward', evidence 1, at: 'peek' is none"),
    "an unknown side": ('at = "peak", good', 'at = "peak", side = "rite", good', "side: 'rite' is none"),
    "an unknown unit": ('"deg"', '"degrees"', "shown 'knee_bend', unit: 'degrees' is none"),
    "the unit of another measure": (
        'unit = "deg"',
        'unit = "cm"',
        "shown 'knee_bend': `unit` is cm, but knee_flexion is in deg; write",
    ),
    "the unit of a value for a time": (
        'take = "max"\nunit',
        'take = "time_of_max"\nunit',
        "but knee_flexion is in s; write unit = 's'",
    ),
    "a unit without a word": (
        'signal = "knee_flexion"\nover = ["start", "peak"]\ntake = "max"\nunit',
        'signal = "wrist_acceleration"\nover = ["start", "peak"]\ntake = "max"\nunit',
        "wrist_acceleration is in m_s2, for which the page has no word",
    ),
    "a language too many": ('es = "Sentadilla"', 'es = "Sentadilla"\nfr = "Squat"', "title: there is no key `fr`"),
    "a language too few": ('cue.es = "Baja más."\n', "", "fault 'too_shallow', cue: `es` is missing; add it"),
    "an empty text": ('"Go deeper."', '""', "fault 'too_shallow', cue, en"),
    "a text of blanks": ('"Go deeper."', '"  "', "without spaces at its ends"),
    "a text too long": ('"Go deeper."', f'"{"deep " * 40}er"', "fault 'too_shallow', cue, en"),
    "the same value twice": ("good = 40, fault = 60", "good = 40, fault = 40", "the same number"),
    "no value": ("good = 40, fault = 60", "good = 40", "`fault` is missing; add it"),
    "a value that is none": ("good = 40, fault = 60", "good = 40, fault = nan", "fault 'trunk_forward', evidence 1, fault"),
    "a way that is neither": ("importance = 2", 'importance = 2\neither_way = "both"', "fault 'trunk_forward', either_way"),
    "an importance of nothing": ("importance = 2", "importance = 0", "fault 'trunk_forward', importance"),
    "a weight of nothing": ("weight = 2", "weight = 0", "fault 'too_shallow', evidence 1, weight"),
    "a weight below nothing": ("weight = 2", "weight = -2", "fault 'too_shallow', evidence 1, weight"),
    "a fault twice": ('name = "trunk_forward"', 'name = "too_shallow"', "fault 'too_shallow' occurs twice"),
    "no evidence": ('evidence = [{ signal = "trunk_forward", at = "peak", good = 40, fault = 60 }]', "evidence = []", "evidence"),
    "a band upside down": ("good = [90, 130]", "good = [130, 90]", "shown 'knee_bend': `good` goes from a smaller"),
    "a stretch backwards": ('over = ["start", "peak"]', 'over = ["peak", "start"]', "from one keyframe to a later one"),
    "a stretch cut down to nothing": (
        'over = ["start", "peak"], take = "max", good',
        'over = ["start", "peak"], shift_s = [1.0, -1.0], take = "max", good',
        "takes more than 0.5 seconds off `over`",
    ),
    "a stretch of nothing": ("shift_s = [-0.1, 0.1]", "shift_s = [0.1, 0.1]", "from an earlier instant to a later one"),
    "a shift beyond reason": ("shift_s = [-0.1, 0.1]", "shift_s = [-10, 0.1]", "at most 3 seconds"),
    "a stretch of which nothing is taken": ('take = "max"\nunit', "unit", "`take` says which number"),
    "neither instant nor stretch": ('at = "peak", good', "good", "either `at`, a keyframe, or `over`"),
    "neither signal nor function": ('signal = "trunk_forward", at = "peak", good', 'at = "peak", good', "either a `signal` or a"),
    "another version": ("version = 1", "version = 7", "`version` is 7, this KineBox reads 1"),
    "no version": ("version = 1", "", "`version` is missing; add it"),
    "the name of another file": ('action = "squat"', 'action = "sqat"', "name the file sqat.toml, or correct `action`"),
    "no TOML": ("[[shown]]", "[[shown", "it is no TOML there"),
    "an open quote": ('"Go deeper."', '"Go deeper.', "it is no TOML there"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_mistake_is_one_line_that_names_file_and_key(wrong: str) -> None:
    old, new, said = WRONG[wrong]
    assert old in GOOD
    with pytest.raises(UserError) as error:
        decoded(GOOD.replace(old, new), "teaching/squat.toml" if wrong != "the name of another file" else "squat.toml")
    line = str(error.value)
    assert said in line
    assert line.startswith("teaching file ")
    assert "\n" not in line


@pytest.mark.parametrize("data", [b"", b"\xff\xfe", b"version = 1" + b"0" * 5000, b"[" * 5000])
def test_what_is_no_text_is_refused(data: bytes) -> None:
    with pytest.raises(UserError):
        decode_teaching(data, "squat.toml", VOCABULARY)


def test_shifts_of_one_number_and_of_two_are_told_apart() -> None:
    """msgspec 0.22 reads beyond its memory where a bounded number and a tuple may stand in the same place."""
    gc.freeze()  # What is there already need not be looked through fifty times; thawed again, it would be ever after.
    for _ in range(50):
        decoded(GOOD)
        gc.collect()
    assert Measure(signal="knee_flexion", at="peak", shift_s=0.2).stretch == ("peak", 0.2, "peak", 0.2)
    assert Measure(signal="knee_flexion", over=("start", "end"), shift_s=0.2, take="max").stretch == ("start", 0.2, "end", 0.2)


def test_a_function_has_no_stretch() -> None:
    with pytest.raises(ValueError, match="looks at the whole attempt"):
        _ = Measure(function="jump_height").stretch
    with pytest.raises(ValueError, match="looks at the whole attempt"):
        Measure(function="jump_height", at="peak")
