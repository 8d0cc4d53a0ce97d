"""What a trouble is, and how the doctor is asked about a house or a box."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from edge.inspect import inspect
from services.doctor.examine import Order, examine
from services.doctor.finding import Examined
from services.doctor.installation import Installation, gather_installation
from services.evaluation.inspect import inspect as inspect_taught
from tests.installed import DATA
from tests.integration.box import Box
from tests.integration.house import House, build_house

Stage = Callable[[Path], AbstractContextManager[Examined]]
SECOND_NS = 1_000_000_000


@dataclass(frozen=True)
class Trouble:
    """A trouble, and patterns that one finding must match: the part at fault, what is wrong, and what to do."""

    stage: Stage
    where: str
    what: str
    remedy: str
    level: str = "fault"


@lru_cache(maxsize=1)
def installation_here() -> Installation:
    """This machine's, gathered once; its kernels and page are what some troubles are about, and good for the others."""
    found = gather_installation(DATA)
    return replace(found, kernels=found.kernels or 0, kernels_lacking=(), kernels_problem="", page_lacks=())


def examined(house: House | Box, **changes: object) -> Examined:
    """What the doctor finds in a house or of a running box."""
    order = Order(house.site, house.data, (inspect, inspect_taught), installation=lambda _: installation_here())
    return examine(replace(order, **changes))  # type: ignore[arg-type]


def broken(break_it: Callable[[House], object]) -> Stage:
    """A house in which one thing is broken."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        house = build_house(folder)
        break_it(house)
        yield examined(house)

    return stage


def flip_byte(file: Path) -> None:
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def fault(camera: str, kind: str) -> str:
    return f'[[faults]]\ncamera = "{camera}"\nkind = "{kind}"\nat_s = 0.0\nfor_s = 10000.0\n'
