"""How attempts and keyframes that were found are counted."""

import math

import pytest

from models.motions.motion import Attempt
from services.evaluation.attempt import FoundAttempt
from tests.bench.teaching.finding import Decided, Found, attempt_f1, delays_s, energy_f1, keyframe_f1

SQUAT = Attempt("squat", "right", 10.0, 10.5, 11.0, 12.0)
KICK = Attempt("soccer_kick", "left", 20.0, 21.0, 21.3, 22.5)


def _decided(action: str, *moments_s: float) -> Decided:
    start, exertion, peak, end = moments_s
    return Decided(FoundAttempt(action, "right", (start, exertion, peak, end)), moments_s[-1] + 0.4)


def _found(*decided: Decided, energy_s: tuple[tuple[float, ...], ...] = ((), ())) -> Found:
    return Found((SQUAT, KICK), decided, energy_s, 60.0)


def test_what_is_found_as_it_was_counts_in_full() -> None:
    found = _found(_decided("squat", 10.0, 10.5, 11.0, 12.0), _decided("soccer_kick", 20.1, 20.9, 21.4, 22.4))
    assert attempt_f1([found]) == 1.0
    assert keyframe_f1([found], "squat") == keyframe_f1([found], "soccer_kick") == 1.0
    assert delays_s([found]) == pytest.approx([0.4, 0.3])
    assert not found.false


def test_a_keyframe_beside_by_more_than_three_frames_is_missed_and_false() -> None:
    found = _found(_decided("squat", 10.0, 10.5, 11.2, 12.0))
    assert keyframe_f1([found], "squat") == 0.75
    assert keyframe_f1([found], "squat", 2) == 0.0
    assert keyframe_f1([found], "squat", 1) == 1.0


def test_an_attempt_that_is_missed_misses_its_keyframes_and_a_false_one_adds_to_them() -> None:
    found = _found(_decided("squat", 10.0, 10.5, 11.0, 12.0), _decided("squat", 30.0, 30.5, 31.0, 32.0))
    assert attempt_f1([found]) == 2 / 4
    assert attempt_f1([found], "squat") == 2 / 3
    assert keyframe_f1([found], "squat") == 2 * 4 / 12
    assert keyframe_f1([found], "soccer_kick") == 0.0
    assert [one.attempt.moments_s[0] for one in found.false] == [30.0]


def test_another_action_at_the_same_time_or_the_same_one_elsewhere_is_no_find() -> None:
    assert attempt_f1([_found(_decided("star_jump", 10.0, 10.5, 11.0, 12.0))]) == 0.0
    assert attempt_f1([_found(_decided("squat", 11.5, 12.0, 12.5, 13.5))]) == 0.0


def test_one_attempt_is_found_once() -> None:
    twice = _found(_decided("squat", 10.0, 10.5, 11.0, 12.0), _decided("squat", 10.1, 10.6, 11.1, 12.1))
    assert len(twice.pairs) == len(twice.false) == 1


def test_energy_alone_is_counted_by_its_maxima() -> None:
    found = _found(energy_s=((10.55, 11.05, 11.5), ()))
    assert energy_f1([found], "squat") == 2 * 2 / (3 + 4)
    assert energy_f1([found], "soccer_kick") == 0.0
    assert math.isnan(energy_f1([found], "run"))
