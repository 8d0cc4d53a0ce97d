"""How soon a fusion that began anew is asked for its log, and how often one that goes on is."""

from services.fusion.log import PART_NS
from services.lesson.asking import EVERY_NS, SILENT_AFTER_NS, SILENT_EVERY_NS, Asking

MS = 1_000_000
BEGIN_NS = 5_000_000 * MS


def asked_ns(parts_ns: list[int], until_ns: int) -> list[int]:
    """When a recorder that looks every 10 ms asks, parts coming at these times."""
    asking = Asking()
    asked = []
    for now_ns in range(BEGIN_NS, until_ns, 10 * MS):
        if any(now_ns - 10 * MS < part_ns <= now_ns for part_ns in parts_ns):
            asking.heard(now_ns)
        if asking.due(now_ns):
            asked.append(now_ns)
    return asked


def test_a_fusion_that_gives_its_parts_is_asked_once_a_second() -> None:
    end_ns = BEGIN_NS + 10 * EVERY_NS
    parts_ns = list(range(BEGIN_NS, end_ns, PART_NS))
    assert len(asked_ns(parts_ns, end_ns)) == 10


def test_a_fusion_that_was_replaced_just_after_a_part_is_asked_before_a_second_of_the_lesson_is_lost() -> None:
    replaced_ns = BEGIN_NS + 3 * EVERY_NS
    parts_ns = list(range(BEGIN_NS, replaced_ns + 1, PART_NS))
    asked = asked_ns(parts_ns, replaced_ns + 3 * EVERY_NS)
    first_ns = min(at for at in asked if at > replaced_ns + SILENT_AFTER_NS)
    assert first_ns - replaced_ns <= SILENT_AFTER_NS + SILENT_EVERY_NS
    # What had not been given out when it died is lost, too, but then its last part was half a second ago.
    assert SILENT_AFTER_NS + SILENT_EVERY_NS < EVERY_NS


def test_a_part_a_little_late_is_not_asked_for() -> None:
    assert SILENT_AFTER_NS > PART_NS + 50 * MS
