"""What the page is told of the room, for every way in which a part of it can be missing."""

import msgspec
import numpy as np
import pytest

from models.messages.health import CameraHealth, FusionHealth, Health, RecorderHealth, ReplayHealth, Restarts, SupervisorHealth
from models.messages.motion import CameraUse, JointState, Motion
from models.messages.trouble import Trouble, TroubleCode
from models.process import Playback
from models.skeleton import coco
from services.tablet.messages import CameraStatus
from services.tablet.room_state import RoomState

S = 1_000_000_000
T0 = 1_000 * S


def room() -> RoomState:
    return RoomState("gym", ("a", "b"), wished_hz=30.0, started_ns=T0)


def motion(t_newest_ns: int, state: JointState = JointState.SEEN, epoch: int = 0) -> Motion:
    return Motion(
        kind="live",
        sequence=0,
        epoch=epoch,
        t_ns=t_newest_ns,
        t_newest_ns=t_newest_ns,
        t_published_ns=t_newest_ns,
        joints_m=np.zeros((coco.COUNT, 3), np.float32),
        covariance_m2=np.zeros((coco.COUNT, 3, 3), np.float32),
        states=np.full(coco.COUNT, state, np.uint8),
        views=np.zeros(coco.COUNT, np.uint32),
        cameras=(CameraUse("a", True, 30.0), CameraUse("b", False, float("nan"))),
    )


def health(
    state: str = "ok",
    source_hz: float = 30.0,
    fresh_hz: float = 14.5,
    target_hz: float = 15.0,
    backlog_ms: float = 20.0,
    reason: str = "",
) -> Health:
    camera = CameraHealth("a", source_hz, fresh_hz, target_hz, 3, backlog_ms, "thunder", {})
    troubles = (Trouble("pictures_damaged", reason),) if reason else ()
    return Health("edge-a", 1, T0, state, troubles, 0.3, 200.0, camera=camera)  # type: ignore[arg-type]


def camera(state: RoomState, now_ns: int) -> CameraStatus:
    return state.status(now_ns, 0).cameras[0]


def judged(state: RoomState, now_ns: int) -> tuple[str, str]:
    status = camera(state, now_ns)
    return status.state, status.reason


def test_cameras_stand_in_the_order_of_the_site_file() -> None:
    assert [entry.name for entry in room().status(T0, 0).cameras] == ["a", "b"]


def test_a_camera_that_was_never_heard_of_is_starting_and_then_lost() -> None:
    assert judged(room(), T0 + 5 * S) == ("starting", "starting")
    assert judged(room(), T0 + 21 * S) == ("lost", "never_seen")


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        (health(), ("ok", "none")),
        (health(state="failed", reason="no file"), ("lost", "failed")),
        (health(source_hz=0.0), ("lost", "no_frames")),
        (health(target_hz=0.0, fresh_hz=0.0), ("ok", "resting")),
        (health(backlog_ms=400.0), ("slow", "backlog")),
        (health(fresh_hz=9.0), ("slow", "behind")),
        (health(fresh_hz=5.0, target_hz=5.0), ("slow", "sparse")),
        (health(state="degraded", reason="Lightning instead of Thunder"), ("slow", "degraded")),
    ],
)
def test_a_camera_is_judged_by_what_it_says(said: Health, expected: tuple[str, str]) -> None:
    state = room()
    state.receive_health(said, T0 + S)
    assert judged(state, T0 + S) == expected
    assert camera(state, T0 + S).detail == said.reason


def test_a_process_that_gets_ready_is_starting_for_as_long_as_it_says_so() -> None:
    state = room()
    getting_ready = Health("edge-a", 1, T0, "starting", (Trouble("getting_ready", "it compiles"),), 0.9, 100.0)
    state.receive_health(getting_ready, T0 + 60 * S)
    assert judged(state, T0 + 61 * S) == ("starting", "starting")
    (process,) = state.status(T0 + 61 * S, 0).processes
    assert (process.state, process.reason) == ("starting", "it compiles")
    assert judged(state, T0 + 64 * S) == ("lost", "never_seen")


@pytest.mark.parametrize(("code", "reason"), [("camera_repeats", "repeats"), ("camera_clock", "clock"), ("camera_ended", "ended")])
@pytest.mark.parametrize("source_hz", [0.0, 0.6])
def test_a_camera_whose_fault_is_known_is_lost_for_that_and_not_for_its_cable(
    code: TroubleCode, reason: str, source_hz: float
) -> None:
    state = room()
    rates = CameraHealth("a", source_hz, source_hz, 15.0, 3, 20.0, "thunder", {})
    troubles = (Trouble("network_missing", "Lightning instead of Thunder"), Trouble(code, "camera 'a': is ill", "cure it"))
    state.receive_health(Health("edge-a", 1, T0, "degraded", troubles, 0.3, 200.0, camera=rates), T0 + S)
    assert judged(state, T0 + S) == ("lost", reason), "also if it shows a picture whenever it is opened again"


def test_a_camera_that_was_ill_for_a_moment_is_slow_and_says_why() -> None:
    state = room()
    rates = CameraHealth("a", 26.0, 14.0, 15.0, 3, 20.0, "thunder", {})
    troubles = (Trouble("camera_repeats", "camera 'a': it shows the same picture again", "cure it"),)
    state.receive_health(Health("edge-a", 1, T0, "degraded", troubles, 0.3, 200.0, camera=rates), T0 + S)
    assert judged(state, T0 + S) == ("slow", "repeats")


def test_a_camera_that_falls_silent_is_lost_and_shows_no_rates() -> None:
    state = room()
    state.receive_health(health(), T0 + S)
    assert camera(state, T0 + 3 * S).fresh_hz == 14.5
    assert judged(state, T0 + 5 * S) == ("lost", "silent")
    assert camera(state, T0 + 5 * S).fresh_hz is None


def test_a_camera_whose_process_ends_is_lost_at_once_and_starts_anew() -> None:
    state = room()
    state.set_alive("edge-a", True, T0)
    state.receive_health(health(), T0 + 30 * S)
    state.set_alive("edge-a", False, T0 + 30 * S)
    assert judged(state, T0 + 30 * S) == ("lost", "process_gone")
    state.set_alive("edge-a", True, T0 + 60 * S)
    assert judged(state, T0 + 61 * S) == ("starting", "starting")
    state.receive_health(health(), T0 + 62 * S)
    assert judged(state, T0 + 62 * S) == ("ok", "none")


def test_a_camera_that_the_supervisor_gave_up_says_why_instead_of_starting_for_ever() -> None:
    state = room()
    state.receive_health(
        Health("edge-a", 3, T0, "failed", (Trouble("given_up", "camera 'a': a.avi is missing"),), 0.0, 0.0), T0 + S
    )
    assert judged(state, T0 + S) == ("lost", "failed")
    assert camera(state, T0 + S).detail == "camera 'a': a.avi is missing"
    state.set_alive("edge-a", False, T0 + S)
    assert judged(state, T0 + S) == ("lost", "failed")


def test_an_evaluation_that_was_never_heard_of_is_starting_for_as_long_as_that_may_take() -> None:
    state = room()
    assert state.status(T0 + 5 * S, 0).evaluation.state == "starting"
    assert state.status(T0 + 21 * S, 0).evaluation.state == "unknown"
    state.set_alive("evaluation", True, T0 + 30 * S)
    assert state.status(T0 + 31 * S, 0).evaluation.state == "starting"
    state.set_alive("evaluation", False, T0 + 32 * S)
    assert state.status(T0 + 33 * S, 0).evaluation.state == "unknown"


def test_an_evaluation_that_falls_silent_is_not_taken_for_one_that_starts() -> None:
    state = room()
    state.receive_health(Health("evaluation", 1, T0, "ok", (), 0.1, 100.0), T0)
    assert state.status(T0 + 9 * S, 0).evaluation.state == "unknown"


def given_up(process: str) -> Health:
    supervisor = SupervisorHealth("1", T0, (Restarts(process, 5, T0, "was ended by SIGKILL", "ended 6 times within 60 s"),))
    return Health("supervisor", 3, T0, "failed", (Trouble("given_up", f"{process} is given up"),), 0.0, 20.0, supervisor=supervisor)


def test_that_there_was_a_server_before_this_one_is_known_from_the_supervisor_alone() -> None:
    state = room()
    assert not state.restarted
    state.receive_health(given_up("edge-a"), T0)
    assert not state.restarted
    state.receive_health(given_up("tablet"), T0)
    assert state.restarted


def test_a_camera_that_was_given_up_is_told_from_one_that_will_return() -> None:
    state = room()
    state.receive_health(given_up("edge-a"), T0)
    state.receive_health(Health("edge-a", 3, T0, "failed", (Trouble("given_up", "ended 6 times"),), 0.0, 0.0), T0)
    state.set_alive("edge-b", False, T0)
    assert [entry.reason for entry in state.status(T0, 0).cameras] == ["given_up", "process_gone"]
    assert judged(state, T0 + 60 * S) == ("lost", "given_up"), "it does not become true by silence that it returns"


def everybody_at_work() -> RoomState:
    state = room()
    for process in ("fusion", "edge-a", "recorder", "tablet"):
        state.set_alive(process, True, T0)
    state.receive_health(health(), T0 + S)
    return state


@pytest.mark.parametrize("order", [("edge-a", "fusion"), ("fusion", "edge-a")])
def test_cameras_have_not_stopped_because_the_router_did(order: tuple[str, str]) -> None:
    state = everybody_at_work()
    for index, process in enumerate(order):
        state.set_alive(process, False, T0 + S + index)
    assert judged(state, T0 + S + 300_000_000) == ("ok", "none")
    assert judged(state, T0 + 9 * S) == ("unknown", "unheard"), "nobody can hear it, and that is not its fault"
    assert camera(state, T0 + 9 * S).fresh_hz is None
    states = {process.name: process.state for process in state.status(T0 + 9 * S, 0).processes}
    assert states == {"edge-a": "unknown"}
    state.set_alive("fusion", True, T0 + 9 * S)
    state.set_alive("edge-a", True, T0 + 9 * S + 1)
    state.receive_health(health(), T0 + 10 * S)
    assert judged(state, T0 + 12 * S) == ("ok", "none")


def test_a_camera_that_does_not_return_with_the_router_has_stopped() -> None:
    state = everybody_at_work()
    state.set_alive("edge-a", False, T0 + S)
    state.set_alive("fusion", False, T0 + S)
    state.set_alive("fusion", True, T0 + 2 * S)
    assert judged(state, T0 + 3 * S) == ("ok", "none")
    assert judged(state, T0 + 4 * S) == ("lost", "process_gone")


def test_once_the_supervisor_routes_a_camera_that_stops_is_lost_and_not_unheard() -> None:
    state = everybody_at_work()
    state.set_alive("fusion", False, T0 + 10 * S)
    state.set_alive("edge-a", False, T0 + 10 * S)
    state.receive_health(given_up("fusion"), T0 + 12 * S)  # It is heard, so somebody routes; fusion's token never comes back.
    assert judged(state, T0 + 13 * S) == ("unknown", "unheard"), "it may still be on its way back"
    state.set_alive("edge-a", True, T0 + 13 * S)
    state.receive_health(health(), T0 + 90 * S)
    state.receive_health(given_up("fusion"), T0 + 99 * S)
    state.set_alive("edge-a", False, T0 + 100 * S)
    assert judged(state, T0 + 100 * S) == ("lost", "process_gone")
    states = {process.name: process.state for process in state.status(T0 + 103 * S, 0).processes}
    assert states["edge-a"] == "gone"


def test_a_camera_that_does_not_find_the_supervisor_that_routes_has_stopped() -> None:
    state = everybody_at_work()
    state.set_alive("fusion", False, T0 + 10 * S)
    state.set_alive("edge-a", False, T0 + 10 * S)
    for second in range(12, 16):
        state.receive_health(given_up("fusion"), T0 + second * S)
    assert judged(state, T0 + 15 * S) == ("lost", "process_gone")


def test_that_another_process_is_given_up_is_no_news_of_the_router() -> None:
    state = everybody_at_work()
    state.set_alive("fusion", False, T0 + 10 * S)
    state.set_alive("edge-a", False, T0 + 10 * S)
    state.receive_health(given_up("recorder"), T0 + 10 * S)
    assert judged(state, T0 + 20 * S) == ("unknown", "unheard")


def test_a_camera_that_stopped_before_the_router_did_is_not_forgotten() -> None:
    state = everybody_at_work()
    state.set_alive("edge-a", False, T0 + S)
    state.set_alive("fusion", False, T0 + 3 * S)
    assert judged(state, T0 + 3 * S) == ("lost", "process_gone")


def test_rate_and_latency_are_those_of_the_last_seconds() -> None:
    state = room()
    for frame in range(150):
        now_ns = T0 + frame * S // 30
        state.receive_motion(motion(now_ns - (80 + frame % 10) * 1_000_000), now_ns)
    now_ns = T0 + 149 * S // 30
    status = state.status(now_ns, 0)
    assert status.live_hz == pytest.approx(30.0, abs=0.5)
    assert status.latency is not None
    assert status.latency.p50_ms == pytest.approx(84.0, abs=1.0)
    assert status.latency.p95_ms == pytest.approx(89.0, abs=1.0)


def test_latency_is_the_age_of_the_figure_and_not_of_the_newest_picture_used() -> None:
    state = room()
    state.receive_motion(msgspec.structs.replace(motion(T0), t_ns=T0 - 60_000_000), T0 + 20_000_000)
    latency = state.status(T0 + 20_000_000, 0).latency
    assert latency is not None
    assert latency.p50_ms == pytest.approx(80.0)


def test_a_figure_that_is_foretold_is_as_old_as_what_it_rests_on() -> None:
    state = room()
    state.receive_motion(msgspec.structs.replace(motion(T0), t_ns=T0 + 60_000_000), T0 + 20_000_000)
    latency = state.status(T0 + 20_000_000, 0).latency
    assert latency is not None
    assert latency.p50_ms == pytest.approx(20.0)


@pytest.mark.parametrize("nonsense", [float("nan"), float("inf"), float("-inf")])
def test_figures_that_are_none_are_not_known_and_the_state_goes_on(nonsense: float) -> None:
    state = room()
    rates = CameraHealth("a", nonsense, nonsense, nonsense, 3, nonsense, "thunder", {})
    state.receive_health(Health("edge-a", 1, T0, "ok", (), nonsense, nonsense, camera=rates), T0)
    fusion = FusionHealth(nonsense, nonsense, nonsense, 0, {}, "found")
    state.receive_health(Health("fusion", 2, T0, "ok", (), nonsense, nonsense, fusion=fusion), T0)
    status = state.status(T0, 0)
    assert judged(state, T0) == ("slow", "degraded")
    seen = status.cameras[0]
    assert (seen.source_hz, seen.fresh_hz, seen.target_hz, seen.backlog_ms) == (None, None, None, None)
    assert [(process.cpu_cores, process.rss_mib) for process in status.processes] == [(None, None)] * 2
    assert status.cpu_load is None


def test_without_motion_there_is_no_rate_and_no_latency() -> None:
    state = room()
    state.receive_motion(motion(T0), T0)
    status = state.status(T0 + 10 * S, 0)
    assert status.live_hz == 0.0
    assert status.latency is None
    assert status.motion_age_ms == pytest.approx(10_000)


def test_a_camera_counts_as_used_only_while_something_is_seen() -> None:
    state = room()
    state.receive_health(health(), T0)
    state.receive_motion(motion(T0), T0)
    assert [entry.used for entry in state.status(T0, 0).cameras] == [True, False]
    state.receive_motion(motion(T0, JointState.GUESSED), T0)
    assert not camera(state, T0).used


def test_fusion_that_is_silent_or_gone_knows_nothing_of_the_pupil() -> None:
    state = room()
    fusion = FusionHealth(30.0, 4.0, 0.8, 0, {}, "found")
    state.receive_health(Health("fusion", 2, T0, "ok", (), 0.2, 100.0, fusion=fusion), T0)
    assert state.status(T0, 0).pupil == "found"
    assert state.status(T0 + 10 * S, 0).pupil == "unknown"
    state.set_alive("fusion", False, T0)
    assert state.status(T0, 0).pupil == "unknown"


def test_what_speaks_against_the_calibration_is_passed_on_while_fusion_says_so() -> None:
    state = room()
    fusion = FusionHealth(30.0, 4.0, 0.8, 0, {}, "found")
    said = (Trouble("camera_unheard", "no word from b"), Trouble("cameras_exchanged", "a and b seem to be exchanged"))
    assert state.status(T0, 0).calibration is None
    state.receive_health(Health("fusion", 2, T0, "degraded", said, 0.2, 100.0, fusion=fusion), T0)
    assert state.status(T0, 0).calibration == "cameras_exchanged"
    state.receive_health(Health("fusion", 2, T0 + S, "degraded", said[:1], 0.2, 100.0, fusion=fusion), T0 + S)
    assert state.status(T0 + S, 0).calibration is None


def test_failures_that_the_supervisor_reports_are_passed_on() -> None:
    state = room()
    state.receive_health(
        Health("supervisor", 3, T0, "failed", (Trouble("given_up", "edge-a was given up after 5 restarts"),), 0.0, 20.0), T0
    )
    (process,) = state.status(T0, 0).processes
    assert (process.name, process.state, process.reason) == ("supervisor", "failed", "edge-a was given up after 5 restarts")


def test_a_process_that_was_given_up_is_failed_and_not_only_gone() -> None:
    state = room()
    state.set_alive("edge-a", True, T0)
    state.receive_health(health(), T0)
    state.set_alive("edge-a", False, T0 + 1)
    assert state.status(T0 + 2, 0).processes[0].state == "gone"
    state.receive_health(Health("edge-a", 9, T0, "failed", (Trouble("given_up", "ended 6 times"),), 0.0, 0.0), T0 + 3)
    assert state.status(T0 + 4, 0).processes[0].state == "failed"


def test_a_new_epoch_is_passed_on() -> None:
    state = room()
    state.receive_motion(motion(T0, epoch=4), T0)
    assert state.status(T0, 0).epoch == 4


def recorder(lesson: str, recorded_s: float = 61.0) -> Health:
    said = RecorderHealth(lesson, "7b", recorded_s, 2_000_000, 0)
    return Health("recorder", 5, T0, "ok", (), 0.0, 50.0, recorder=said)


def test_recording_is_shown_while_the_recorder_says_so_and_no_longer() -> None:
    state = room()
    assert state.status(T0, 0).recording is None
    state.receive_health(recorder(""), T0)
    assert state.status(T0, 0).recording is None
    state.receive_health(recorder("2026-11-22-7b"), T0)
    recording = state.status(T0, 0).recording
    assert recording is not None
    assert (recording.title, recording.recorded_s) == ("7b", 61.0)
    assert state.status(T0 + 4 * S, 0).recording is None, "a recorder that is silent may be dead"
    state.receive_health(recorder("2026-11-22-7b"), T0 + 5 * S)
    state.set_alive("recorder", False, T0 + 5 * S)
    assert state.status(T0 + 5 * S, 0).recording is None


def test_that_nothing_is_recorded_is_said_by_the_recorder_and_not_by_its_silence() -> None:
    state = room()
    assert not state.status(T0, 0).nothing_recorded, "it may go on with a lesson that was cut short"
    state.receive_health(Health("recorder", 5, T0, "starting", (Trouble("getting_ready", "lessons are completed"),), 0.0, 50.0), T0)
    assert not state.status(T0, 0).nothing_recorded
    state.receive_health(recorder("2026-11-22-7b"), T0)
    assert not state.status(T0, 0).nothing_recorded
    assert not state.status(T0 + 4 * S, 0).nothing_recorded
    state.receive_health(recorder(""), T0 + 5 * S)
    assert state.status(T0 + 5 * S, 0).nothing_recorded
    state.set_alive("recorder", False, T0 + 5 * S)
    assert not state.status(T0 + 5 * S, 0).nothing_recorded


def test_of_a_lesson_that_is_played_nothing_is_recorded() -> None:
    lesson = Playback("lesson.mcap", "7b", began_wall_ns=1_764_000_000 * S, speed=1.0, loop=True)
    state = RoomState("gym", ("a", "b"), wished_hz=30.0, started_ns=T0, playback=lesson)
    assert state.status(T0, 0).nothing_recorded


def test_what_is_played_never_looks_live_even_before_the_replay_is_heard() -> None:
    lesson = Playback("lesson.mcap", "7b", began_wall_ns=1_764_000_000 * S, speed=0.5, loop=True)
    state = RoomState("gym", ("a", "b"), wished_hz=30.0, started_ns=T0, playback=lesson)
    shown = state.status(T0, 0).replay
    assert shown is not None
    assert (shown.title, shown.began_ms, shown.position_s) == ("7b", 1_764_000_000_000, None)
    state.receive_health(Health("replay", 5, T0, "ok", (), 0.0, 50.0, replay=ReplayHealth(3.0, 60.0, 0.5)), T0)
    shown = state.status(T0, 0).replay
    assert shown is not None
    assert (shown.position_s, shown.length_s) == (3.0, 60.0)
    assert room().status(T0, 0).replay is None
