"""Figures of everyone on the Shelf: PCP-3D of our fusion and of a greedy baseline, on the same candidates."""

import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from models.arrays import Bool, Float
from services.fusion.views import Views
from services.fusion.warm_up import warm_up
from tests.bench.report import Report
from tests.bench.shelf.data import LIMB_PARTS, PARTS, Shelf, as_shelf, nearest_person, right_parts
from tests.bench.shelf.follow import follow
from tests.bench.shelf.greedy import greedy_persons
from tests.bench.shelf.openpose import Grouped, group

ALL_CAMERAS, FEW_CAMERAS = (0, 1, 2, 3, 4), (0, 2, 4)
HELD_OUT = slice(75, 150)
BARS = {
    "pcp.limbs": (">=", 95.0),
    "margin.cams024.limbs": (">=", 4.0),
}
Persons = list[dict[int, Float]]


def run(shelf: Shelf, data: Path) -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    warm_up()
    report = Report("bench-shelf")
    began_s = time.thread_time()
    grouped = [[group(picture) for picture in pictures] for pictures in shelf.pictures]
    report.add({"grouping_cpu_ms_per_frame": 1e3 * (time.thread_time() - began_s) / len(grouped)})
    for cameras, suffix in ((ALL_CAMERAS, ""), (FEW_CAMERAS, ".cams024")):
        report.add(measure(shelf, grouped, cameras, suffix))
    report.figures["pcp.cams024"] = report.figures["pcp.limbs.cams024"]
    report.figures["margin.cams024.limbs"] = report.figures["pcp.limbs.cams024"] - report.figures["baseline.pcp.limbs.cams024"]
    report.rows += [{"part": name, **row} for name, row in parts(shelf, grouped).items()]
    return report.conclude(BARS, data)


def measure(shelf: Shelf, grouped: list[list[list[Grouped]]], cameras: tuple[int, ...], suffix: str) -> dict[str, float]:
    """Figures of ours and of the baseline with some of the cameras."""
    views = Views.of(shelf.rig.select(str(camera) for camera in cameras))
    frames = [[pictures[camera] for camera in cameras] for pictures in grouped]
    ours = follow(views, frames)
    began_s = time.thread_time()
    greedy = [dict(enumerate(greedy_persons(views, pictures))) for pictures in frames]
    greedy_s = time.thread_time() - began_s
    return {
        **pcp(shelf, ours.smooth, "pcp", suffix),
        **pcp(shelf, ours.live, "live.pcp", suffix),
        **pcp(shelf, greedy, "baseline.pcp", suffix),
        f"identity_switches{suffix}": float(identity_switches(shelf, ours.smooth)),
        f"fusion_cpu_ms_per_frame{suffix}": 1e3 * ours.cpu_s / len(frames),
        f"baseline.cpu_ms_per_frame{suffix}": 1e3 * greedy_s / len(frames),
    }


def pcp(shelf: Shelf, persons: Persons, name: str, suffix: str) -> dict[str, float]:
    """PCP in percent: all ten parts, limbs, each actor, and the same of the frames on which nothing was chosen."""
    right = judged(shelf, persons)
    everyone = np.concatenate(list(right.values()))
    held_out = np.concatenate([judgement for judgement in judged(shelf, persons, HELD_OUT).values() if len(judgement)])
    return {
        f"{name}.all{suffix}": percent(everyone),
        f"{name}.limbs{suffix}": percent(everyone[:, : len(LIMB_PARTS)]),
        f"{name}.limbs.held_out{suffix}": percent(held_out[:, : len(LIMB_PARTS)]),
        **{f"{name}.actor{actor}{suffix}": percent(judgement) for actor, judgement in right.items()},
    }


def judged(shelf: Shelf, persons: Persons, frames: slice = slice(None)) -> dict[str, Bool]:
    """Of each actor, (frames, 10) which parts are right."""
    right: dict[str, list[Bool]] = {}
    for truth, found in zip(shelf.truth[frames], persons[frames], strict=True):
        candidates = [as_shelf(joints) for joints in found.values()]
        for actor, joints in truth.items():
            right.setdefault(actor, []).append(right_parts(joints, candidates))
    return {actor: np.array(judgements) for actor, judgements in right.items()}


def identity_switches(shelf: Shelf, persons: Persons) -> int:
    """How often an actor's nearest person gets another number."""
    numbers: dict[str, list[int]] = {}
    for truth, found in zip(shelf.truth, persons, strict=True):
        for actor, joints in truth.items():
            nearest = nearest_person(joints, [as_shelf(person) for person in found.values()])
            if nearest is not None:
                numbers.setdefault(actor, []).append(list(found)[nearest])
    return sum(before != after for actor in numbers.values() for before, after in pairwise(actor))


def parts(shelf: Shelf, grouped: list[list[list[Grouped]]]) -> dict[str, dict[str, float]]:
    """PCP of each part, ours and the baseline's, with all cameras and with three."""
    rows: dict[str, dict[str, float]] = {part: {} for part in PARTS}
    for cameras, suffix in ((ALL_CAMERAS, ""), (FEW_CAMERAS, ".cams024")):
        views = Views.of(shelf.rig.select(str(camera) for camera in cameras))
        frames = [[pictures[camera] for camera in cameras] for pictures in grouped]
        greedy: Persons = [dict(enumerate(greedy_persons(views, pictures))) for pictures in frames]
        for name, persons in (("pcp", follow(views, frames).smooth), ("baseline.pcp", greedy)):
            everyone = np.concatenate(list(judged(shelf, persons).values()))
            for index, part in enumerate(PARTS):
                rows[part][f"{name}{suffix}"] = round(percent(everyone[:, index]), 1)
    return rows


def percent(right: Bool) -> float:
    """Share in percent."""
    return float(100 * right.mean())
