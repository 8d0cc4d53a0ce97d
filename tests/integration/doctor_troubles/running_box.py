"""A box that runs, to which something happens."""

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration import small_edge
from tests.integration.box import Box, HealthWatch
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
