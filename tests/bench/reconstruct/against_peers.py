"""Pose2Sim and aniposelib on the very keypoints that fusion was given, and everybody held against the truth.

Their answers are kept in `DATA/keypoints` by the keypoints and their versions, since they take longer than all else.
"""

import hashlib
import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from models.arrays import Float
from tests.bench.footage.one_person import for_peers
from tests.bench.kept import keep_arrays
from tests.bench.peers.answer import Answer
from tests.bench.peers.ask import PEERS, ask_peers, best_setting, margins_pct
from tests.bench.peers.pose2sim_project import JOINTS
from tests.bench.peers.score import Score, score_all
from tests.bench.reconstruct.measure import Measured

OURS: Final = "ours.smooth"
_LOCKS: Final = tuple(Path(__file__).parents[1] / f"peers/{peer}/requirements.lock" for peer in PEERS)
_JOINTS: Final = list(JOINTS)
"""The joints that every peer has."""


@dataclass(frozen=True)
class Standing:
    """Everybody on one clip.

    Attributes:
        seed: of its lesson.
        scores: by action and method.
    """

    seed: int
    scores: dict[str, dict[str, Score]]


def stand(measured: Measured, data: Path, *, quick: bool) -> Standing:
    """Score everybody on one clip; `quick` is of `ask_peers`."""
    clip = measured.clip
    joints = {OURS: clip.ours_m} | answers(measured, data, quick=quick)
    scores = {}
    for action in dict.fromkeys(filter(None, clip.actions)):
        frames = [number for number, name in enumerate(clip.actions) if name == action]
        truth = clip.truth_m[frames][:, _JOINTS]
        scores[action] = score_all({m: found[frames][:, _JOINTS] for m, found in joints.items()}, dict.fromkeys(joints, truth))
    return Standing(measured.seed, scores)


def answers(measured: Measured, data: Path, *, quick: bool) -> dict[str, Float]:
    """(frames, 17, 3) by method."""
    clip = measured.clip
    digest = hashlib.sha256(b"quick" if quick else b"all")
    for array in (clip.points_px, clip.scores, *(camera.projection for camera in clip.rig)):
        digest.update(np.ascontiguousarray(array).tobytes())
    for lock in _LOCKS:
        digest.update(lock.read_bytes())
    path = data / "keypoints" / f"peers-{digest.hexdigest()[:40]}.npz"
    if path.is_file():
        with np.load(path) as kept:
            return {method: kept[method] for method in kept}
    found: list[Answer] = []
    for (of_peer,) in ask_peers([for_peers(clip.rig, (clip.points_px, clip.scores), 1.0)], quick=quick):
        found += of_peer
    joints = {answer.method: answer.joints_m for answer in found}
    keep_arrays(path, joints)
    return joints


def mean_mpjpe_mm(standings: Sequence[Standing], actions: Sequence[str]) -> dict[str, float]:
    """By method, over seeds and actions; empty if an action is missing somewhere."""
    if not standings or any(action not in standing.scores for standing in standings for action in actions):
        return {}
    methods = standings[0].scores[actions[0]]
    return {
        method: statistics.fmean(standing.scores[action][method].mpjpe_mm for standing in standings for action in actions)
        for method in methods
    }


def margin_figures(
    standings: Sequence[Standing], upright: Sequence[str], actions: Sequence[str], suffix: str = ""
) -> dict[str, float]:
    """`margin_pct.<peer>` over the upright actions and by action; each time over the setting that came out best there."""
    found: dict[str, float] = {}
    for name, chosen in (("", tuple(upright)), *((f".{action}", (action,)) for action in actions)):
        means = mean_mpjpe_mm(standings, chosen) if chosen else {}
        found |= {f"margin_pct.{peer}{name}{suffix}": margin for peer, margin in margins_pct(OURS, means).items()} if means else {}
    return found


def table_rows(standings: Sequence[Standing], actions: Sequence[str]) -> dict[str, dict[str, float]]:
    """Ours and the best setting of each peer over all these actions: error by action, missing joints, acceleration error."""
    means = mean_mpjpe_mm(standings, actions)
    if not means:
        return {}
    rows: dict[str, dict[str, float]] = {}
    for method in (OURS, *(best_setting(peer, means) for peer in PEERS)):
        scores: list[Mapping[str, Score]] = [
            {action: standing.scores[action][method] for action in actions} for standing in standings
        ]
        flat = [score for by_action in scores for score in by_action.values()]
        rows[method] = {
            **{action: statistics.fmean(by_action[action].mpjpe_mm for by_action in scores) for action in actions},
            "mean": means[method],
            "acc_error_mm": statistics.fmean(score.acc_error_mm for score in flat),
            "missing_pct": statistics.fmean(score.missing_pct for score in flat),
            "frames_without_pose": float(sum(score.frames_without_pose for score in flat)),
        }
    return rows
