"""Pose2Sim and aniposelib beside the box's fusion, on the same keypoints, in one run: `make bench-peers`.

The synthetic gym has ground truth: four cameras at 30 Hz, noise of 2.5 px with heavy tails, occlusions, left-right swaps, a
confident distractor; several motions, five seeds. All cameras expose at the same instant, which is to the peers' advantage,
since they pair frames; `.freerun` is one motion with cameras that do not. The built-in footage has no truth: limbs and
reprojection. Everyone is measured in turns, and every peer in each of its documented settings; a margin is against the
setting that came out best on the truth.
"""

import argparse
import statistics
from collections.abc import Iterable, Mapping
from itertools import chain
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from models.arrays import Float
from models.camera.rig import decode_rig
from models.skeleton import coco
from tests.bench.footage.one_person import FULL_WIDTH_PX, MIN_SCORE, RIG, TESTED, for_peers
from tests.bench.footage.run import load_videos, look, pupil_keypoints
from tests.bench.metrics.limbs import limb_variation_pct
from tests.bench.metrics.reprojection import reprojection_px
from tests.bench.peers import aniposelib_group, ours, pose2sim_project
from tests.bench.peers.answer import Answer
from tests.bench.peers.ask import ask_peers, margins_pct
from tests.bench.peers.clips import MOTIONS, Clip, make_clip
from tests.bench.peers.score import Score, score_all
from tests.bench.reconstruct.fused import fuse
from tests.bench.reconstruct.observed import FLUSH_TICKS, RATE_HZ
from tests.bench.report import Report

SEEDS = range(5)
JUDGED = slice(15, -15)
"""Without the half second in which live estimates begin, and the peers' filters end."""
FREE_MOTION = "walk_throw"
TURNS = 3
SETTINGS = {
    f"{who.NAME}.{setting}": text for who in (ours, pose2sim_project, aniposelib_group) for setting, text in who.SETTINGS.items()
}
JOINTS = list(pose2sim_project.JOINTS)
Row = tuple[Clip, Answer, Score]


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True)
    data = parser.parse_args().data
    report = Report("bench-peers", SEEDS)
    aligned: list[Row] = []
    free: list[Row] = []
    ours.run_ours(make_clip(FREE_MOTION, 0, aligned=True))  # compiles
    for seed in SEEDS:
        clips = [make_clip(motion, seed, aligned=True) for motion in MOTIONS] + [make_clip(FREE_MOTION, seed, aligned=False)]
        rows = [
            (clip, answer, score)
            for clip, answers in zip(clips, ask_all(clips), strict=True)
            for answer, score in judge(clip, answers)
        ]
        aligned += [row for row in rows if row[0] is not clips[-1]]
        free += [row for row in rows if row[0] is clips[-1]]
        print(f"seed {seed} done")
    console = Console(width=150)
    for title, rows, suffix in (("cameras aligned", aligned, ""), ("cameras free-running", free, ".freerun")):
        methods = {method: summary([row for row in rows if row[1].method == method]) for method in SETTINGS}
        report.rows += [{"data": f"gym, {title}", "method": method, **figures} for method, figures in methods.items()]
        report.add({f"{name}.{method}{suffix}": value for method, figures in methods.items() for name, value in figures.items()})
        report.add(margins(methods, suffix))
        console.print(table(f"synthetic gym, {title}: {len(rows) // len(SETTINGS)} clips, {len(JOINTS)} joints", methods))
    for motion in MOTIONS:
        methods = {m: summary([row for row in aligned if row[1].method == m and row[0].motion == motion]) for m in SETTINGS}
        report.add(margins(methods, f".{motion}"))
    footage = on_footage(data)
    report.rows += [{"data": "footage", "method": method, **figures} for method, figures in footage.items()]
    report.add({f"footage.{name}.{method}": value for method, figures in footage.items() for name, value in figures.items()})
    console.print(table("built-in footage, frames 50-99", footage))
    for method, text in SETTINGS.items():
        console.print(f"{method:32} {text}", highlight=False)
    headline = {name: value for name, value in report.figures.items() if name.startswith("margin_pct")}
    console.print(
        table("margins over the best setting of each peer", {name: {"percent": value} for name, value in headline.items()})
    )
    print(f"written to {report.write(data)}")


def ask_all(clips: list[Clip]) -> list[list[Answer]]:
    """Everyone's answers to each clip, one method after the other."""
    keypoints = [clip.keypoints for clip in clips]
    own = [ours.run_ours(clip) for clip in clips]
    return [list(chain(*answers)) for answers in zip(own, *ask_peers(keypoints), strict=True)]


def judge(clip: Clip, answers: Iterable[Answer]) -> list[tuple[Answer, Score]]:
    """Hold answers against the truth at the instants that they are of."""
    answers = list(answers)
    frames = len(clip.keypoints)
    instants = {answer.method: ours.grid_ns(frames) if _is_ours(answer.method) else clip.times_ns for answer in answers}
    truth = {method: np.stack([clip.gym.truth(int(t)) for t in times])[JUDGED][:, JOINTS] for method, times in instants.items()}
    scores = score_all({answer.method: answer.joints_m[JUDGED][:, JOINTS] for answer in answers}, truth)
    return [(answer, scores[answer.method]) for answer in answers]


def summary(rows: list[Row]) -> dict[str, float]:
    """One method's figures: means over clips, the deviation over seeds, medians of times over the turns."""
    by_seed = [statistics.mean(score.mpjpe_mm for clip, _, score in rows if clip.seed == seed) for seed in SEEDS]
    return {
        "mpjpe_mm": statistics.mean(by_seed),
        "mpjpe_mm_sd": statistics.stdev(by_seed),
        "p95_mm": statistics.mean(score.p95_mm for _, _, score in rows),
        "acc_error_mm": statistics.mean(score.acc_error_mm for _, _, score in rows),
        "missing_pct": statistics.mean(score.missing_pct for _, _, score in rows),
        "frames_without_pose": float(sum(score.frames_without_pose for _, _, score in rows)),
        "cpu_ms_per_frame": statistics.median(answer.cpu_ms for _, answer, _ in rows),
        "wall_ms_per_frame": statistics.median(answer.wall_ms for _, answer, _ in rows),
    }


def margins(methods: Mapping[str, Mapping[str, float]], suffix: str) -> dict[str, float]:
    """Our margins over the best setting of each peer, smooth and live."""
    mpjpe_mm = {method: figures["mpjpe_mm"] for method, figures in methods.items()}
    return {
        f"margin_pct.{peer}{kind}{suffix}": margin
        for kind, method in (("", "ours.smooth"), (".live", "ours.live"))
        for peer, margin in margins_pct(method, mpjpe_mm).items()
    }


def on_footage(data: Path) -> dict[str, dict[str, float]]:
    """Everyone on the built-in footage, all cameras at every frame: limbs, reprojection, time."""
    rig = decode_rig(RIG.read_bytes(), str(RIG))
    videos = load_videos(rig, data)
    scale = FULL_WIDTH_PX / rig.cameras[0].size_px[0]
    frames = len(videos[0].pictures)
    events = look(rig, videos, data, RATE_HZ)
    own = fuse(rig, events, frames / RATE_HZ)
    points, scores = keypoints = pupil_keypoints(rig, events, own.smooth_m)
    joints = {"ours.smooth": own.smooth_m, "ours.live": own.live_m}
    cpu_ms: dict[str, list[float]] = {method: [] for method in SETTINGS}
    for _ in range(TURNS):
        spent_ms = 1e3 * fuse(rig, events, frames / RATE_HZ).cpu_s / (frames + FLUSH_TICKS)
        for method in joints:
            cpu_ms[method] += [spent_ms] if _is_ours(method) else []
        for ((*answers,),) in ask_peers([for_peers(rig, keypoints, scale)]):
            for answer in answers:
                joints[answer.method] = answer.joints_m
                cpu_ms[answer.method].append(answer.cpu_ms)

    def reprojection(joints_m: Float) -> Float:
        distance = reprojection_px(rig, joints_m[TESTED], points[TESTED], scores[TESTED], min_score=MIN_SCORE)
        return distance[:, :, JOINTS] * scale

    return {
        method: {
            "reprojection_px": float(np.nanmedian(reprojection(joints[method]))),
            **_limbs(limb_variation_pct(joints[method][TESTED])),
            "missing_pct": float(100 * np.isnan(joints[method][TESTED][:, JOINTS, 0]).mean()),
            "cpu_ms_per_frame": statistics.median(cpu_ms[method]),
        }
        for method in SETTINGS
    }


def _limbs(variation_pct: Mapping[str, float]) -> dict[str, float]:
    values = [variation_pct[limb] for limb in coco.LIMBS]
    return {"limb_cv_pct_median": statistics.median(values), "limb_cv_pct_max": max(values)}


def _is_ours(method: str) -> bool:
    return method.startswith(f"{ours.NAME}.")


def table(title: str, rows: Mapping[str, Mapping[str, float]]) -> Table:
    """A table with a row a method and a column a figure."""
    shown = Table(title=title)
    shown.add_column("")
    names = list(next(iter(rows.values())))
    for name in names:
        shown.add_column(name, justify="right")
    for method, figures in rows.items():
        shown.add_row(method, *(f"{figures[name]:.3g}" for name in names))
    return shown


if __name__ == "__main__":
    main()
