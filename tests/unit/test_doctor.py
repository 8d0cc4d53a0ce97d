"""The doctor's judgement without a machine: facts go in, findings come out."""

import datetime as dt
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import get_args

import msgspec
import pytest

from models.config.site import SITE_VERSION, CameraConfig, Site
from models.errors import UserError
from models.messages.health import CameraHealth, FusionHealth, Health, MachineHealth, Restarts, SupervisorHealth
from models.messages.trouble import MachineCode, Trouble, TroubleCode
from services.doctor.box import BUSY_SHARE, BoxFacts, judge_box
from services.doctor.finding import Examined, Fact, Finding, fault_of
from services.doctor.folders import FolderProblem
from services.doctor.lateness import LATE_MS, Age
from services.doctor.listen import Heard
from services.doctor.machine import MachineFacts, judge_machine
from services.doctor.ports import Port, Ports, judge_ports
from services.doctor.processes import BoxProcess, RunningBox
from services.doctor.report import as_json, as_text

S = 1_000_000_000
NOW = 5_000 * S
NAMES = ("fusion", "edge-a", "edge-b", "tablet", "supervisor")
SITE = Site(
    version=SITE_VERSION,
    name="gym",
    calibration="rig.toml",
    cameras=[CameraConfig(name=n, kind="video", path=f"{n}.avi") for n in "ab"],
)
MACHINE = MachineHealth(1.9, 2.0, 4000.0, 50_000.0, 55.0, 0, 0.0)


def health(name: str, state: str = "ok", *troubles: Trouble, **parts: object) -> Health:
    if name.startswith("edge-"):
        parts.setdefault("camera", CameraHealth(name[5:], 30.0, 15.0, 15.0, 0, 20.0, "thunder", {}))
    if name == "supervisor":
        parts = {"machine": MACHINE, "supervisor": SupervisorHealth("1.0", NOW - 90 * S, ())} | parts
    if name == "fusion":
        parts.setdefault("fusion", FusionHealth(30.0, 2.0, 0.9, 0, {}, "found"))
    return Health(name, 1, NOW, state, troubles, 0.25, 50.0, **parts)  # type: ignore[arg-type]


def box(*said: Health, **changes: object) -> BoxFacts:
    """A box that runs well, but for what these say instead."""
    healths = {name: health(name) for name in NAMES} | {each.process: each for each in said}
    heard = Heard("answers", "answers", 5.0, healths, set(NAMES), live=150)
    facts = BoxFacts(SITE, Path("data"), RunningBox(Path("site.toml")), NAMES, heard, "1.0", NOW)
    return replace(facts, **changes)  # type: ignore[arg-type]


def restarted(count: int, ago_s: float, given_up: str = "") -> Health:
    restarts = (Restarts("edge-a", count, NOW - round(ago_s * S), "hung", given_up),)
    return health("supervisor", supervisor=SupervisorHealth("1.0", NOW - 9000 * S, restarts))


def whats(examined: Examined) -> list[str]:
    return [finding.what for finding in examined.findings]


def test_of_a_box_that_runs_well_nothing_is_found() -> None:
    judged = judge_box(box())
    assert judged.findings == ()
    (fact,) = judged.facts
    assert fact.words == "version 1.0, up for 90 s, 5 of 5 processes speak, 30 figures a second"


def test_a_restart_long_ago_is_no_finding_but_many_are() -> None:
    assert whats(judge_box(box(restarted(1, 3000)))) == []
    assert whats(judge_box(box(restarted(1, 30)))) == ["edge-a was started again once; 30 s ago it hung"]
    assert whats(judge_box(box(restarted(3, 3000)))) == ["edge-a was started again 3 times; 50 min ago it hung"]


def test_a_process_that_was_given_up_is_told_once_and_not_as_missing_too() -> None:
    facts = box(restarted(2, 5, "ended 3 times"), health("edge-a", "failed", Trouble("given_up", "ended 3 times"), camera=None))
    facts.heard.alive.discard("edge-a")
    judged = judge_box(facts)
    assert whats(judged) == ["edge-a is given up and does not run any more: ended 3 times"]
    assert "4 of 5 processes speak" in judged.facts[0].words, "for edge-a the supervisor speaks"


def test_who_is_on_the_bus_and_says_nothing_hangs_and_who_is_not_is_missing() -> None:
    facts = box()
    del facts.heard.healths["tablet"]
    assert whats(judge_box(facts)) == ["tablet hangs: it is on the bus and said nothing for 5 s"]
    facts.heard.alive.discard("tablet")
    assert whats(judge_box(facts)) == ["tablet is missing: it is not on the bus"]


def test_a_bus_that_does_not_answer_is_its_router_and_nobody_else_is_blamed() -> None:
    running = RunningBox(Path("site.toml"), BoxProcess(7, stopped=False), {"fusion": [BoxProcess(8, stopped=False)]})
    silent = Heard("silent", "answers")
    assert whats(judge_box(box(running=running, heard=silent))) == [
        "fusion (process 8) hangs: the bus does not answer, so no other process can be heard"
    ]
    (words,) = whats(judge_box(box(running=replace(running, processes={}), heard=silent)))
    assert words.startswith("fusion is missing, and with it the bus")


def test_nobody_is_told_to_kill_a_supervisor_that_is_stopped_as_if_the_box_outlived_that() -> None:
    stopped = BoxProcess(7, stopped=True)
    camera = {"edge-a": [BoxProcess(8, stopped=True)]}
    found = judge_box(box(running=RunningBox(Path("site.toml"), stopped, camera))).findings
    remedies = {finding.where: finding.remedy for finding in found}
    assert remedies["supervisor"] == "let it go on (kill -CONT 7), or end the whole box (kill -9 7) and start it anew"
    # With its supervisor stopped, nobody starts it anew.
    assert remedies["edge-a"] == "let it go on (kill -CONT 8)"
    found = judge_box(box(running=RunningBox(Path("site.toml"), replace(stopped, stopped=False), camera))).findings
    remedies = {finding.where: finding.remedy for finding in found}
    assert remedies["edge-a"] == "let it go on (kill -CONT 8), or end it (kill -9 8) and the box starts it anew"


def test_a_busy_box_is_told_once_and_not_of_each_camera() -> None:
    slow = [health(f"edge-{n}", camera=CameraHealth(n, 30.0, 2.0, 5.0, 0, 20.0, "lightning", {})) for n in "ab"]
    (words,) = whats(judge_box(box(*slow)))
    assert words == (
        "the box is too busy: all 2 cameras fall behind, and fast movement may be missed "
        "(1.9 of 2 cores are in use, 1.2 of them by the box)"
    )
    (words,) = whats(judge_box(box(slow[0])))
    assert words == "camera 'a' falls behind: 2.0 of 5 pictures a second are looked at"


def test_of_a_busy_box_with_a_dead_camera_the_two_causes_are_told_and_nothing_else() -> None:
    cameras = [CameraConfig(name=n, kind="video", path=f"{n}.avi") for n in "abc"]
    sparse = [health(f"edge-{n}", camera=CameraHealth(n, 30.0, 5.8, 5.0, 0, 20.0, "lightning", {})) for n in "ab"]
    dead = health("edge-c", camera=CameraHealth("c", 0.0, 0.0, 5.0, 0, 0.0, "lightning", {}))
    site = msgspec.structs.replace(SITE, cameras=cameras)
    busy, silent = whats(judge_box(box(*sparse, dead, site=site)))
    assert busy.startswith("the box is too busy: all 2 cameras that work fall behind")
    assert silent == "camera 'c' is silent: it delivers no pictures"
    (alone,) = whats(judge_box(box(sparse[0])))
    assert alone == "camera 'a' is looked at only 5.8 times a second, too seldom for fast movement"


def test_a_wrong_calibration_is_told_before_what_it_may_cause() -> None:
    past = Trouble("epochs_differ", "b is not fused: its pictures are of a past epoch", "cut the films to one length")
    exchanged = Trouble("cameras_exchanged", "a and b seem to be exchanged", "exchange their plugs")
    found = judge_box(box(health("fusion", "degraded", past, exchanged))).findings
    assert (found[0].where, found[0].what) == ("calibration", exchanged.words)
    assert len(found) == 2


@pytest.mark.parametrize(
    ("camera", "words"),
    [
        (CameraHealth("a", 0.0, 0.0, 15.0, 0, 0.0, "thunder", {}), "is silent: it delivers no pictures (nothing for 4 s)"),
        (
            CameraHealth("a", 30.0, 15.0, 15.0, 0, 400.0, "thunder", {}),
            "falls behind: its pictures wait 400 ms for their turn (nothing for 4 s)",
        ),
    ],
)
def test_a_cameras_fault_is_named_with_its_own_words(camera: CameraHealth, words: str) -> None:
    silent = Trouble("camera_silent", "nothing for 4 s", "check its cable")
    assert whats(judge_box(box(health("edge-a", "degraded", silent, camera=camera)))) == [f"camera 'a' {words}"]


def test_what_is_wrong_with_a_camera_that_works_is_told_one_by_one_with_what_to_do() -> None:
    dark = Trouble("camera_dark", "camera 'a' shows black pictures; or nearly", "take the cap off")
    lost = Trouble("network_missing", "network lightning is damaged")
    found = judge_box(box(health("edge-a", "degraded", dark, lost))).findings
    assert [(each.where, each.what) for each in found] == [("camera 'a'", dark.words), ("camera 'a'", lost.words)]
    assert found[0].remedy == "take the cap off"
    assert all(each.remedy for each in found)


def test_a_camera_that_rests_is_well() -> None:
    resting = CameraHealth("a", 30.0, 0.0, 0.0, 0, 0.0, "thunder", {})
    assert whats(judge_box(box(health("edge-a", camera=resting)))) == []


def test_fusions_words_about_who_is_not_heard_are_not_repeated() -> None:
    unheard = Trouble("camera_unheard", "no word from b")
    past = Trouble("epochs_differ", "b is not fused: its pictures are of a past epoch", "cut the films to one length")
    (finding,) = judge_box(box(health("fusion", "degraded", unheard, past))).findings
    assert finding.what == "fusion says: b is not fused: its pictures are of a past epoch"
    assert finding.remedy == "cut the films to one length"


def test_a_full_disk_that_ends_a_lesson_is_one_finding_with_its_remedy_however_it_is_worded() -> None:
    ended = Trouble("not_recording", "lesson 7b ended: 12 MB are left; the least is 500", "remove lessons that are not needed")
    (finding,) = judge_box(box(health("recorder", "degraded", ended), expected=(*NAMES,))).findings
    assert finding.what == f"recorder says: {ended.words}"
    assert finding.remedy == ended.remedy


@pytest.mark.parametrize("code", ["cameras_exchanged", "cameras_disagree", "camera_moved"])
def test_fusions_judgement_of_the_calibration_is_repeated_and_no_other_is_made(code: TroubleCode) -> None:
    moved = Trouble(code, "a does not agree with the calibration", "calibrate anew")
    (finding,) = judge_box(box(health("fusion", "degraded", moved))).findings
    assert (finding.where, finding.what, finding.remedy) == ("calibration", moved.words, "calibrate anew")


@pytest.mark.parametrize("name", ["fusion", "tablet", "supervisor"])
@pytest.mark.parametrize("code", sorted(get_args(TroubleCode)))
def test_whatever_a_process_says_comes_with_words_and_something_to_do_unless_it_is_found_otherwise(
    name: str, code: TroubleCode
) -> None:
    found = judge_box(box(health(name, "degraded", Trouble(code, "it is so")))).findings
    otherwise = {"camera_unheard", "given_up", "restarting", *get_args(MachineCode)}
    assert len(found) == (code not in otherwise)
    assert all("it is so" in each.what and each.remedy for each in found)


def test_what_is_said_of_the_log_can_be_typed_and_shows_every_file_of_it() -> None:
    (finding,) = judge_box(box(restarted(1, 30))).findings
    assert "`kinebox logs --data data --process edge-a`" in finding.remedy


def test_the_clock_that_was_set_is_known_from_the_box_that_watched_it() -> None:
    stepped = msgspec.structs.replace(MACHINE, clock_step_ms=-5000.0)
    (words,) = whats(judge_box(box(health("supervisor", machine=stepped))))
    assert words == "the clock was set back by 5.0 s in the last minute"


def test_a_log_that_cannot_be_written_is_named_with_what_to_do() -> None:
    told = Trouble("log_not_kept", "nothing is kept in kinebox.log: No space left on device", "make room")
    (finding,) = judge_box(box(health("supervisor", "degraded", told))).findings
    assert (finding.level, finding.where, finding.what, finding.remedy) == ("fault", "log", told.words, "make room")


def test_few_figures_are_a_finding_only_while_somebody_is_in_view() -> None:
    for pupil, count in (("found", 1), ("searching", 0)):
        fusion = FusionHealth(12.0, 2.0, 0.9, 0, {}, pupil)  # type: ignore[arg-type]
        assert len(judge_box(box(health("fusion", fusion=fusion))).findings) == count


def late(published_ms: float, heard_ms: float, *said: Health) -> BoxFacts:
    facts = box(*said)
    facts.heard.ages.extend([Age(60.0, 100.0), *[Age(published_ms, heard_ms)] * 9])
    return facts


def idle_machine() -> Health:
    return health("supervisor", machine=msgspec.structs.replace(MACHINE, used_cores=1.0))


def test_figures_that_come_in_time_are_no_finding_and_how_old_they_are_is_told() -> None:
    judged = judge_box(late(60.0, 499.0))
    assert judged.findings == ()
    assert judged.facts[0].words.endswith("30 figures a second, 499 ms late")


@pytest.mark.parametrize("pupil", ["found", "searching"])
def test_figures_that_come_often_but_late_are_found_even_where_they_are_too_late_for_a_pupil_to_be_found(pupil: str) -> None:
    fusion = health("fusion", fusion=FusionHealth(30.0, 2.0, 0.9, 0, {}, pupil))  # type: ignore[arg-type]
    (finding,) = judge_box(late(850.0, 900.0, fusion, idle_machine())).findings
    assert finding.what == "figures come 900 ms late, too late to teach by: the pictures reach fusion late"
    assert "cables and network" in finding.remedy


def test_who_holds_late_figures_up_is_named_by_where_they_grow_old() -> None:
    (busy,) = judge_box(late(850.0, 900.0)).findings
    assert "the box is too busy (1.9 of 2 cores are in use, 1.2 of them by the box)" in busy.what
    assert "end other programs" in busy.remedy
    (waiting,) = judge_box(late(60.0, 900.0, idle_machine())).findings
    assert "they wait on the bus, 60 ms old when fusion published them" in waiting.what
    assert "`kinebox logs --data data --process fusion`" in waiting.remedy


def test_where_no_camera_works_that_is_told_and_not_that_the_last_figure_grows_older() -> None:
    dead = [health(f"edge-{n}", camera=CameraHealth(n, 0.0, 0.0, 15.0, 0, 0.0, "thunder", {})) for n in "ab"]
    assert all(words.startswith("camera ") for words in whats(judge_box(late(9000.0, 9000.0, *dead, idle_machine()))))


def test_doctor_and_page_call_the_same_figures_late_and_the_same_machine_busy() -> None:
    page = (Path(__file__).parents[2] / "services/tablet/web/src/connection/lateness.ts").read_text()
    said = {name: float(figure) for name, figure in re.findall(r"^const (\w+) = ([\d.]+);", page, re.MULTILINE)}
    assert (said["LATE_AT_SERVER_MS"], said["BUSY_SHARE"]) == (LATE_MS, BUSY_SHARE)


@pytest.mark.parametrize(
    ("changes", "where"),
    [
        ({"architecture": "riscv64"}, "processor"),
        ({"flags": frozenset()}, "processor"),
        ({"health": msgspec.structs.replace(MACHINE, granted_cores=0.5)}, "processor"),
        ({"wall": dt.datetime(2020, 1, 1, tzinfo=dt.UTC)}, "clock"),
        ({"data_problem": FolderProblem("does not exist")}, "data folder"),
    ],
)
def test_a_machine_that_will_not_do_is_found(changes: dict[str, object], where: str) -> None:
    wall = dt.datetime(2027, 1, 1, tzinfo=dt.UTC)
    good = MachineFacts(MACHINE, "a processor", "x86_64", frozenset({"avx2"}), 4, 8000.0, wall, Path("build"), None)
    assert judge_machine(good).findings == ()
    (finding,) = judge_machine(replace(good, **changes)).findings  # type: ignore[arg-type]
    assert finding.where == where


def test_a_port_that_nobody_can_be_seen_to_have_comes_with_how_to_find_out() -> None:
    (finding,) = judge_ports(Ports((Port("bus", "bus.endpoint", 7447, taken=True),))).findings
    assert "sudo ss -ltnp" in finding.remedy
    assert judge_ports(Ports((Port("bus", "bus.endpoint", 7447, taken=True, pid=5, ours=True),))).findings == ()


def test_the_remedy_is_what_an_error_for_people_ends_with() -> None:
    finding = fault_of("camera 'b'", UserError("camera 'b': b.avi; c.avi are missing; run `make footage`"), "looking")
    assert (finding.what, finding.remedy) == ("camera 'b': b.avi; c.avi are missing", "run `make footage`")
    assert fault_of("x", "it is broken", "looking").remedy == "correct it"


def test_the_worst_comes_first_and_nothing_twice() -> None:
    warning, fault = (Finding(level, "disk", level, "k", "r") for level in ("warning", "fault"))
    joined = Examined.join([Examined((warning,), (Fact("a", "b"),)), Examined((fault, warning))])
    assert joined == Examined((fault, warning), (Fact("a", "b"),))
    text = as_text(joined)
    assert text.startswith("Found: 1 fault and 1 warning, the worst first.")
    assert text.index("FAULT") < text.index("WARNING") < text.index("Looked at")
    told = json.loads(as_json(joined))
    assert not told["good"]
    assert [finding["level"] for finding in told["findings"]] == ["fault", "warning"]


def test_paths_in_the_report_are_never_cut() -> None:
    path = "/" + "x" * 200
    assert path in as_text(Examined((Finding("fault", "disk", f"the file {path} is gone", "k", "r"),)))
