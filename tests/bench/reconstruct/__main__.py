"""Rendered lessons through the whole box, held against their truth: `make bench-reconstruct`.

Five test pupils, each in a gym and before a rig of his own, perform the six actions; the real networks look at every camera 15
times a second, in turns, and fusion makes joints of it as it does in a school. The error is the mean distance of all 17 COCO
points from the body's true ones, in the world, without any alignment, hidden ones included, over the time from an attempt's
beginning to its end; the smooth output, unless `.live` stands in the name. Figures without an action's name are over the five
upright ones.

`.every_frame`: 30 looks a second. `.cams3`, `.cams2`: the rig's first three or two cameras. `.freerun`: shutters that are not
synchronised. `.corrected`: the landmark bias taken off (see `services.fusion.landmarks`), which was measured on other pupils.
`jitter_reduction_pct`, `crb_mm` and the peers' margins are of every frame, where a frame of all cameras exists;
`margin_pct.<peer>.live_rate` (`--full`): the live rate, each camera's track interpolated for the peers to the output's instants.
`crb_ratio` is the mean error over the Cramer-Rao bound of one frame at the measured noise, without prior: see `metrics.bound`.

By default `.cams3`, `.cams2` and `.freerun` are of two lessons; `mpjpe_change_pct.cams3` and so on compare them with the live
rate on the very same ones. The peers are asked in their own defaults and in the settings that did best elsewhere, without RANSAC:
chosen to take ten minutes on two cores once the pictures are rendered. `--full` takes five lessons for all, every setting, and
other rigs beside.

`make bench-reconstruct DATASET=h36m|panoptic|shelf PATH=folder` measures on films that the user holds instead, on all joints that
they have a truth for: `tests.bench.datasets` says what is wanted in the folder.
"""

import argparse
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Final, Literal

import numpy as np

from edge.simulation.lesson.plan import Plan
from edge.simulation.lesson.presets import SIX_ACTIONS, acceptance
from models.errors import UserError
from services.fusion.landmark_bias import THUNDER
from tests.bench.datasets import h36m, panoptic
from tests.bench.metrics.position import margin_pct
from tests.bench.reconstruct import on_shelf
from tests.bench.reconstruct.against_peers import Standing, margin_figures, stand, table_rows
from tests.bench.reconstruct.lesson import UPRIGHT, Lesson
from tests.bench.reconstruct.measure import Measured, Way, measure
from tests.bench.reconstruct.observed import CONFIG, LIVE_HZ, RATE_HZ
from tests.bench.reconstruct.rendered import render_all
from tests.bench.reconstruct.results import by_action_table, by_pupil_table, change_pct, dataset_figures, figures_of, lost, rows_of
from tests.bench.reconstruct.work import measure_plan
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.bench.table import Cell, spread, table_of

LIVE: Final = Way("live_rate", LIVE_HZ)
EVERY_FRAME: Final = Way("every_frame", RATE_HZ)
CORRECTED: Final = Way("corrected", LIVE_HZ, config=replace(CONFIG, landmark_bias=np.array(THUNDER)))
"""The same keypoints."""
OTHER_RIGS: Final = ("row", "three", "two", "long_room", "h36m_s9")
DATASETS: Final[Mapping[str, Callable[[Path, float], list[Lesson]]]] = {"h36m": h36m.load, "panoptic": panoptic.load}
DATASET_SECONDS: Final = 20.0
PROCESSES: Final = 2


@dataclass(frozen=True)
class Part:
    """One way of looking at some lessons.

    Attributes:
        way: the way.
        seeds: of the lessons.
        rig, phases: of the lessons, as `edge.simulation.lesson.presets.acceptance`.
    """

    way: Way
    seeds: tuple[int, ...]
    rig: str = "corners"
    phases: Literal["synced", "free_running"] = "synced"

    @property
    def plans(self) -> list[Plan]:
        """Of its lessons."""
        return [acceptance(seed, "test", self.rig, self.phases) for seed in self.seeds]


def parts(seeds: tuple[int, ...], *, full: bool) -> list[Part]:
    """What is measured, on the lessons of these seeds or of the first of them."""
    few = seeds if full else seeds[:2]
    found = [
        Part(LIVE, seeds),
        Part(EVERY_FRAME, seeds),
        Part(Way("cams3", LIVE_HZ, 3), few),
        Part(Way("cams2", LIVE_HZ, 2), few),
        Part(Way("freerun", LIVE_HZ), few, phases="free_running"),
        Part(CORRECTED, seeds),
    ]
    return found + ([Part(Way(f"rig.{rig}", LIVE_HZ), seeds, rig=rig) for rig in OTHER_RIGS] if full else [])


def main() -> int:
    """Measure, print, write; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--full", action="store_true", help="five lessons for everything, and the other rigs")
    parser.add_argument("--fresh", action="store_true", help="run the networks again")
    parser.add_argument("--seeds", type=int, default=COUNT, help="lessons; the figures of record are of five")
    parser.add_argument("--no-peers", action="store_true", help="without Pose2Sim and aniposelib")
    parser.add_argument("--dataset", choices=("", *DATASETS, "shelf"), default="", help="a data set that you hold")
    parser.add_argument("--path", type=Path, help="its folder")
    parser.add_argument("--seconds", type=float, default=DATASET_SECONDS, help="of each of its films")
    options = parser.parse_args()
    try:
        if options.dataset:
            return on_dataset(options)
        return on_rendered(options)
    except UserError as error:
        sys.stderr.write(f"bench-reconstruct: {error}\n")
        return 2


def on_rendered(options: argparse.Namespace) -> int:
    """The rendered lessons."""
    seeds = seeds_of("test", options.seeds)
    report = Report("bench-reconstruct", seeds)
    wanted = parts(seeds, full=options.full)
    render_all([plan for part in wanted for plan in part.plans], options.data)
    # Ways that use the same keypoints come after the one that makes them.
    measured: dict[str, list[Measured]] = {}
    with ProcessPoolExecutor(PROCESSES, get_context("spawn")) as pool:
        futures = {
            part.way.name: [pool.submit(measure_plan, plan, part.way, options.data, options.fresh) for plan in part.plans]
            for part in wanted
            if part.way is not CORRECTED
        }
        for name, waiting in futures.items():
            measured[name] = [each.result() for each in waiting]
            print(f"{name}: {len(waiting)} lessons")
        for part in wanted:
            if part.way is CORRECTED:
                again = partial(measure_plan, way=part.way, data=options.data, fresh=False)
                measured[part.way.name] = list(pool.map(again, part.plans))
    for name, results in measured.items():
        report.add_seeds([figures_of(result, f".{name}" if name != LIVE.name else "") for result in results])
    for suffix, results in (("", measured[LIVE.name]), (".every_frame", measured[EVERY_FRAME.name])):
        # Not a mean: each of them is one too many.
        report.add({f"frames_without_pose{suffix}": float(sum(lost(result) for result in results))})
        report.deviations.pop(f"frames_without_pose{suffix}", None)
    bound = spread([result.further.get("crb_mm", math.nan) for result in measured[EVERY_FRAME.name]])
    mean, every, corrected = (report.figures.get(f"mpjpe_mm.{name}", math.nan) for name in ("mean", "every_frame", "corrected"))
    if bound is not None:
        report.add({"crb_mm": bound.mean, "crb_ratio": mean / bound.mean, "crb_ratio.every_frame": every / bound.mean})
    report.add({"margin_pct.corrected": margin_pct(corrected, mean)})
    changes = {name: change_pct(results, measured[LIVE.name]) for name, results in measured.items() if name != LIVE.name}
    report.add(changes, "mpjpe_change_pct.")
    report.rows += [row for results in measured.values() for result in results for row in rows_of(result)]
    report.tables += [by_action_table(results, name) for name, results in measured.items() if name in {LIVE.name, EVERY_FRAME.name}]
    report.tables.append(by_pupil_table(measured[LIVE.name]))
    if not options.no_peers:
        add_peers(report, measured, options.data, full=options.full)
    return report.conclude({}, options.data)


def add_peers(report: Report, measured: Mapping[str, Sequence[Measured]], data: Path, *, full: bool) -> None:
    """Margins, and a table."""
    for name, suffix in ((EVERY_FRAME.name, ""), (LIVE.name, ".live_rate"))[: 2 if full else 1]:
        with ThreadPoolExecutor(PROCESSES) as pool:  # they run in processes of their own
            standings: list[Standing] = list(pool.map(partial(stand, data=data, quick=not full), measured[name]))
        actions = [action for action in SIX_ACTIONS if all(action in standing.scores for standing in standings)]
        report.add(margin_figures(standings, UPRIGHT, actions, suffix))
        rows: dict[str, dict[str, Cell]] = {method: dict(row) for method, row in table_rows(standings, UPRIGHT).items()}
        report.tables.append(table_of(f"beside the best setting of each peer, MPJPE in mm, 13 joints, {name}", "method", rows))


def on_dataset(options: argparse.Namespace) -> int:
    """A data set that the user holds."""
    if options.path is None or not options.path.is_dir():
        raise UserError(
            f"{options.path} is no folder; name that of your files: make bench-reconstruct DATASET={options.dataset} PATH=folder"
        )
    if options.dataset == "shelf":
        return on_shelf.run(options.path, options.data)
    lessons = DATASETS[options.dataset](options.path, options.seconds)
    report = Report(f"bench-reconstruct-{options.dataset}")
    every, live = (
        [
            measure(lesson, way, tuple(sorted({span.action for span in lesson.spans})), options.data, fresh=options.fresh)
            for lesson in lessons
        ]
        for way in (EVERY_FRAME, LIVE)
    )
    for results, suffix in ((live, ""), (every, f".{EVERY_FRAME.name}")):
        report.add(dataset_figures(results, suffix))
        report.rows += [row for result in results for row in rows_of(result)]
        report.tables.append(by_action_table(results, results[0].way))
    return report.conclude({}, options.data)


if __name__ == "__main__":
    sys.exit(main())
