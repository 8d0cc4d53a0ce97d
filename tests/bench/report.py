"""Prints a benchmark's figures and tables and writes them to `build/bench/<target>.json` and `.md`. Names are fixed for good."""

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
from tests.bench.table import Cell, ResultTable, Spread, shown, spread

_ROOT = Path(__file__).parents[2]
_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    ">=": lambda value, bar: value >= bar,
    "<=": lambda value, bar: value <= bar,
    "within": lambda value, bar: abs(value) <= bar,
}


@dataclass
class Report:
    """Figures, rows and tables of one benchmark run. A figure that could not be measured is left out, never zero.

    Attributes:
        target: name of the benchmark.
        seeds: of what is drawn by chance.
        figures: by name; of those that are means over seeds, `deviations` has the standard deviation.
        rows: further values for programs.
        tables: further values for people, and for programs, too.
        bars: what figures are held against, as (">=", "<=" or "within", value); of all that this run was to measure.
    """

    target: str
    seeds: Sequence[int] = ()
    figures: dict[str, float] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)
    deviations: dict[str, float] = field(default_factory=dict)
    tables: list[ResultTable] = field(default_factory=list)
    bars: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    started_s: float = field(default_factory=time.monotonic)

    def add(self, figures: Mapping[str, float], prefix: str = "") -> None:
        """Take figures over, leaving out those that are not numbers."""
        self.figures |= {prefix + name: float(value) for name, value in figures.items() if math.isfinite(value)}

    def add_seeds(self, by_seed: Sequence[Mapping[str, float]], prefix: str = "") -> None:
        """Take over the means of figures that each seed has, with their deviations; one that a seed lacks is left out."""
        for name in by_seed[0] if by_seed else ():
            values = spread([figures.get(name, math.nan) for figures in by_seed])
            if values is not None:
                self.figures[prefix + name] = values.mean
                if math.isfinite(values.deviation):
                    self.deviations[prefix + name] = values.deviation

    def write(self, data: Path) -> Path:
        """Write both files; returns the path of the .json."""
        path = data / "bench" / f"{self.target}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        document = {
            "target": self.target,
            "commit": commit(),
            "machine": machine(),
            "seeds": list(self.seeds),
            "seconds": round(time.monotonic() - self.started_s, 1),
            "figures": self.figures,
            "deviations": self.deviations,
            "rows": self.rows,
            "tables": [table.as_json() for table in self.tables],
        }
        path.write_text(json.dumps(document, indent=1) + "\n")
        heading = f"## {self.target}\n\n{document['machine']}; commit {document['commit']}; {document['seconds']:.0f} s"
        seeds = f"; seeds {', '.join(map(str, self.seeds))}, mean ± deviation\n" if self.seeds else "\n"
        tables = "\n".join(table.as_markdown() for table in (self.summary(), *self.tables))
        path.with_suffix(".md").write_text(f"{heading}{seeds}\n{tables}")
        return path

    @property
    def missed(self) -> list[str]:
        """The figures that do not meet their bar; those that could not be measured do not, either."""
        return [name for name, bar in self.bars.items() if not self._meets(name, bar)]

    def summary(self) -> ResultTable:
        """All figures, each beside its bar, and the bars of those that could not be measured."""
        missed = self.missed
        rows: list[tuple[Cell, ...]] = []
        for name in [*self.figures, *(name for name in self.bars if name not in self.figures)]:
            value, bar = self.figures.get(name), self.bars.get(name)
            cell = None if value is None else Spread(value, self.deviations.get(name, math.nan), len(self.seeds))
            met = "" if bar is None else "missed" if name in missed else "met"
            rows.append((name, cell, "" if bar is None else f"{bar[0]} {bar[1]:g}", met))
        return ResultTable("figures", ("figure", "value", "bar", "met"), tuple(rows))

    def _meets(self, name: str, bar: tuple[str, float]) -> bool:
        value, (sign, limit) = self.figures.get(name), bar
        return value is not None and _COMPARISONS[sign](value, limit)

    def conclude(self, bars: Mapping[str, tuple[str, float]], data: Path) -> int:
        """Show and write everything and name what was missed; returns the exit code of the benchmark, 1 if a bar was missed."""
        self.show(bars)
        print(f"written to {self.write(data)}")
        if self.missed:
            print(f"missed: {', '.join(self.missed)}")
        return 1 if self.missed else 0

    def show(self, bars: Mapping[str, tuple[str, float]]) -> None:
        """Print the figures, those in `bars` as met or missed, and the tables."""
        self.bars = bars
        console = Console(width=max(110, Console().width))
        table = Table(title=f"{self.target} on {machine()}")
        for column in ("figure", "value", "bar", ""):
            table.add_column(column, justify="right" if column == "value" else "left")
        for name, value, bar, met in self.summary().rows:
            table.add_row(shown(name), shown(value), shown(bar), "[bold]missed[/bold]" if met == "missed" else shown(met))
        for each in (table, *(result.for_terminal() for result in self.tables)):
            console.print(each)


def machine() -> str:
    """Processor, cores in use and system, in one line."""
    name = processor().name or platform.machine()
    cores = len(psutil.Process().cpu_affinity() or [])
    return f"{name}, {cores} cores, Python {platform.python_version()}"


def commit() -> str:
    """Of the checkout, with `-dirty` if it was changed since; empty outside of one."""
    command = ["git", "describe", "--always", "--dirty", "--exclude=*"]
    return subprocess.run(command, cwd=_ROOT, capture_output=True, text=True, check=False).stdout.strip()
