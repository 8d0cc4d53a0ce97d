"""Fusion's log: who gets it, when a segment begins, and when it ends."""

from models.messages.lesson import LEASE_NS, Entry, SegmentRequest
from services.fusion.log import MAX_PART_BYTES, PART_NS, SegmentLog

NOW_NS = 10**12


def test_nothing_is_kept_before_somebody_asks() -> None:
    log = SegmentLog()
    log.add("tick", NOW_NS)
    assert log.part(NOW_NS + 10 * PART_NS) is None


def test_parts_come_twice_a_second_numbered_and_in_order() -> None:
    log = SegmentLog()
    assert log.ask(SegmentRequest(NOW_NS - 5), NOW_NS)
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
    assert log.ask(request, NOW_NS)
    log.add("tick", NOW_NS)
    assert not log.ask(request, NOW_NS + 1)
    assert not log.ask(SegmentRequest(NOW_NS - 1), NOW_NS + 2)
    assert log.ask(SegmentRequest(NOW_NS + 3), NOW_NS + 3)
    part = log.part(NOW_NS + 3 + PART_NS)
    assert part is not None
    assert (part.segment_ns, part.sequence, part.entries) == (NOW_NS + 3, 0, ())


def test_the_log_stops_when_the_recorder_is_gone_and_its_request_begins_anew_when_it_is_back() -> None:
    log = SegmentLog()
    request = SegmentRequest(NOW_NS)
    log.ask(request, NOW_NS)
    assert log.part(NOW_NS + LEASE_NS + 1) is not None
    assert not log.running
    assert log.part(NOW_NS + 2 * LEASE_NS) is None
    assert log.ask(request, NOW_NS + 2 * LEASE_NS)


def test_a_request_that_is_repeated_in_time_keeps_the_log_running() -> None:
    log = SegmentLog()
    request = SegmentRequest(NOW_NS)
    for t_ns in range(NOW_NS, NOW_NS + 5 * LEASE_NS, LEASE_NS // 4):
        log.ask(request, t_ns)
        log.part(t_ns)
    assert log.running


def test_a_damaged_request_from_the_future_does_not_shut_out_the_real_one() -> None:
    log = SegmentLog()
    assert not log.ask(SegmentRequest(2**62), NOW_NS)
    assert log.ask(SegmentRequest(NOW_NS), NOW_NS)


def test_a_flood_is_published_early_instead_of_kept() -> None:
    log = SegmentLog()
    log.ask(SegmentRequest(NOW_NS), NOW_NS)
    log.add("observation", NOW_NS, bytes(MAX_PART_BYTES))
    assert log.part(NOW_NS + 1) is not None
