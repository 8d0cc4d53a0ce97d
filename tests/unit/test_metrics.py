"""The metrics as Prometheus reads them: parsed with Prometheus's own parser, held against what the processes said."""

import math
from pathlib import Path

import msgspec
import pytest
from prometheus_client.metrics_core import Metric
from prometheus_client.parser import text_string_to_metric_families

from models.messages.health import (
    CameraHealth,
    EvaluationHealth,
    FusionHealth,
    Health,
    MachineHealth,
    RecorderHealth,
    Restarts,
    SupervisorHealth,
)
from models.messages.trouble import Trouble
from services.tablet import metrics, metrics_docs
from services.tablet.messages import Status
from services.tablet.room_state import RoomState

S = 1_000_000_000
T0 = 1_000 * S
PAGE = Path(__file__).parents[2] / "docs" / "metrics.md"
MACHINE = MachineHealth(1.5, 4.0, 1024.0, 2048.0, 61.5, 1_700_000_000 * S - T0, 0.0)


class Room:
    """A room in which the test says what was heard."""

    def __init__(self) -> None:
        self.state = RoomState('gym "A"', ("a", "b"), wished_hz=30.0, started_ns=T0)
        self.now_ns = T0

    def status(self) -> Status:
        return self.state.status(self.now_ns, clients=3)

    def healths(self) -> list[Health]:
        return self.state.healths(self.now_ns)

    def hear(self, process: str, state: str = "ok", **parts: object) -> None:
        troubles = () if state == "ok" else (Trouble("restarting", "edge-a is started again"),)
        said = Health(process, 1, T0, state, troubles, 0.25, 200.0)  # type: ignore[arg-type]
        self.state.receive_health(msgspec.structs.replace(said, **parts), self.now_ns)


def full_room() -> Room:
    room = Room()
    room.hear("edge-a", camera=CameraHealth("a", 30.0, 14.5, 15.0, 7, 20.0, "thunder", {"decode": 4.0, "pose": 24.0}))
    room.hear("fusion", fusion=FusionHealth(29.5, 2.5, 0.5, 4, {"b": 9}, "found"))
    room.hear("recorder", recorder=RecorderHealth("2026-11-22-7b", "7b", 61.5, 2_250_000, 1))
    room.hear("evaluation", evaluation=EvaluationHealth("long_jump", "tablet", "moving", 12, 0.25, 31.5, 2, 0))
    restarts = (Restarts("edge-a", 2, T0, "hung", ""),)
    room.hear("supervisor", "degraded", machine=MACHINE, supervisor=SupervisorHealth("0.1.0", T0, restarts))
    room.state.rejected_bus_messages = 5
    return room


def scrape(room: Room) -> dict[str, Metric]:
    return {metric.name: metric for metric in text_string_to_metric_families(metrics.render(room).decode())}


def samples(room: Room) -> dict[tuple[str, ...], float]:
    """Values by name and labels' values."""
    return {(sample.name, *sample.labels.values()): sample.value for metric in scrape(room).values() for sample in metric.samples}


def test_what_the_processes_said_is_what_prometheus_reads_in_base_units() -> None:
    read = samples(full_room())
    expected = {
        ("kinebox_camera_state", "a", "ok"): 1,
        ("kinebox_camera_state", "a", "lost"): 0,
        ("kinebox_camera_state", "b", "starting"): 1,
        ("kinebox_camera_source_hertz", "a"): 30,
        ("kinebox_camera_inference_hertz", "a"): 14.5,
        ("kinebox_camera_inference_target_hertz", "a"): 15,
        ("kinebox_camera_backlog_seconds", "a"): 0.02,
        ("kinebox_camera_skipped_frames_total", "a"): 7,
        ("kinebox_camera_stage_cpu_seconds", "a", "pose"): 0.024,
        ("kinebox_fusion_step_cpu_seconds",): 0.0025,
        ("kinebox_fusion_rejected_messages",): 4,
        ("kinebox_fusion_ignored_observations", "b"): 9,
        ("kinebox_process_state", "supervisor", "degraded"): 1,
        ("kinebox_process_cpu_cores", "fusion"): 0.25,
        ("kinebox_process_resident_memory_bytes", "fusion"): 200 * 2**20,
        ("kinebox_process_restarts_total", "edge-a"): 2,
        ("kinebox_process_restarts_total", "fusion"): 0,
        ("kinebox_machine_memory_free_bytes",): 2**30,
        ("kinebox_machine_disk_free_bytes",): 2**31,
        ("kinebox_machine_temperature_celsius",): 61.5,
        ("kinebox_machine_clock_seconds",): 1_700_000_000,
        ("kinebox_recorder_safe_seconds",): 61.5,
        ("kinebox_recorder_file_bytes",): 2_250_000,
        ("kinebox_evaluation_attempts_total",): 12,
        ("kinebox_evaluation_moving",): 1,
        ("kinebox_evaluation_step_cpu_seconds",): 0.00025,
        ("kinebox_evaluation_attempt_cpu_seconds",): 0.0315,
        ("kinebox_evaluation_missed_motions",): 2,
        ("kinebox_rejected_messages_total", "bus"): 5,
        ("kinebox_clients",): 3,
        ("kinebox_pupil_found",): 1,
    }
    assert {key: read.get(key) for key in expected} == pytest.approx(expected)


def test_which_box_it_is_survives_quotes_in_its_name() -> None:
    (sample,) = scrape(full_room())["kinebox_box_info"].samples
    assert sample.labels == {"room": 'gym "A"', "version": "0.1.0"}


def test_a_camera_that_is_lost_has_no_rate_rather_than_its_last_one() -> None:
    room = full_room()
    room.now_ns += 10 * S
    read = samples(room)
    assert read["kinebox_camera_state", "a", "lost"] == 1
    assert ("kinebox_camera_inference_hertz", "a") not in read
    assert ("kinebox_machine_disk_free_bytes",) not in read
    assert read["kinebox_process_health_age_seconds", "edge-a"] == pytest.approx(10)


def test_figures_that_are_none_have_no_sample() -> None:
    room = full_room()
    nan = math.nan
    room.hear("edge-a", cpu_cores=nan, rss_mib=nan, camera=CameraHealth("a", nan, nan, nan, 0, nan, "thunder", {"pose": nan}))
    room.hear("fusion", fusion=FusionHealth(nan, nan, nan, 0, {}, "found"))
    room.hear("supervisor", machine=msgspec.structs.replace(MACHINE, disk_free_mib=nan, temperature_c=None))
    assert not [key for key, value in samples(room).items() if not math.isfinite(value)]


def test_what_another_process_says_in_the_name_of_fusion_or_the_recorder_is_not_measured() -> None:
    room = full_room()
    own = samples(room)
    room.hear("edge-a", fusion=FusionHealth(1.0, 1.0, 1.0, 1, {}, "found"), recorder=RecorderHealth("", "", 1.0, 1, 9))
    read = samples(room)
    assert {key: value for key, value in read.items() if key[0].startswith(("kinebox_fusion", "kinebox_recorder"))} == {
        key: value for key, value in own.items() if key[0].startswith(("kinebox_fusion", "kinebox_recorder"))
    }


def test_machine_troubles_are_named() -> None:
    room = full_room()
    room.hear("supervisor", machine=msgspec.structs.replace(MACHINE, disk_free_mib=50.0))
    read = samples(room)
    assert read["kinebox_machine_trouble", "disk_full"] == 1
    assert read["kinebox_machine_trouble", "hot"] == 0


def test_every_metric_says_what_it_means_and_is_named_by_the_conventions() -> None:
    for metric in scrape(full_room()).values():
        assert metric.name.startswith("kinebox_")
        assert metric.documentation.endswith(".")
        assert not any(part in metric.name for part in ("_ms", "_mb", "_hz", "milli", "mega")), f"{metric.name} is no base unit"


def test_the_page_about_the_metrics_is_current() -> None:
    assert PAGE.read_text() == metrics_docs.render(), "run: python -m services.tablet.metrics_docs > docs/metrics.md"


def test_the_page_lists_every_metric_that_is_scraped() -> None:
    page = PAGE.read_text()
    assert all(f"| `{sample.name}`" in page for metric in scrape(full_room()).values() for sample in metric.samples[:1])
