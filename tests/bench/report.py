"""Writes a benchmark's figures to `build/bench/<target>.json` and prints its table. Figures' names are fixed for good."""

import json
import math
import platform
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import psutil
from rich.console import Console
from rich.table import Table

from services.support.processor import processor

_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    ">=": lambda value, bar: value >= bar,
    "<=": lambda value, bar: value <= bar,
    "within": lambda value, bar: abs(value) <= bar,
}


@dataclass
class Report:
    """Figures and rows of one benchmark run. A figure that could not be measured is left out, never zero."""

    target: str
    seeds: Sequence[int] = ()
    figures: dict[str, float] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)
    started_s: float = field(default_factory=time.monotonic)

    def add(self, figures: Mapping[str, float], prefix: str = "") -> None:
        """Take figures over, leaving out those that are not numbers."""
        self.figures |= {prefix + name: float(value) for name, value in figures.items() if math.isfinite(value)}

    def write(self, data: Path) -> Path:
        """Write the file and return its path."""
        path = data / "bench" / f"{self.target}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        document = {
            "target": self.target,
            "commit": _commit(),
            "machine": machine(),
            "seeds": list(self.seeds),
            "seconds": round(time.monotonic() - self.started_s, 1),
            "figures": self.figures,
            "rows": self.rows,
        }
        path.write_text(json.dumps(document, indent=1) + "\n")
        return path

    def show(self, bars: Mapping[str, tuple[str, float]]) -> None:
        """Print the figures; `bars` gives for some of them a bar as (">=", "<=" or "within", value), printed as met or missed."""
        table = Table(title=f"{self.target} on {machine()}")
        for column in ("figure", "value", "bar", ""):
            table.add_column(column, justify="right" if column == "value" else "left")
        for name, value in self.figures.items():
            bar = bars.get(name)
            if bar is None:
                table.add_row(name, f"{value:.4g}", "", "")
                continue
            met = _COMPARISONS[bar[0]](value, bar[1])
            table.add_row(name, f"{value:.4g}", f"{bar[0]} {bar[1]:g}", "met" if met else "[bold]missed[/bold]")
        Console(width=110).print(table)


def machine() -> str:
    """Processor, cores in use and system, in one line."""
    name = processor().name or platform.machine()
    cores = len(psutil.Process().cpu_affinity() or [])
    return f"{name}, {cores} cores, Python {platform.python_version()}"


def _commit() -> str:
    result = subprocess.run(["git", "describe", "--always", "--dirty", "--exclude=*"], capture_output=True, text=True, check=False)
    return result.stdout.strip()
