"""A box that runs, to which something happens."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration import small_edge
from tests.integration.box import NAMES, Box, HealthWatch
from tests.integration.doctor_troubles.trouble import Stage, examined


def running(
    stage_it: Callable[[Box], object],
    orders: dict[str, str] | None = None,
    more: str = "",
    edge: str | None = None,
    film: Callable[[Path], None] = small_edge.write_film,
) -> Stage:
    """A box that runs, to which something happens."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        small_edge.write_film(folder / "data" / "footage" / "a.avi")
        film(folder / "data" / "footage" / "b.avi")
        with Box(folder, orders, more, *([edge] if edge else [])) as box:
            box.wait_started()
            try:
                stage_it(box)
                yield examined(box)
            finally:
                if box.process.poll() is None:
                    box.process.send_signal(signal.SIGCONT)

    return stage


class StandingBox:
    """One box for all troubles that pass; to start one for each would take most of their time."""

    def __init__(self) -> None:
        self._held = ExitStack()
        self._box: Box | None = None

    def stage(self, stage_it: Callable[[Box], object]) -> Stage:
        """Something happens to it while all is well, and its stopped processes go on afterwards."""

        @contextmanager
        def stage(folder: Path) -> Iterator[Examined]:
            box = self._box = self._box or self._held.enter_context(Box(folder))
            box.wait_started()
            all_well(box)
            try:
                stage_it(box)
                yield examined(box)
            finally:
                for pid in (pid for name in NAMES for pid in box.pids(name)):
                    with suppress(ProcessLookupError):
                        os.kill(pid, signal.SIGCONT)
                box.process.send_signal(signal.SIGCONT)

        return stage

    def end(self) -> None:
        """No trouble follows."""
        self._box = None
        self._held.close()


STANDING = StandingBox()


def wait_for(box: Box, process: str, state: str) -> None:
    with HealthWatch(box) as watch:
        watch.wait_for(process, state)


def until_told(process: str, state: str) -> Callable[[Box], None]:
    return lambda box: wait_for(box, process, state)


def all_well(box: Box) -> None:
    box.wait_page()
    with HealthWatch(box) as watch:
        for name in ("fusion", "edge-a", "edge-b", "tablet", "supervisor"):
            watch.wait_for(name, "ok")
