"""What the processes of the benchmark's pool do; such a function must stand in a module that they can import."""

from pathlib import Path

from edge.simulation.lesson.plan import Plan
from tests.bench.reconstruct.lesson import UPRIGHT
from tests.bench.reconstruct.measure import Measured, Way, measure
from tests.bench.reconstruct.rendered import rendered_lesson


def measure_plan(plan: Plan, way: Way, data: Path, fresh: bool) -> Measured:
    """One rendered lesson looked at in one way."""
    return measure(rendered_lesson(plan, data), way, UPRIGHT, data, fresh=fresh)
