"""Troubles of the cameras of a box that runs."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration import doctor_room, small_edge
from tests.integration.box import Box, HealthWatch
from tests.integration.doctor_troubles.running_box import running, until_told
from tests.integration.doctor_troubles.trouble import SECOND_NS, Trouble, fault

_EDGE = "tests.integration.small_edge:main"


def _slow_for_a_while(box: Box) -> None:
    with HealthWatch(box) as watch:
        first = watch.wait_for("edge-b", "ok")
        watch.wait_for("edge-b", "ok", after_ns=first.t_ns + 2 * SECOND_NS)


@contextmanager
def camera_moved(folder: Path) -> Iterator[Examined]:
    with doctor_room.filmed(folder, calibration=doctor_room.turned("cam1", 4.0)) as room:
        room.wait_until_said("fusion", "camera_moved")
        yield room.judged()


@contextmanager
def camera_of_another_loop(folder: Path) -> Iterator[Examined]:
    with doctor_room.filmed(folder, late="cam2") as room:
        room.wait_until_said("fusion", "epochs_differ")
        yield room.judged()


CAMERAS: dict[str, Trouble] = {
    "a camera is silent": Trouble(
        running(until_told("edge-b", "degraded"), more=fault("b", "stall"), edge=_EDGE),
        "camera 'b'",
        "camera 'b' is silent: it delivers no pictures",
        "check its cable",
    ),
    "a camera is gone": Trouble(
        running(until_told("edge-b", "degraded"), more=fault("b", "end"), edge=_EDGE),
        "camera 'b'",
        "camera 'b' has ended; it is opened again",
        "check its cable",
    ),
    "a camera repeats its picture": Trouble(
        running(until_told("edge-b", "degraded"), more=fault("b", "repeat"), edge=_EDGE),
        "camera 'b'",
        "camera 'b': it shows the same picture again",
        "unplug it and plug it in again",
    ),
    "a camera's clock is wrong": Trouble(
        running(until_told("edge-b", "degraded"), more=fault("b", "jump"), edge=_EDGE),
        "camera 'b'",
        "camera 'b': its clock is 5.0 s ahead",
        "unplug it and plug it in again",
    ),
    "a camera's lens is covered": Trouble(
        running(until_told("edge-b", "degraded"), edge=_EDGE, film=small_edge.write_black_film),
        "camera 'b'",
        "camera 'b' .*shows black pictures",
        "take the cap off its lens",
        "warning",
    ),
    "a camera falls behind": Trouble(
        running(_slow_for_a_while, {"edge-b": "slow"}, edge=_EDGE),
        "camera 'b'",
        "camera 'b' falls behind: ",
        "end other programs",
        "warning",
    ),
    "a camera was moved": Trouble(
        camera_moved,
        "calibration",
        "cam1 does not agree with the calibration",
        "move back what was moved, calibrate anew",
        "warning",
    ),
    "a camera shows another loop of its film": Trouble(
        camera_of_another_loop,
        "fusion",
        "cam2 is not fused: its pictures are of a past epoch",
        "count their films' loops differently",
        "warning",
    ),
}
