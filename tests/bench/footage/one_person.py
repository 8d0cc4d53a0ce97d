"""Accuracy on the built-in footage, beside Pose2Sim on the same keypoints, in the same run.

Every camera looks at every frame (`.live_rate` beside: ten times a second in turns, as on two cores). The shift of each
camera is solved on frames 0-49; everything is measured on frames 50-99, in pixels of the full resolution (1088 wide). Figures
with `.noshift` are without that shift; those with `.without_limb_term` are without eq. 16, so that a limb's steadiness is
the triangulation's alone.
"""

import argparse
import statistics
import sys
import tempfile
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import Float
from models.camera.rig import Rig, decode_rig
from models.messages.motion import JointState
from models.skeleton import coco
from services.calibration.shift import solve_shifts
from tests.bench.boxes import inside
from tests.bench.closed_loop import Event
from tests.bench.footage.run import load_videos, look, pupil_keypoints
from tests.bench.metrics.limbs import limb_variation_pct
from tests.bench.metrics.reprojection import reprojection_px
from tests.bench.metrics.steadiness import peak_speed_m_s
from tests.bench.peers.answer import Answer, Keypoints
from tests.bench.peers.pose2sim_project import run_pose2sim
from tests.bench.reconstruct.each_frame import frame_by_frame, looks_at_pupil
from tests.bench.reconstruct.fused import Fused, fuse
from tests.bench.reconstruct.observed import CONFIG, FLUSH_TICKS, RATE_HZ
from tests.bench.report import Report

RIG = Path("deploy/sites/footage/rig.toml")
PEOPLE = Path("tests/data/footage_people.toml")
FULL_WIDTH_PX = 1088
MIN_SCORE = 0.3
FITTED, TESTED = slice(0, 50), slice(50, 100)
FIRST_JUDGED = 10
MIN_JOINTS = 9
REPEATS = 7
PASSES = 15
BARS = {
    "reprojection_px.median": ("<=", 8.0),
    "views_per_joint": (">=", 3.3),
    "joints_two_views_pct": (">=", 95.0),
    "limb_cv_pct.median": ("<=", 3.5),
    "limb_cv_pct.max": ("<=", 7.0),
    "limb_cv_pct.worse_than_pose2sim": ("<=", 0.0),
    "wrist_speed_change_pct": ("within", 5.0),
    "frames_without_pose": ("<=", 0.0),
    "bystander_inliers": ("<=", 0.0),
    "speedup.pose2sim": (">=", 15.0),
}


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True)
    data = parser.parse_args().data
    report = Report("bench-footage")
    committed = decode_rig(RIG.read_bytes(), str(RIG))
    videos = load_videos(committed, data)
    scale = FULL_WIDTH_PX / committed.cameras[0].size_px[0]
    frames = len(videos[0].pictures)

    events = look(committed, videos, data, RATE_HZ)
    unshifted = committed.with_shifts(np.zeros((len(committed), 2)))
    rig = unshifted.with_shifts(solve(unshifted, events, frames))
    for camera in rig:
        report.rows.append({"camera": camera.name, "shift_px": (camera.shift_px * scale).round(2).tolist()})

    ours = fuse(rig, events, frames / RATE_HZ)
    keypoints = pupil_keypoints(rig, events, ours.smooth_m)
    report.add(accuracy(rig, ours, keypoints, scale))
    report.add(steadiness(rig, ours, events))
    report.add({"bystander_inliers": bystander_inliers(rig, ours, keypoints[0], tomllib.loads(PEOPLE.read_text())["picture"])})
    without = fuse(unshifted, events, frames / RATE_HZ)
    report.add(suffixed(accuracy(unshifted, without, pupil_keypoints(unshifted, events, without.smooth_m), scale), ".noshift"))

    free = replace(CONFIG, smoothing=replace(CONFIG.smoothing, limb_sigma=float("inf")))
    unbound = fuse(rig, events, frames / RATE_HZ, free)
    report.add(suffixed(accuracy(rig, unbound, keypoints, scale), ".without_limb_term"))

    slower = look(rig, videos, data, 10.0)
    sparse = fuse(rig, slower, frames / RATE_HZ)
    report.add(suffixed(accuracy(rig, sparse, keypoints, scale), ".live_rate"))
    report.add({"frames_without_pose.live_rate": frames_without_pose(sparse)})

    # In turns and for about as long, so that a machine that is slower for a while is slower for both; medians, for the same reason.
    peers, own_s = [], []
    for _ in range(REPEATS):
        peers.append(pose2sim(rig, keypoints, scale))
        own_s += [fuse(rig, events, frames / RATE_HZ).cpu_s for _ in range(PASSES)]
    report.add(limbs_beside(ours, peers[0]))
    report.add(speeds(statistics.median(own_s), statistics.median(peer.cpu_ms for peer in peers), frames))
    return report.conclude(BARS, data)


def solve(rig: Rig, events: list[Event], frames: int) -> Float:
    """(cameras, 2) shifts from the fitted frames alone."""
    rough = fuse(rig, events, frames / RATE_HZ)
    points, scores = pupil_keypoints(rig, events, rough.smooth_m)
    return solve_shifts(rig, points[FITTED], np.nan_to_num(scores[FITTED]))


def accuracy(rig: Rig, found: Fused, keypoints: tuple[Float, Float], scale: float) -> dict[str, float]:
    """Reprojection, views and limbs over the tested frames; keypoints of every frame."""
    points, scores = keypoints
    distance = reprojection_px(rig, found.smooth_m[TESTED], points[TESTED], scores[TESTED], min_score=MIN_SCORE) * scale
    counts = np.bitwise_count(found.views[TESTED])
    limbs = limb_variation_pct(found.smooth_m[TESTED])
    return {
        "reprojection_px.median": float(np.nanmedian(distance)),
        "reprojection_px.p90": float(np.nanpercentile(distance, 90)),
        "views_per_joint": float(counts.mean()),
        "joints_two_views_pct": float(100 * (counts >= 2).mean()),
        "limb_cv_pct.median": float(np.median(list(limbs.values()))),
        "limb_cv_pct.max": max(limbs.values()),
        **{f"limb_cv_pct.{limb}": value for limb, value in limbs.items()},
    }


def steadiness(rig: Rig, found: Fused, events: list[Event]) -> dict[str, float]:
    """What smoothing does to the fastest movement of the wrists, and frames without a pose."""
    alone = frame_by_frame(rig, looks_at_pupil(rig, events, found.smooth_m), len(found.smooth_m))
    changes = []
    for wrist in ("left_wrist", "right_wrist"):
        joint = coco.INDEX[wrist]
        raw = peak_speed_m_s(alone[TESTED, joint], RATE_HZ)
        changes.append(100 * (peak_speed_m_s(found.smooth_m[TESTED, joint], RATE_HZ) / raw - 1))
    return {
        "wrist_speed_change_pct": max(changes, key=abs) if changes else float("nan"),
        "frames_without_pose": frames_without_pose(found),
    }


def frames_without_pose(found: Fused) -> float:
    """Frames after the first ten in which the live or the smooth motion has fewer than nine joints seen by two views."""
    live = (found.live_states[FIRST_JUDGED:] == JointState.SEEN).sum(axis=1)
    smooth = (found.smooth_states[FIRST_JUDGED:] == JointState.SEEN).sum(axis=1)
    return float((np.minimum(live, smooth) < MIN_JOINTS).sum())


def bystander_inliers(rig: Rig, found: Fused, points_px: Float, pictures: list[dict[str, Any]]) -> float:
    """Keypoints that were fused and lie in a hand-drawn box of somebody else, and not in the pupil's."""
    count = 0
    for picture in pictures:
        index, frame = rig.index(picture["camera"]), picture["frame"]
        fused = (found.views[frame] >> index) & 1 == 1
        observed = points_px[frame, index]
        own = inside(observed, np.array(picture["pupil"]))
        for box in picture.get("bystanders", []):
            count += int((fused & inside(observed, np.array(box)) & ~own).sum())
    return float(count)


def for_peers(rig: Rig, keypoints: tuple[Float, Float], scale: float) -> Keypoints:
    """The pupil's keypoints, undistorted and shifted back."""
    points, scores = keypoints
    flat = np.stack([camera.undistort(points[:, i]) - camera.shift_px for i, camera in enumerate(rig)], axis=1)
    return Keypoints(rig.with_shifts(np.zeros((len(rig), 2))), flat, scores, RATE_HZ, scale)


def pose2sim(rig: Rig, keypoints: tuple[Float, Float], scale: float) -> Answer:
    """The peer with its default filter on the pupil's keypoints."""
    with tempfile.TemporaryDirectory() as folder:
        ((_, filtered),) = run_pose2sim(Path(folder), [for_peers(rig, keypoints, scale)], ["butterworth"], [False])
    return filtered


def limbs_beside(ours: Fused, theirs: Answer) -> dict[str, float]:
    """Pose2Sim's limbs, and how many of ours vary more."""
    limbs, peer = limb_variation_pct(ours.smooth_m[TESTED]), limb_variation_pct(theirs.joints_m[TESTED])
    return {
        **{f"pose2sim.limb_cv_pct.{limb}": value for limb, value in peer.items()},
        "pose2sim.limb_cv_pct.median": float(np.median(list(peer.values()))),
        "pose2sim.limb_cv_pct.max": max(peer.values()),
        "limb_cv_pct.worse_than_pose2sim": float(sum(limbs[limb] > peer[limb] for limb in limbs)),
    }


def speeds(own_s: float, peer_ms: float, frames: int) -> dict[str, float]:
    """CPU from keypoints to smooth joints: ours (association, filters, live and smooth output) and Pose2Sim's three stages."""
    return {
        "fusion_cpu_ms_per_frame": 1e3 * own_s / (frames + FLUSH_TICKS),
        "pose2sim.cpu_ms_per_frame": peer_ms,
        "speedup.pose2sim": peer_ms * frames / (1e3 * own_s),
    }


def suffixed(figures: dict[str, float], suffix: str) -> dict[str, float]:
    """The same figures under names that say how they differ."""
    return {name + suffix: value for name, value in figures.items()}


if __name__ == "__main__":
    sys.exit(main())
