"""Troubles of the clock and the bus under a box that runs."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import msgspec

from models.messages import codec
from services.doctor.finding import Examined
from services.support.machine import Sensors
from tests.integration import doctor_room
from tests.integration.doctor_troubles.trouble import SECOND_NS, Trouble


@contextmanager
def clock_set_while_running(folder: Path) -> Iterator[Examined]:
    offset_ns = [1_900_000_000 * SECOND_NS]
    sensors = replace(Sensors(), clocks_ns=lambda: (offset_ns[0] + time.monotonic_ns(), time.monotonic_ns()))
    with doctor_room.room(folder) as room:
        measure = room.measured(sensors)
        room.voices["supervisor"] = lambda: room.supervisor(measure())
        measure()
        offset_ns[0] += 90 * SECOND_NS
        yield room.judged()


@contextmanager
def messages_that_nobody_can_read(folder: Path) -> Iterator[Examined]:
    with doctor_room.room(folder) as room:
        room.voices["stranger"] = lambda: codec.encode(room.health("stranger"))[:-3]
        yield room.judged()


@contextmanager
def pictures_that_reach_fusion_late(folder: Path) -> Iterator[Examined]:
    with doctor_room.filmed(folder, age_ms=900) as room:
        measure = room.measured(Sensors())
        # However busy the machine of the tests is.
        room.voices["supervisor"] = lambda: room.supervisor(msgspec.structs.replace(measure(), used_cores=0.1))
        yield room.judged()


ROOM: dict[str, Trouble] = {
    "the clock was set": Trouble(
        clock_set_while_running, "clock", r"the clock was set forwards by 90\.0 s", "let a time service keep the clock", "warning"
    ),
    "figures come late": Trouble(
        pictures_that_reach_fusion_late,
        "fusion",
        r"figures come (9\d\d|\d{4}) ms late, too late to teach by: the pictures reach fusion late",
        "check the cameras' cables and network",
        "warning",
    ),
    "somebody sends what nobody can read": Trouble(
        messages_that_nobody_can_read, "bus", r"\d+ messages on gym/health/stranger could not be read", "another version", "warning"
    ),
}
