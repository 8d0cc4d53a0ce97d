"""The health message counts what happened in its second and says in words what is wrong."""

import pytest

from edge.meter import Meter
from models.messages.health import Health
from models.messages.trouble import SOURCE_CODES, SourceCode, Trouble
from models.process import Resources

SECOND_NS = 1_000_000_000
USED = Resources(0.4, 120.0)
LOST = Trouble("network_missing", "network lightning is damaged")


def meter() -> Meter:
    return Meter("edge-cam01", 77, "cam01", t_report_ns=0, t_picture_ns=0)


def told(health: Health) -> list[tuple[str, str]]:
    return [(trouble.code, trouble.words) for trouble in health.troubles]


def test_rates_and_costs_are_of_the_last_second_and_totals_go_on() -> None:
    counted = meter()
    for k in range(30):
        counted.grabbed(k * SECOND_NS // 30, k * SECOND_NS // 30, 1)
    counted.inferred, counted.skipped, counted.spent_ns = 10, 3, {"pose": 250_000_000}
    counted.waited(4_000_000)
    counted.waited(9_000_000)
    assert not counted.is_due(SECOND_NS - 1)
    assert counted.is_due(SECOND_NS)
    health = counted.report(SECOND_NS, 10.0, "thunder", (), USED)
    camera = health.camera
    assert camera is not None
    assert (health.process, health.pid, health.state, health.reason, health.cpu_cores, health.rss_mib) == (
        "edge-cam01",
        77,
        "ok",
        "",
        0.4,
        120.0,
    )
    assert (camera.source_hz, camera.fresh_hz, camera.target_hz, camera.skipped, camera.backlog_ms) == (30, 10, 10, 3, 9)
    assert camera.stage_ms == {"pose": 25.0}
    later = counted.report(2 * SECOND_NS, 10.0, "thunder", (), USED).camera
    assert later is not None
    assert (later.source_hz, later.fresh_hz, later.skipped, later.backlog_ms, later.stage_ms) == (0, 0, 3, 0, {"pose": 0.0})


@pytest.mark.parametrize(
    ("silent_s", "damaged", "others", "expected"),
    [
        (3, 0, (), [("camera_silent", "camera 'cam01' has shown nothing for 3 s")]),
        (0, 4, (), [("pictures_damaged", "camera 'cam01': 4 damaged pictures in the last second")]),
        (0, 0, (LOST,), [("network_missing", "network lightning is damaged")]),
    ],
)
def test_what_is_wrong_is_said(silent_s: int, damaged: int, others: tuple[Trouble, ...], expected: list[tuple[str, str]]) -> None:
    counted = meter()
    now_ns = 10 * SECOND_NS
    counted.grabbed(now_ns - silent_s * SECOND_NS, now_ns - silent_s * SECOND_NS, 1)
    counted.in_vain(now_ns)
    counted.damaged = damaged
    health = counted.report(now_ns, 10.0, "thunder", others, USED)
    assert (health.state, told(health)) == ("degraded", expected)
    assert counted.report(now_ns, 10.0, "thunder", (), USED).state == ("degraded" if silent_s else "ok")


@pytest.mark.parametrize("code", SOURCE_CODES)
def test_a_camera_whose_fault_is_known_is_not_said_to_be_silent_as_well(code: SourceCode) -> None:
    counted = meter()
    counted.in_vain(10 * SECOND_NS)
    health = counted.report(10 * SECOND_NS, 10.0, "thunder", (Trouble(code, "it is ill"),), USED)
    assert told(health) == [(code, "it is ill")]
    assert health.camera is not None
    assert health.camera.source_hz == 0


def test_a_process_that_did_not_look_does_not_blame_the_camera() -> None:
    counted = meter()
    counted.grabbed(SECOND_NS, SECOND_NS, 1)
    assert counted.report(6 * SECOND_NS, 10.0, "thunder", (), USED).reason == ""


def test_pictures_that_were_caught_up_with_do_not_make_the_source_look_faster() -> None:
    counted = meter()
    counted.grabbed(SECOND_NS, SECOND_NS, 30)
    counted.report(SECOND_NS, 10.0, "thunder", (), USED)
    counted.report(2 * SECOND_NS, 10.0, "thunder", (), USED)
    counted.grabbed(3 * SECOND_NS, 3 * SECOND_NS, 60)
    camera = counted.report(3 * SECOND_NS, 10.0, "thunder", (), USED).camera
    assert camera is not None
    assert camera.source_hz == pytest.approx(30.0)


def test_a_camera_that_falls_silent_is_reported_at_once_and_not_with_the_rate_that_it_had() -> None:
    counted = meter()
    for k in range(9):
        counted.grabbed(k * SECOND_NS // 30, k * SECOND_NS // 30, 1)
    counted.in_vain(SECOND_NS * 95 // 100)
    assert not counted.is_due(SECOND_NS * 95 // 100)
    counted.in_vain(SECOND_NS * 98 // 100)
    assert counted.is_due(SECOND_NS * 98 // 100)
    health = counted.report(SECOND_NS * 98 // 100, 10.0, "thunder", (), USED)
    assert health.camera is not None
    assert health.camera.source_hz == 0
    counted.in_vain(SECOND_NS)
    assert not counted.is_due(SECOND_NS), "once is enough"


def test_a_camera_of_one_picture_a_second_is_not_silent_between_them() -> None:
    counted = meter()
    for k in range(3):
        counted.grabbed(k * SECOND_NS, k * SECOND_NS, 1)
    counted.in_vain(2 * SECOND_NS + SECOND_NS * 9 // 10)
    assert counted.report(3 * SECOND_NS, 1.0, "thunder", (), USED).state == "ok"


def test_a_covered_lens_is_said_and_one_bright_picture_in_the_second_denies_it() -> None:
    counted = meter()
    for bright in (11.0, None, 9.0):
        counted.saw(bright)
    covered = counted.report(SECOND_NS, 10.0, "thunder", (), USED)
    assert (covered.state, told(covered)) == ("degraded", [("camera_dark", "camera 'cam01' shows black pictures")])
    for bright in (9.0, 61.0, 9.0):
        counted.saw(bright)
    assert counted.report(2 * SECOND_NS, 10.0, "thunder", (), USED).state == "ok"
    assert counted.report(3 * SECOND_NS, 10.0, "thunder", (), USED).state == "ok", "nothing was looked at: nothing is known"


def test_every_refused_plan_is_counted_in_its_second_and_no_longer() -> None:
    counted = meter()
    counted.refused_plan("it is for camera 'cam09'")
    counted.refused_plan("3 bytes are no message")
    health = counted.report(SECOND_NS, 10.0, "thunder", (), USED)
    assert told(health) == [
        ("plans_refused", "camera 'cam01': 2 plans of fusion's could not be read in the last second (3 bytes are no message)")
    ]
    assert counted.report(2 * SECOND_NS, 10.0, "thunder", (), USED).state == "ok"
