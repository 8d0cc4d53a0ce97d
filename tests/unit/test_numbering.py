"""Numbers of attempts: those of the lesson's file, or of the evaluation's count; never two counts that drift apart."""

from services.tablet.numbering import Numbering


def test_where_nobody_has_said_anything_the_first_on_the_list_is_the_first() -> None:
    assert Numbering().of([10, 20, 30]) == [1, 2, 3]
    assert Numbering().of([]) == []


def test_the_evaluation_s_count_goes_for_those_before_and_after_its_word() -> None:
    numbering = Numbering()
    numbering.counted(30, 53)
    assert numbering.of([10, 20, 30, 40]) == [51, 52, 53, 54]


def test_the_count_is_that_of_an_attempt_which_is_not_on_the_list_yet() -> None:
    numbering = Numbering()
    numbering.counted(30, 53)
    assert numbering.of([10, 20]) == [51, 52]
    assert numbering.of([10, 20, 40]) == [51, 52, 54]
    assert numbering.of([40]) == [54]


def test_an_older_word_of_the_evaluation_undoes_no_newer_one() -> None:
    numbering = Numbering()
    numbering.counted(30, 53)
    numbering.counted(20, 9)
    assert numbering.of([30]) == [53]


def test_those_that_follow_an_attempt_which_left_the_list_go_on_from_its_number() -> None:
    numbering, listed = Numbering(), list(range(1, 51))
    for attempt in range(51, 121):
        listed.append(attempt)
        oldest = numbering.of(listed)[0]
        numbering.passed(listed.pop(0), oldest)
    assert numbering.of(listed) == listed


def test_what_the_lesson_s_file_holds_has_its_number_there() -> None:
    numbering = Numbering()
    numbering.counted(40, 99)
    numbering.recorded(7, (20, 30, 40))
    assert numbering.of([20, 30, 40]) == [5, 6, 7]


def test_an_attempt_on_its_way_into_the_file_has_the_next_number() -> None:
    numbering = Numbering()
    numbering.recorded(2, (20, 30))
    assert numbering.of([20, 30, 40, 50]) == [1, 2, 3, 4]
    numbering.recorded(3, (20, 30, 40))
    assert numbering.of([20, 30, 40, 50]) == [1, 2, 3, 4]


def test_an_attempt_that_the_file_does_not_hold_has_no_number_and_shifts_none() -> None:
    numbering = Numbering()
    numbering.recorded(1, (20,))
    assert numbering.of([20, 30]) == [1, 2]
    numbering.recorded(2, (20, 40))
    assert numbering.of([20, 30, 40]) == [1, None, 2]


def test_attempts_after_the_recording_go_on_from_it_also_when_its_own_have_left_the_list() -> None:
    numbering = Numbering()
    numbering.recorded(2, (20, 30))
    listed = [20, 30, 40, 50]
    for attempt in (60, 70, 80):
        listed.append(attempt)
        numbers = numbering.of(listed)
        numbering.passed(listed.pop(0), numbers[0])
    assert listed == [50, 60, 70, 80]
    assert numbering.of(listed) == [4, 5, 6, 7]


def test_a_list_that_begins_anew_is_counted_from_one() -> None:
    numbering = Numbering()
    numbering.counted(30, 53)
    numbering.recorded(7, (20, 30, 40))
    numbering.begin()
    assert numbering.of([50, 60]) == [1, 2]
