"""A running box: which process is missing, hangs or was given up, which camera is silent or behind, and what else is off.

Pure: everything was gathered before.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from models.config.site import Site
from models.messages.health import Health, MachineHealth, Restarts, SupervisorHealth
from models.messages.trouble import CALIBRATION_CODES, MACHINE_CODES, Trouble, TroubleCode
from models.process import EDGE, ROUTER, process_name
from services.doctor.cameras import does_work, is_held_up, judge_camera
from services.doctor.finding import Examined, Fact, Finding, Level
from services.doctor.lateness import LESS_TO_DO, judge_lateness, typical_ms
from services.doctor.listen import Heard
from services.doctor.machine import DISK, machine_finding
from services.doctor.processes import RunningBox
from services.support.machine_troubles import machine_troubles
from services.support.no_room import WORDS as NO_ROOM

OFTEN = 3
RECENT_NS = 600 * 1_000_000_000
SLOW_SHARE = 0.8
"""Below this share of the figures wished for, movement is not smooth."""
BUSY_SHARE = 0.9
"""A machine of which more is in use lets everything wait; so for the page (`lateness.ts`)."""
SUPERVISOR = "supervisor"
_LISTENED = "listening to the bus"
_SUPERVISORS_WORD = "the supervisor's word"
_FOUND_OTHERWISE: frozenset[TroubleCode] = frozenset({"camera_unheard", "given_up", "restarting", *MACHINE_CODES})
"""What processes say of one another, and of the machine, is in what was found before."""
_PLACES: dict[TroubleCode, str] = {"log_not_kept": "log", **dict.fromkeys(CALIBRATION_CODES, "calibration")}
"""Who says the other troubles is their place."""
_LEVELS: dict[TroubleCode, Level] = {"log_not_kept": "fault"}
"""The other troubles are warnings."""


@dataclass(frozen=True)
class BoxFacts:
    """What was gathered of a running box.

    Attributes:
        site: the site file.
        data: the data folder, with its log.
        running: its processes, as the machine has them.
        expected: the names of all processes that a box of this site has, the supervisor too.
        heard: what it said.
        version: of the KineBox that the doctor belongs to.
        now_ns: CLOCK_MONOTONIC.
    """

    site: Site
    data: Path
    running: RunningBox
    expected: tuple[str, ...]
    heard: Heard
    version: str
    now_ns: int


def judge_box(box: BoxFacts) -> Examined:
    """Everything wrong with it, and how it runs."""
    if box.heard.bus == "silent":
        return Examined((*_stopped(box), *_router(box), *_page(box)), _facts(box))
    stopped = _stopped(box)
    findings = [
        *stopped,
        *(finding for finding in _processes(box) if finding.where not in {each.where for each in stopped}),
        *_restarts(box),
        *_page(box),
        *_cameras(box),
        *_own_words(box),
        *_figures(box),
        *_lateness(box),
        *_unreadable(box),
        *_machine(box),
        *_version(box),
    ]
    return Examined(tuple(findings), _facts(box))


def _stopped(box: BoxFacts) -> list[Finding]:
    table = dict(box.running.processes)
    if box.running.supervisor is not None:
        table[SUPERVISOR] = [box.running.supervisor]
    leaderless = any(process.stopped for process in table.get(SUPERVISOR, ()))
    findings = []
    for name, processes in table.items():
        for process in processes:
            if process.stopped:
                words = f"{name} (process {process.pid}) is stopped and does nothing, by SIGSTOP or a debugger"
                remedy = f"let it go on (kill -CONT {process.pid})"
                if name == SUPERVISOR:
                    remedy += f", or end the whole box (kill -9 {process.pid}) and start it anew"
                elif not leaderless:
                    remedy += f", or end it (kill -9 {process.pid}) and the box starts it anew"
                findings.append(Finding("fault", name, words, "the machine's table of processes", remedy))
    return findings


def _router(box: BoxFacts) -> Iterator[Finding]:
    """The bus does not answer: nobody else can be heard, so nobody else can be judged."""
    here = box.running.processes.get(ROUTER)
    if here is None:
        words = f"{ROUTER} is missing, and with it the bus: no figure is made and no process can be heard"
        remedy = f"read why (`{_log_of(SUPERVISOR, box)}`), mend that, and start the box anew"
        yield Finding("fault", ROUTER, words, "the machine's table of processes", remedy)
    elif not any(process.stopped for process in here):
        words = f"{ROUTER} (process {here[0].pid}) hangs: the bus does not answer, so no other process can be heard"
        remedy = f"wait some seconds: the box restarts it; if it stays so, end it (kill -9 {here[0].pid})"
        yield Finding("fault", ROUTER, words, "asking the bus, which said nothing", remedy)


def _processes(box: BoxFacts) -> Iterator[Finding]:
    given_up = {each.process for each in _told(box) if each.given_up}
    for name in box.expected:
        if name in given_up:
            continue
        if name not in box.heard.alive:
            words = f"{name} is missing: it is not on the bus"
            remedy = f"wait some seconds, it may be starting; if it stays so, read `{_log_of(name, box)}` and start the box anew"
            yield Finding("fault", name, words, _LISTENED, remedy)
        elif name not in box.heard.healths:
            words = f"{name} hangs: it is on the bus and said nothing for {box.heard.seconds:.0f} s"
            remedy = f"wait some seconds: the box restarts it; if it stays so, read `{_log_of(name, box)}` and start the box anew"
            yield Finding("fault", name, words, _LISTENED, remedy)


def _supervisor(box: BoxFacts) -> SupervisorHealth | None:
    health = box.heard.healths.get(SUPERVISOR)
    return health.supervisor if health is not None else None


def _told(box: BoxFacts) -> tuple[Restarts, ...]:
    supervisor = _supervisor(box)
    return supervisor.restarts if supervisor is not None else ()


def _restarts(box: BoxFacts) -> Iterator[Finding]:
    for each in _told(box):
        ago_s = max(box.now_ns - each.last_ns, 0) * 1e-9
        if each.given_up:
            words = f"{each.process} is given up and does not run any more: {each.given_up}"
            remedy = f"read what it said last (`{_log_of(each.process, box)}`), mend that, and start the box anew"
            yield Finding("fault", each.process, words, _SUPERVISORS_WORD, remedy)
        elif each.count >= OFTEN or ago_s * 1e9 < RECENT_NS:
            times = "once" if each.count == 1 else f"{each.count} times"
            words = f"{each.process} was started again {times}; {_ago(ago_s)} ago it {each.reason}"
            remedy = f"once is no harm; if it happens again, read what it said before (`{_log_of(each.process, box)}`)"
            yield Finding("warning", each.process, words, "the supervisor's count", remedy)


def _page(box: BoxFacts) -> list[Finding]:
    if box.heard.page == "answers":
        return []
    words = f"the page at port {box.site.tablet.port} does not answer"
    remedy = f"wait some seconds; if it stays so, read `{_log_of('tablet', box)}`"
    return [Finding("fault", "tablet", words, "asking it over HTTP", remedy)]


def _cameras(box: BoxFacts) -> Iterator[Finding]:
    heard = _heard_cameras(box)
    working = [name for name, health in heard if does_work(name, health, box.now_ns)]
    held_up = [name for name, health in heard if is_held_up(name, health, box.now_ns)]
    busy = len(held_up) > 1 and held_up == working
    if busy:
        yield _busy(box, len(held_up))
    for name, health in heard:
        if not busy or name not in held_up:
            yield from judge_camera(name, health, box.now_ns)


def _heard_cameras(box: BoxFacts) -> list[tuple[str, Health]]:
    """The cameras whose processes speak; of one that failed the supervisor tells why."""
    cameras = [(camera.name, box.heard.healths.get(process_name(EDGE, camera.name))) for camera in box.site.cameras]
    return [(name, health) for name, health in cameras if health is not None and health.state != "failed"]


def _load(box: BoxFacts) -> str:
    """In brackets; empty if it is not known."""
    machine = _machine_of(box)
    if machine is None:
        return ""
    own = sum(health.cpu_cores for health in box.heard.healths.values())
    return f" ({machine.used_cores:.1f} of {machine.granted_cores:g} cores are in use, {own:.1f} of them by the box)"


def _busy(box: BoxFacts, cameras: int) -> Finding:
    """Once, in the place of the same words about every camera that works."""
    which = f"all {cameras} cameras" + ("" if cameras == len(box.site.cameras) else " that work")
    words = f"the box is too busy: {which} fall behind, and fast movement may be missed{_load(box)}"
    return Finding("warning", "processor", words, "what the cameras' processes measured in the last second", LESS_TO_DO)


def _own_words(box: BoxFacts) -> Iterator[Finding]:
    """What processes say of themselves; the cameras' words are in what was found before."""
    for name, health in box.heard.healths.items():
        if name.startswith(f"{EDGE}-"):
            continue
        # A wrong calibration is what may cause the others.
        for trouble in sorted(health.troubles, key=lambda trouble: trouble.code not in CALIBRATION_CODES):
            if trouble.code not in _FOUND_OTHERWISE:
                yield _own_word(name, trouble, box)


def _own_word(name: str, trouble: Trouble, box: BoxFacts) -> Finding:
    place = _PLACES.get(trouble.code)
    words = f"{name} says: {trouble.words}" if place is None else trouble.words
    remedy = trouble.remedy or f"wait; if it stays so, read `{_log_of(name, box)}`"
    # The log lies in the data folder: why it is not kept there is told of its disk.
    cause = DISK if trouble.code == "log_not_kept" and trouble.words.endswith(tuple(NO_ROOM)) else ""
    return Finding(_LEVELS.get(trouble.code, "warning"), place or name, words, f"{name}'s word on the bus", remedy, cause)


def _log_of(process: str, box: BoxFacts) -> str:
    """The command that shows what a process said, in all files of the log."""
    return f"kinebox logs --data {box.data} --process {process}"


def _figures(box: BoxFacts) -> Iterator[Finding]:
    fusion = box.heard.healths.get(ROUTER)
    if fusion is None or fusion.fusion is None:
        return
    told = fusion.fusion
    if told.pupil == "found" and told.live_hz < SLOW_SHARE * box.site.fusion.live_hz:
        words = f"only {told.live_hz:.0f} figures a second are made, of {box.site.fusion.live_hz:.0f} that the site file asks for"
        remedy = "end other programs on this machine, or lower inference.cpu_target in the site file"
        yield Finding("warning", ROUTER, words, "fusion's count", remedy)


def _lateness(box: BoxFacts) -> Iterator[Finding]:
    if not any(does_work(name, health, box.now_ns) for name, health in _heard_cameras(box)):
        return  # Without pictures the last figure only grows older, and why there are none is told.
    machine = _machine_of(box)
    busy = machine is not None and machine.used_cores >= BUSY_SHARE * machine.granted_cores
    yield from judge_lateness(box.heard.ages, _load(box) if busy else "", _log_of(ROUTER, box))


def _unreadable(box: BoxFacts) -> Iterator[Finding]:
    for topic, count in box.heard.unreadable.items():
        words = f"{count} messages on {topic} could not be read"
        remedy = "look for a process of another version or a program that writes there; end it"
        yield Finding("warning", "bus", words, _LISTENED, remedy)


def _machine(box: BoxFacts) -> Iterator[Finding]:
    machine = _machine_of(box)
    for trouble in machine_troubles(machine) if machine is not None else ():
        yield machine_finding(trouble, box.data)


def _machine_of(box: BoxFacts) -> MachineHealth | None:
    supervisor = box.heard.healths.get(SUPERVISOR)
    return supervisor.machine if supervisor is not None else None


def _version(box: BoxFacts) -> Iterator[Finding]:
    supervisor = _supervisor(box)
    if supervisor is None or supervisor.version == box.version:
        return
    words = f"the box that runs is KineBox {supervisor.version}, but this command is {box.version}"
    yield Finding("warning", "version", words, _SUPERVISORS_WORD, "end the box and start it anew with this version")


def _facts(box: BoxFacts) -> tuple[Fact, ...]:
    supervisor = _supervisor(box)
    if supervisor is None:
        return (Fact("running box", f"{len(box.running.processes)} processes of it are there"),)
    given_up = {each.process for each in _told(box) if each.given_up}
    speaking = len(box.heard.healths.keys() & set(box.expected) - given_up)  # For those the supervisor speaks.
    up = _ago(max(box.now_ns - supervisor.started_ns, 0) * 1e-9)
    rate = f"{box.heard.live / box.heard.seconds:.0f} figures a second" if box.heard.seconds else "not listened to"
    late = f", {typical_ms(box.heard.ages):.0f} ms late" if box.heard.ages else ""
    words = f"version {supervisor.version}, up for {up}, {speaking} of {len(box.expected)} processes speak, {rate}{late}"
    return (Fact("running box", words),)


def _ago(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h"
