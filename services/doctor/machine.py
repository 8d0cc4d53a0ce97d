"""The machine: its processor, memory, disk and clock, and whether the data folder can be used."""

import datetime as dt
import os
import platform
from dataclasses import dataclass
from pathlib import Path

import psutil

from models.messages.health import MachineHealth
from models.messages.trouble import Trouble, TroubleCode
from services.doctor.finding import Examined, Fact, Finding, Level
from services.doctor.folders import KNOWN_BY, FolderProblem, try_folder
from services.support.amount import size_of
from services.support.machine import MachineMeter, Sensors
from services.support.machine_troubles import machine_troubles
from services.support.processor import processor

_LEVEL: dict[TroubleCode, Level] = {"disk_full": "fault", "memory_low": "fault", "hot": "fault"}
"""The other troubles are warnings."""
_PLACE: dict[TroubleCode, str] = {"disk_full": "disk", "disk_low": "disk", "memory_low": "memory", "clock_set": "clock"}
_KNOWN_BY: dict[TroubleCode, str] = {
    "memory_low": "the kernel's and the control group's count of free memory",
    "hot": "the processor's own sensor",
    "throttled": "the processor's counters of throttling",
    "clock_set": "comparing the wall clock with CLOCK_MONOTONIC",
}
DISK = "disk"
"""The cause of all that comes from a data folder's disk without room."""
EARLIEST = dt.datetime(2026, 11, 1, tzinfo=dt.UTC)
"""No KineBox is older; a clock before this was never set, as on a box without a battery for it."""
FEW_CORES = 1.9
ARCHITECTURES = ("x86_64", "aarch64")
_VECTOR_FLAGS = {"x86_64": "avx2", "aarch64": "asimddp"}
"""Without it the networks run several times slower."""


@dataclass(frozen=True)
class MachineFacts:
    """What was gathered.

    Attributes:
        processor, architecture, flags: its name, as `uname -m` has it, and what it can do.
        cores: that are there, whether the box may use them or not.
        memory_mib: in all.
        wall: the machine's date and time.
        data: the data folder.
        data_problem: why nothing can be read from or written to the data folder; None if both can.
    """

    health: MachineHealth
    processor: str
    architecture: str
    flags: frozenset[str]
    cores: int
    memory_mib: float
    wall: dt.datetime
    data: Path
    data_problem: FolderProblem | None


def gather_machine(data: Path, sensors: Sensors) -> MachineFacts:
    """Look at this machine."""
    wall_ns, _ = sensors.clocks_ns()
    found = processor()
    return MachineFacts(
        health=MachineMeter(data, sensors)(),
        processor=found.name or "unknown processor",
        architecture=platform.machine(),
        flags=frozenset(found.features),
        cores=os.cpu_count() or 1,
        memory_mib=psutil.virtual_memory().total / 2**20,
        wall=dt.datetime.fromtimestamp(wall_ns * 1e-9, dt.UTC),
        data=data,
        data_problem=try_folder(data),
    )


def judge_machine(machine: MachineFacts) -> Examined:
    """What is wrong with it, and what it is."""
    findings = [machine_finding(trouble, machine.data) for trouble in machine_troubles(machine.health)]
    findings += [finding for finding in (_architecture(machine), _cores(machine), _clock(machine), _folder(machine)) if finding]
    health = machine.health
    heat = "" if health.temperature_c is None else f", {health.temperature_c:.0f} °C"
    facts = (
        Fact("processor", f"{machine.processor}, {machine.cores} cores, of which the box may use {health.granted_cores:g}{heat}"),
        Fact("memory", f"{size_of(machine.memory_mib)}, {size_of(health.memory_free_mib)} free"),
        Fact("disk", f"{size_of(health.disk_free_mib)} free at {machine.data}"),
        Fact("clock", f"{machine.wall:%d %b %Y, %H:%M:%S} UTC"),
    )
    return Examined(tuple(findings), facts)


def machine_finding(trouble: Trouble, data: Path) -> Finding:
    """The finding for a trouble of a machine with that data folder; the doctor and the box that runs tell it in unequal figures."""
    level, place = _LEVEL.get(trouble.code, "warning"), _PLACE.get(trouble.code, "processor")
    if place == "disk":
        return Finding(level, place, trouble.words, f"the file system of {data}", trouble.remedy, cause=DISK)
    return Finding(level, place, trouble.words, _KNOWN_BY[trouble.code], trouble.remedy, cause=trouble.code)


def _architecture(machine: MachineFacts) -> Finding | None:
    if machine.architecture not in ARCHITECTURES:
        words = f"KineBox does not run on {machine.architecture}"
        return Finding("fault", "processor", words, "uname -m", f"use a machine with {' or '.join(ARCHITECTURES)}")
    flag = _VECTOR_FLAGS[machine.architecture]
    if flag not in machine.flags:
        words = f"the processor has no {flag.upper()}, without which the networks run several times slower"
        return Finding("warning", "processor", words, "/proc/cpuinfo", "use a newer processor, or fewer cameras")
    return None


def _cores(machine: MachineFacts) -> Finding | None:
    granted = machine.health.granted_cores
    if granted >= FEW_CORES:
        return None
    words = f"the box may use only {granted:g} of {machine.cores} cores; the cameras will be looked at a few times a second"
    known_by = "this process's affinity and the quota of its control group"
    return Finding("warning", "processor", words, known_by, "give the box more cores, or use fewer cameras")


def _clock(machine: MachineFacts) -> Finding | None:
    if machine.wall >= EARLIEST:
        return None
    words = f"the clock says {machine.wall:%d %b %Y}, which is before this KineBox was made; lessons get a wrong date"
    return Finding(
        "warning",
        "clock",
        words,
        "the system's clock",
        "set it (sudo timedatectl set-time ...) or connect the box to a time server",
    )


def _folder(machine: MachineFacts) -> Finding | None:
    problem = machine.data_problem
    if problem is None:
        return None
    words = f"{machine.data} {problem.words}"
    if problem.full:
        # Told only where the disk's free bytes do not tell it.
        remedy = "delete old lessons or other files on its disk: it has too many files, or this user may have no more on it"
        return Finding("fault", "data folder", words, KNOWN_BY, remedy, cause=DISK)
    remedy = "correct --data, or the folder's owner and rights, or mend its disk"
    return Finding("fault", "data folder", words, KNOWN_BY, remedy)
