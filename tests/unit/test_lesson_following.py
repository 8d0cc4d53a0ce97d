"""Following fusion's log: what belongs into a lesson, what is a gap, and when fusion is asked to begin anew."""

from models.messages.lesson import SegmentRequest
from services.lesson.following import Accepted, Following
from tests.synthetic.lesson import SECOND_NS, part

ASKED_NS = 10 * SECOND_NS
SEGMENT_NS = ASKED_NS + 1


def following() -> Following:
    return Following(SegmentRequest(ASKED_NS))


def test_a_segment_is_taken_from_its_first_part_on_without_a_gap() -> None:
    follow = following()
    assert [follow.hear(part(SEGMENT_NS, k), ASKED_NS + k) for k in range(3)] == [Accepted("")] * 3
    assert follow.request == SegmentRequest(ASKED_NS)


def test_what_fusion_logged_for_somebody_before_is_left_out() -> None:
    assert following().hear(part(ASKED_NS - 1, 0), ASKED_NS) is None


def test_a_part_that_comes_twice_is_taken_once() -> None:
    follow = following()
    follow.hear(part(SEGMENT_NS, 0), ASKED_NS)
    assert follow.hear(part(SEGMENT_NS, 0), ASKED_NS) is None
    assert follow.hear(part(SEGMENT_NS, 1), ASKED_NS) == Accepted("")


def test_after_a_lost_part_nothing_is_taken_until_fusion_has_begun_anew() -> None:
    follow = following()
    follow.hear(part(SEGMENT_NS, 0), ASKED_NS)
    lost_ns = ASKED_NS + 5 * SECOND_NS
    assert follow.hear(part(SEGMENT_NS, 2), lost_ns) is None
    assert follow.request == SegmentRequest(lost_ns)
    assert follow.hear(part(SEGMENT_NS, 3), lost_ns + 1) is None
    assert follow.request == SegmentRequest(lost_ns)
    assert follow.hear(part(lost_ns + 2, 0), lost_ns + 3) == Accepted("a part of fusion's log was lost")
    assert follow.hear(part(lost_ns + 2, 1), lost_ns + 4) == Accepted("")


def test_a_lost_beginning_is_no_gap_as_long_as_nothing_was_recorded() -> None:
    follow = following()
    assert follow.hear(part(SEGMENT_NS, 1), ASKED_NS + 9) is None
    assert follow.request == SegmentRequest(ASKED_NS + 9)
    assert follow.hear(part(ASKED_NS + 10, 0), ASKED_NS + 11) == Accepted("")


def test_a_fusion_process_that_was_restarted_leaves_a_gap() -> None:
    follow = following()
    follow.hear(part(SEGMENT_NS, 0), ASKED_NS)
    assert follow.hear(part(SEGMENT_NS + SECOND_NS, 0), ASKED_NS) == Accepted("fusion began anew")


def test_a_lesson_that_is_gone_on_with_begins_with_a_gap() -> None:
    follow = Following(SegmentRequest(ASKED_NS), "the recorder was started again")
    assert follow.hear(part(SEGMENT_NS, 0), ASKED_NS) == Accepted("the recorder was started again")
