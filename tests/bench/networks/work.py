"""What the processes of the benchmark's pool do; such a function must stand in a module that they can import."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Final

from edge.simulation.lesson.plan import Plan
from tests.bench.networks.looks import Looked, Name, Turn, look
from tests.bench.reconstruct.rendered import rendered_lesson

PROCESSES: Final = 2


def look_at_all(
    plans: Sequence[Plan], data: Path, networks: Sequence[Name], turns: Sequence[Turn]
) -> dict[tuple[str, Name, Turn], dict[str, Looked]]:
    """By lesson, network and way of cropping."""
    wanted = [(plan, network, turn) for plan in plans for network in networks for turn in turns]
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        results = list(pool.map(_look, *zip(*wanted, strict=True), [data] * len(wanted)))
    return {(plan.name, network, turn): result for (plan, network, turn), result in zip(wanted, results, strict=True)}


def _look(plan: Plan, network: Name, turn: Turn, data: Path) -> dict[str, Looked]:
    return look(rendered_lesson(plan, data), network, turn, data)
