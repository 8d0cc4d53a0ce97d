"""Fusion's log: who gets it, when a segment begins, and when it ends."""

import pytest

from models.messages.lesson import LEASE_NS, Entry, EntryKind, SegmentRequest
from services.fusion.log import IN_FLIGHT_NS, MAX_KEPT_BYTES, MAX_PART_BYTES, PART_NS, Answer, SegmentLog

NOW_NS = 10**12


def test_nothing_is_kept_before_somebody_asks() -> None:
    log = SegmentLog()
    log.add("tick", NOW_NS)
    assert log.part(NOW_NS + 10 * PART_NS) is None


def test_parts_come_twice_a_second_numbered_and_in_order() -> None:
    log = SegmentLog()
    assert log.ask(SegmentRequest(NOW_NS - 5), NOW_NS).begins
    log.add("observation", NOW_NS + 1, b"seen")
    log.add("tick", NOW_NS)
    assert log.part(NOW_NS + PART_NS - 1) is None
    first = log.part(NOW_NS + PART_NS)
    assert first is not None
    assert (first.segment_ns, first.sequence) == (NOW_NS, 0)
    assert first.entries == (Entry("observation", NOW_NS + 1, b"seen"), Entry("tick", NOW_NS, b""))
    second = log.part(NOW_NS + 2 * PART_NS)
    assert second is not None
    assert (second.segment_ns, second.sequence, second.entries) == (NOW_NS, 1, ())


def test_a_repeated_request_begins_nothing_and_a_later_one_does() -> None:
    log = SegmentLog()
    request = SegmentRequest(NOW_NS)
    assert log.ask(request, NOW_NS).begins
    log.add("tick", NOW_NS)
    assert log.ask(request, NOW_NS + 1) == Answer()
    assert log.ask(SegmentRequest(NOW_NS - 1), NOW_NS + 2) == Answer()
    assert log.ask(SegmentRequest(NOW_NS + 3), NOW_NS + 3).begins
    part = log.part(NOW_NS + 3 + PART_NS)
    assert part is not None
    assert (part.segment_ns, part.sequence, part.entries) == (NOW_NS + 3, 0, ())


def test_what_a_segment_still_holds_is_given_out_when_the_next_one_begins() -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    assert log.part(NOW_NS + PART_NS) is not None
    log.add("tick", NOW_NS + PART_NS + 1)
    answer = log.ask(SegmentRequest(NOW_NS + PART_NS + 2, 12345), NOW_NS + PART_NS + 3)  # by a damaged message, for instance
    assert answer.begins
    (rest,) = answer.again
    assert (rest.segment_ns, rest.sequence, rest.entries) == (NOW_NS, 1, (Entry("tick", NOW_NS + PART_NS + 1, b""),))


def test_the_log_stops_when_the_recorder_is_gone_and_its_request_begins_anew_when_it_is_back() -> None:
    log = SegmentLog()
    request = SegmentRequest(NOW_NS)
    log.ask(request, NOW_NS)
    assert log.part(NOW_NS + LEASE_NS + 1) is not None
    assert not log.running
    assert log.part(NOW_NS + 2 * LEASE_NS) is None
    assert log.ask(request, NOW_NS + 2 * LEASE_NS).begins


def test_a_request_that_is_repeated_in_time_keeps_the_log_running() -> None:
    log = SegmentLog()
    request = SegmentRequest(NOW_NS)
    for t_ns in range(NOW_NS, NOW_NS + 5 * LEASE_NS, LEASE_NS // 4):
        log.ask(request, t_ns)
        log.part(t_ns)
    assert log.running


def test_a_damaged_request_from_the_future_does_not_shut_out_the_real_one() -> None:
    log = SegmentLog()
    assert log.ask(SegmentRequest(2**62), NOW_NS) == Answer()
    assert log.ask(SegmentRequest(NOW_NS), NOW_NS).begins
    assert log.ask(SegmentRequest(NOW_NS, NOW_NS, 10**6), NOW_NS) == Answer()


def test_a_flood_is_published_early_instead_of_kept() -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    log.add("observation", NOW_NS, bytes(MAX_PART_BYTES))
    assert log.part(NOW_NS + 1) is not None


@pytest.mark.parametrize("kind", ["feedback", "corrections"])
def test_what_was_said_of_an_attempt_goes_at_once_so_that_a_lesson_that_ends_now_holds_it(kind: EntryKind) -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    log.add("observation", NOW_NS + 1, b"seen")
    assert log.part(NOW_NS + 2) is None
    log.add(kind, NOW_NS + 3, b"said")
    part = log.part(NOW_NS + 4)
    assert part is not None
    assert [entry.kind for entry in part.entries] == ["observation", kind]
    log.add("tick", NOW_NS + 5)
    assert log.part(NOW_NS + 6) is None


def running_log(parts: int) -> SegmentLog:
    """A log that has just given out so many parts; its recorder is there."""
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    for number in range(1, parts + 1):
        log.add("tick", NOW_NS + number)
        assert log.part(NOW_NS + number * PART_NS) is not None
        log.ask(SegmentRequest(NOW_NS, NOW_NS, number), NOW_NS + number * PART_NS)
    return log


def test_a_recorder_that_comes_back_gets_what_it_missed_and_fusion_keeps_its_state() -> None:
    log = running_log(8)
    answer = log.ask(SegmentRequest(NOW_NS + 7 * PART_NS, NOW_NS, 3), NOW_NS + 8 * PART_NS)
    assert not answer.begins
    assert [part.sequence for part in answer.again] == [3, 4, 5, 6, 7]
    assert [part.entries[0].t_ns for part in answer.again] == [NOW_NS + number for number in (4, 5, 6, 7, 8)]


def test_a_part_that_is_under_way_is_not_sent_twice_but_a_lost_one_is() -> None:
    log = running_log(4)
    request = SegmentRequest(NOW_NS, NOW_NS, 3)
    assert log.ask(request, NOW_NS + 4 * PART_NS + 1) == Answer()
    assert [part.sequence for part in log.ask(request, NOW_NS + 4 * PART_NS + IN_FLIGHT_NS).again] == [3]


def test_a_part_that_is_not_kept_any_more_makes_a_new_segment() -> None:
    log = running_log(2 * LEASE_NS // PART_NS)
    now_ns = NOW_NS + 2 * LEASE_NS
    assert log.ask(SegmentRequest(NOW_NS, NOW_NS, 0), now_ns).begins
    assert log.ask(SegmentRequest(NOW_NS, NOW_NS, 0), now_ns + 1) == Answer()
    part = log.part(now_ns + PART_NS)
    assert part is not None
    assert (part.segment_ns, part.sequence) == (now_ns, 0)


def test_a_request_for_a_segment_that_fusion_never_had_begins_one() -> None:
    log = running_log(4)
    now_ns = NOW_NS + 4 * PART_NS
    assert log.ask(SegmentRequest(NOW_NS, now_ns - 1, 0), now_ns).begins


def test_what_is_kept_is_bounded_in_bytes() -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    parts = 2 * MAX_KEPT_BYTES // MAX_PART_BYTES
    for number in range(parts):
        log.add("observation", NOW_NS, bytes(MAX_PART_BYTES))
        assert log.part(NOW_NS + number) is not None
    kept = log.ask(SegmentRequest(NOW_NS, NOW_NS, parts // 2), NOW_NS + parts).again
    assert kept
    assert sum(len(entry.payload) for part in kept for entry in part.entries) <= MAX_KEPT_BYTES
    assert log.ask(SegmentRequest(NOW_NS, NOW_NS, 0), NOW_NS + parts).begins


def test_a_part_that_is_too_large_to_be_kept_is_given_out_all_the_same() -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    log.add("health", NOW_NS, bytes(MAX_KEPT_BYTES + 1))
    assert log.part(NOW_NS + 1) is not None
    assert log.ask(SegmentRequest(NOW_NS, NOW_NS, 0), NOW_NS + 2).begins
