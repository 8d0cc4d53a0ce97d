"""Tables of results: one value for the terminal, Markdown and JSON."""

import math
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import rich.table


@dataclass(frozen=True)
class Spread:
    """A figure over the seeds.

    Attributes:
        mean: over the seeds.
        deviation: standard deviation of a seed (n - 1); NaN for a single one.
        seeds: how many there were.
    """

    mean: float
    deviation: float
    seeds: int


Cell = float | str | Spread | None


def spread(values: Sequence[float]) -> Spread | None:
    """Mean and deviation; None if there is no value or one that is not a number, which no mean may hide."""
    if not values or not all(math.isfinite(value) for value in values):
        return None
    return Spread(statistics.fmean(values), statistics.stdev(values) if len(values) > 1 else math.nan, len(values))


@dataclass(frozen=True)
class ResultTable:
    """Rows of one kind.

    Attributes:
        title: what it shows, with units.
        columns: headings; the first is of the rows' names.
        rows: name, then a cell for each other column.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"table '{self.title}' has {len(self.columns)} columns, and a row of {len(row)}: {row}")

    def for_terminal(self) -> rich.table.Table:
        """For rich's console."""
        table = rich.table.Table(title=self.title)
        for index, column in enumerate(self.columns):
            table.add_column(column, justify="right" if index else "left")
        for row in self.rows:
            table.add_row(*map(shown, row))
        return table

    def as_markdown(self) -> str:
        """A heading and a table."""
        lines = [
            " | ".join(self.columns),
            " | ".join("---" if index == 0 else "---:" for index in range(len(self.columns))),
            *(" | ".join(shown(cell).replace("|", r"\|") for cell in row) for row in self.rows),
        ]
        return "\n".join((f"### {self.title}", "", *(f"| {line} |" for line in lines), ""))

    def as_json(self) -> dict[str, Any]:
        """Plain values; what is not there is null."""
        return {"title": self.title, "columns": list(self.columns), "rows": [[_plain(cell) for cell in row] for row in self.rows]}


def table_of(title: str, first: str, rows: Mapping[str, Mapping[str, Cell]]) -> ResultTable:
    """A table of a mapping a row; columns in the order in which they first come, a row without one has an empty cell."""
    columns = tuple(dict.fromkeys(column for row in rows.values() for column in row))
    return ResultTable(
        title, (first, *columns), tuple((name, *(row.get(column) for column in columns)) for name, row in rows.items())
    )


def shown(cell: Cell) -> str:
    """A cell for people: three digits that count, mean ± deviation; what could not be measured is empty, never zero."""
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    if isinstance(cell, str):
        return cell
    if isinstance(cell, Spread):
        return f"{_number(cell.mean)} ± {_number(cell.deviation)}" if math.isfinite(cell.deviation) else _number(cell.mean)
    return _number(cell)


def _number(value: float) -> str:
    # Not 1.23e+03: whole numbers keep their digits.
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def _plain(cell: Cell) -> Any:
    if isinstance(cell, Spread):
        deviation = cell.deviation if math.isfinite(cell.deviation) else None
        return {"mean": cell.mean, "deviation": deviation, "seeds": cell.seeds}
    return None if isinstance(cell, float) and not math.isfinite(cell) else cell
