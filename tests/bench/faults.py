"""Fault drills in a running box: how soon the figure is back, what the box says meanwhile, what of the recording is lost.

One box serves all runs and records them in one lesson, but for the full disk, which ends it; between two drills it may settle.
The figure is what a client of the page's socket gets. It is away when more than half of the joints have not been seen for
longer than 0.5 s (the looping footage's seams take up to 0.4 s); `recovery_s` is the longest that it was away because of the
fault, until it was back for good, 0 if it never was. `lost_s` is what the recording lacks of the time in which there was a
figure, from the drill's first to its last instant; of the full disk, to the fault. `said_s` is how soon the page's socket told
of the fault, or was cut; `never_said` counts the runs in which it did neither. `failed` counts the runs in which what must
follow did not within a minute: the others go on, and the box's log so far is kept beside the table. Of the last box's runs
stands how much its memory grew from the first round to the last, and whatever it left behind.

Chromium shows the page meanwhile, which takes much of a core (`--no-page` leaves it out): `page_away_s` is the longest time for
which it showed no live figure, `coloured_still_s` that for which its figure was in colour although no motion came.
"""

import argparse
import math
import shutil
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path

import psutil
from playwright.sync_api import sync_playwright
from rich.console import Console
from rich.table import Table

from services.bus.zenoh_bus import open_client
from services.lesson.lesson_reader import open_lesson
from tests.bench.losses import Span, lost_s
from tests.bench.report import Report
from tests.chromium import ARGUMENTS, NONE, chromium
from tests.faults.box import ISOLATED, Box, running
from tests.faults.client import Client
from tests.faults.disk import may_mount
from tests.faults.drills import DRILLS, Outcome, Stage, faults_of_site, may_set_clock
from tests.faults.page_watch import PageWatch
from tests.faults.traces import Before, left_behind
from tests.integration.waiting import until

RECOVERY_BAR_S = 3.0
LOST_BAR_S = 1.0
GROWTH_BAR_PCT = 2.0
STILL_BAR_S = 1.0
GROWTH_RUNS = 3
"""In the first round the spares are still being made, so growth is from the second on."""
NEVER_SAID = {"slow-tablet"}
"""Nothing is wrong then: that a tablet is slow is nobody's matter but its own."""
ENDS_THE_LESSON = "full-disk"
COMPLETED_WITHIN_S = 90.0
"""The recorder tries again every half a minute."""


@dataclass
class Played:
    """What came of the drills.

    Attributes:
        rounds: the outcomes of each round, without those that failed.
        failed: of each run that failed, its drill and what was waited for in vain.
        left: what the box left behind.
    """

    rounds: list[list[Outcome]] = field(default_factory=list)
    failed: list[tuple[str, str]] = field(default_factory=list)
    left: list[str] = field(default_factory=list)

    @property
    def outcomes(self) -> list[Outcome]:
        """Of all rounds."""
        return [outcome for each in self.rounds for outcome in each]

    def of(self, drill: str) -> list[Outcome]:
        """Of one drill."""
        return [outcome for outcome in self.outcomes if outcome.drill == drill]

    def failures(self, drill: str) -> int:
        """In how many runs it failed."""
        return sum(name == drill for name, _ in self.failed)

    @property
    def growth_pct(self) -> float:
        """Memory after the last round over that after the second."""
        rounds = [statistics.mean(outcome.rss_mb for outcome in each) for each in self.rounds if each]
        return 100 * (rounds[-1] / rounds[1] - 1) if len(rounds) >= GROWTH_RUNS else float("nan")


def play(names: Sequence[str], runs: int, data: Path, *, page: bool) -> Played:
    """All drills, so many times each."""
    with tempfile.TemporaryDirectory(prefix="drills-") as folder:
        before, processes = Before.look(), list[psutil.Process]()
        with running(Path(folder), data, ISOLATED + faults_of_site(), disk="full-disk" in names) as box:
            with _watched(box) if page else nullcontext() as watch:
                played = _play_in(box, names, runs, processes, Path(folder) / "lessons", data / "bench", watch)
            processes += box.descendants()
        played.left = left_behind(box, processes, before)
    return played


@contextmanager
def _watched(box: Box) -> Iterator[PageWatch]:
    path = chromium()
    if path is None:
        sys.exit(NONE)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        page = browser.new_page(viewport={"width": 800, "height": 500})
        watch = PageWatch(page)
        page.goto(box.page)
        yield watch
        browser.close()


def _play_in(
    box: Box,
    names: Sequence[str],
    runs: int,
    processes: list[psutil.Process],
    shelf: Path,
    logs: Path,
    watch: PageWatch | None,
) -> Played:
    """The drills of all runs; finished lessons are put on the shelf, so that a small disk is full only when it shall be."""
    played, watches = Played(), list[Span]()
    bus = open_client(box.endpoint, threading.Event())
    assert bus is not None
    with Client(box.port) as client:
        stage = Stage(box, client, bus)
        client.wait_figure(time.monotonic())
        stage.record("start")
        for run in range(runs):
            played.rounds.append([])
            for name in names:
                processes += box.descendants()
                began_s = time.monotonic()
                if watch:
                    watch.begin()
                try:
                    outcome = DRILLS[name](stage)
                except AssertionError as error:
                    played.failed.append((name, str(error)))
                    kept = _keep_log(box, logs / f"faults-{run + 1}-{name}.log")
                    print(f"{run + 1:3} {name:16} failed: {error}; the log until then: {kept}")
                    continue
                if watch:
                    outcome.still_s, outcome.away_s = watch.still_s, watch.away_s
                played.rounds[-1].append(outcome)
                # Without a byte nothing can be kept, nor until a new lesson is begun; what was before must be.
                watches.append((began_s, outcome.fault_s if name == ENDS_THE_LESSON else time.monotonic()))
                if name == ENDS_THE_LESSON:
                    _shelve(box, shelf)
                if not client.status()["recording"]:
                    stage.record("start")
                said = "never" if outcome.said_s is None else f"{outcome.said_s:.2f}"
                print(f"{run + 1:3} {name:16} recovery {outcome.recovery_s:5.2f} s, pause {outcome.pause_s:4.2f} s, said {said} s")
        stage.record("stop")
        with suppress(AssertionError):  # what is not completed is left behind, and counts as that
            until(lambda: not list(box.data.rglob("*.part")), "every lesson to be completed", COMPLETED_WITHIN_S)
        _shelve(box, shelf)
    bus.close()
    ticks_s = _recorded_s(shelf)
    for outcome, span in zip(played.outcomes, watches, strict=True):
        outcome.lost_s = lost_s(ticks_s, client.seen.figures_s, *span)
    return played


def _keep_log(box: Box, path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(file.read_bytes() for file in sorted((box.data / "logs").glob("*.log"))))
    return path


def _shelve(box: Box, shelf: Path) -> None:
    shelf.mkdir(exist_ok=True)
    for lesson in sorted(box.data.rglob("*.mcap")):
        taken = len(list(shelf.iterdir()))  # lessons of one minute have one name, if the first is out of the way
        shutil.move(lesson, shelf / f"{taken:04d}-{lesson.name}")


def _recorded_s(shelf: Path) -> list[float]:
    """When fusion ticked, by all lessons."""
    ticks_s: list[float] = []
    for path in sorted(shelf.iterdir()):
        with open_lesson(path) as lesson:
            ticks_s += [entry.t_ns * 1e-9 for part in lesson.parts() for entry in part.entries if entry.kind == "tick"]
    return sorted(ticks_s)


def figures(names: Sequence[str], played: Played) -> dict[str, float]:
    """By their fixed names; NaN of what no run could measure."""
    measured: dict[str, float] = {}
    for name in names:
        runs = played.of(name)
        measured |= {
            f"{name}.recovery_s.max": _worst(run.recovery_s for run in runs),
            f"{name}.pause_s.max": _worst(run.pause_s for run in runs),
            f"{name}.lost_s.max": _worst(run.lost_s for run in runs),
            f"{name}.said_s.max": _worst(run.said_s for run in runs),
            f"{name}.coloured_still_s.max": _worst(run.still_s for run in runs),
            f"{name}.page_away_s.max": _worst(run.away_s for run in runs),
            f"{name}.failed": played.failures(name),
        }
        if name not in NEVER_SAID:
            measured[f"{name}.never_said"] = sum(run.said_s is None for run in runs) if runs else float("nan")
    return measured | {"rss_growth_pct": played.growth_pct, "left_behind": len(played.left), "runs": len(played.rounds)}


def bars(names: Sequence[str], runs: int, *, page: bool) -> dict[str, tuple[str, float]]:
    """What so many runs of these drills are held against, whatever comes of them."""
    held: dict[str, tuple[str, float]] = {}
    for name in names:
        held |= {
            f"{name}.recovery_s.max": ("<=", RECOVERY_BAR_S),
            f"{name}.lost_s.max": ("<=", LOST_BAR_S),
            f"{name}.failed": ("<=", 0.0),
        }
        if page:
            held |= {f"{name}.coloured_still_s.max": ("<=", STILL_BAR_S), f"{name}.page_away_s.max": ("<=", RECOVERY_BAR_S)}
        if name not in NEVER_SAID:
            held |= {f"{name}.said_s.max": ("<=", RECOVERY_BAR_S), f"{name}.never_said": ("<=", 0.0)}
    if runs >= GROWTH_RUNS:
        held["rss_growth_pct"] = ("<=", GROWTH_BAR_PCT)
    return held | {"left_behind": ("<=", 0.0)}


def _worst(values: Iterable[float | None]) -> float:
    return max((value for value in values if value is not None), default=float("nan"))


def table(names: Sequence[str], played: Played) -> Table:
    """A row a drill."""
    columns = (
        "drill",
        "runs",
        "failed",
        "recovery median",
        "max",
        "pause max",
        "said max",
        "never said",
        "lost max",
        "page: away max",
        "page: still max",
    )
    shown = Table(title="fault drills")
    for column in columns:
        shown.add_column(column, justify="left" if column == "drill" else "right")
    measured = figures(names, played)

    def worst(name: str) -> str:
        return "" if math.isnan(measured[name]) else f"{measured[name]:.2f}"

    for name in names:
        runs = played.of(name)
        shown.add_row(
            name,
            str(len(runs) + played.failures(name)),
            str(played.failures(name)),
            f"{statistics.median(run.recovery_s for run in runs):.2f}" if runs else "",
            worst(f"{name}.recovery_s.max"),
            worst(f"{name}.pause_s.max"),
            worst(f"{name}.said_s.max"),
            str(sum(run.said_s is None for run in runs)) if runs and name not in NEVER_SAID else "",
            worst(f"{name}.lost_s.max"),
            worst(f"{name}.page_away_s.max"),
            worst(f"{name}.coloured_still_s.max"),
        )
    return shown


def main() -> int:
    """Measure, print, write; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--drills", nargs="+", choices=sorted(DRILLS), default=list(DRILLS), metavar="DRILL")
    parser.add_argument("--no-page", dest="page", action="store_false")
    arguments = parser.parse_args()
    names = [name for name in DRILLS if name in arguments.drills]
    with tempfile.TemporaryDirectory() as folder:
        for name, allowed in (("full-disk", may_mount(Path(folder))), ("clock-step", may_set_clock())):
            if name in names and not allowed:
                names.remove(name)
                print(f"{name} is left out: it needs rights that this process has not")
    played = play(names, arguments.runs, arguments.data, page=arguments.page)
    report = Report("bench-faults")
    report.add(figures(names, played))
    report.rows = [vars(outcome) for outcome in played.outcomes]
    Console(width=140).print(table(names, played))
    print("left behind: " + (", ".join(played.left) or "nothing"))
    return report.conclude(bars(names, arguments.runs, page=arguments.page), arguments.data)


if __name__ == "__main__":
    sys.exit(main())
