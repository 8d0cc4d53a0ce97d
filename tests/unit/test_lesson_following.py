"""Following fusion's log: what belongs into a lesson, what is a gap, and what fusion is asked for."""

from models.messages.lesson import SegmentRequest
from services.lesson.following import Accepted, Following
from tests.synthetic.lesson import SECOND_NS, part

ASKED_NS = 10 * SECOND_NS
SEGMENT_NS = ASKED_NS + 1


def test_a_segment_is_taken_from_its_first_part_on_without_a_gap() -> None:
    follow = Following(ASKED_NS)
    assert follow.request == SegmentRequest(ASKED_NS)
    assert [follow.hear(part(SEGMENT_NS, k)) for k in range(3)] == [Accepted("")] * 3
    assert follow.request == SegmentRequest(ASKED_NS, SEGMENT_NS, 3)


def test_what_fusion_logged_for_somebody_before_is_left_out() -> None:
    assert Following(ASKED_NS).hear(part(ASKED_NS - 1, 0)) is None


def test_a_part_that_comes_twice_is_taken_once() -> None:
    follow = Following(ASKED_NS)
    follow.hear(part(SEGMENT_NS, 0))
    assert follow.hear(part(SEGMENT_NS, 0)) is None
    assert follow.hear(part(SEGMENT_NS, 1)) == Accepted("")


def test_a_lost_part_is_asked_for_and_nothing_is_missing_when_it_came() -> None:
    follow = Following(ASKED_NS)
    follow.hear(part(SEGMENT_NS, 0))
    assert follow.hear(part(SEGMENT_NS, 2)) is None
    assert follow.request == SegmentRequest(ASKED_NS, SEGMENT_NS, 1)
    assert [follow.hear(part(SEGMENT_NS, k)) for k in (1, 2, 3)] == [Accepted("")] * 3


def test_a_lost_beginning_is_asked_for_and_is_no_gap() -> None:
    follow = Following(ASKED_NS)
    assert follow.hear(part(SEGMENT_NS, 1)) is None
    assert follow.request == SegmentRequest(ASKED_NS, SEGMENT_NS, 0)
    assert [follow.hear(part(SEGMENT_NS, k)) for k in (0, 1)] == [Accepted("")] * 2


def test_a_fusion_process_that_was_restarted_leaves_a_gap() -> None:
    follow = Following(ASKED_NS)
    follow.hear(part(SEGMENT_NS, 0))
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 0)) == Accepted("fusion began anew")
    assert follow.hear(part(SEGMENT_NS, 1)) is None
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 1)) == Accepted("")


def test_a_restart_of_fusion_whose_first_part_was_lost_leaves_one_gap() -> None:
    follow = Following(ASKED_NS)
    follow.hear(part(SEGMENT_NS, 0))
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 1)) is None
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 0)) == Accepted("fusion began anew")
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 1)) == Accepted("")


def test_a_lesson_that_is_gone_on_with_has_no_gap_if_fusion_still_has_the_next_part() -> None:
    follow = Following(ASKED_NS, "the recorder was started again", ASKED_NS - SECOND_NS, 7)
    assert follow.request == SegmentRequest(ASKED_NS, ASKED_NS - SECOND_NS, 7)
    assert follow.hear(part(ASKED_NS - SECOND_NS, 7)) == Accepted("")


def test_a_lesson_that_is_gone_on_with_has_a_gap_if_fusion_began_anew() -> None:
    follow = Following(ASKED_NS, "the recorder was started again", ASKED_NS - SECOND_NS, 7)
    assert follow.hear(part(SEGMENT_NS, 0)) == Accepted("the recorder was started again")
