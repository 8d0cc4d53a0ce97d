"""Troubles of the machine; what cannot be staged without harm is put in where it is measured."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from services.doctor.finding import Examined
from services.support.machine import Sensors, Throttling
from tests.integration.doctor_troubles.trouble import SECOND_NS, Stage, Trouble, examined
from tests.integration.house import build_house


def measured(**sensors: object) -> Stage:
    """A machine that measures something else than this one."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        yield examined(build_house(folder), sensors=replace(Sensors(), **sensors))  # type: ignore[arg-type]

    return stage


MACHINE: dict[str, Trouble] = {
    "the disk is full": Trouble(
        measured(free_disk_mib=lambda _: 120.0), "disk", "the disk of the data folder is full: 126 MB", "delete old lessons"
    ),
    "the disk is nearly full": Trouble(
        measured(free_disk_mib=lambda _: 1500.0), "disk", r"is nearly full: 1\.6 GB", "delete old lessons", "warning"
    ),
    "the disk of the lessons has no room for one": Trouble(
        measured(free_disk_mib=lambda folder: 300.0 if folder.name == "lessons" else 50_000.0),
        "lessons",
        r"nothing can be recorded in .*/lessons: 315 MB are left on the disk, lessons\.least_free_mb is 500",
        "remove lessons that are not needed",
    ),
    "memory is nearly gone": Trouble(
        measured(free_memory_mib=lambda: 80.0), "memory", "memory is nearly gone: 84 MB", "end other programs"
    ),
    "the processor is too hot": Trouble(measured(temperature_c=lambda: 101.0), "processor", "too hot: 101 °C", "clean its fan"),
    "the processor is slowed down": Trouble(
        measured(throttling=lambda: Throttling(0, now=True)), "processor", "was slowed down", "power supply", "warning"
    ),
    "the clock was never set": Trouble(
        measured(clocks_ns=lambda: (3600 * SECOND_NS, SECOND_NS)), "clock", "the clock says 01 Jan 1970", "set it", "warning"
    ),
}
