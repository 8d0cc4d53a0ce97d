"""Everybody's peers asked in one go, each in an empty folder of its own."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from tests.bench.metrics.position import margin_pct
from tests.bench.peers import aniposelib_group, pose2sim_project
from tests.bench.peers.answer import Answer, Keypoints

PEERS = (pose2sim_project.NAME, aniposelib_group.NAME)


QUICK_FILTERS = ("butterworth", "gcv_spline")
QUICK_SETTINGS = ("plain", "optim_library", "optim_anipose")
"""Without RANSAC, which takes ten times as long as all else together."""


def ask_peers(keypoints: list[Keypoints], *, quick: bool = False) -> list[list[list[Answer]]]:
    """Each peer's answers to each clip, in all its settings, or quickly in its default and in the best of the others."""
    with tempfile.TemporaryDirectory() as folder:
        filters, swaps = (QUICK_FILTERS, [False]) if quick else (pose2sim_project.FILTERS, [False, True])
        pose2sim = pose2sim_project.run_pose2sim(Path(folder), keypoints, filters, swaps)
    with tempfile.TemporaryDirectory() as folder:
        settings = QUICK_SETTINGS if quick else tuple(aniposelib_group.SETTINGS)
        return [pose2sim, aniposelib_group.run_aniposelib(Path(folder), keypoints, settings)]


def best_setting(peer: str, mpjpe_mm: Mapping[str, float]) -> str:
    """The setting of a peer with the smallest error, by "<peer>.<setting>"."""
    return min((method for method in mpjpe_mm if method.startswith(f"{peer}.")), key=lambda method: mpjpe_mm[method])


def margins_pct(ours: str, mpjpe_mm: Mapping[str, float]) -> dict[str, float]:
    """By peer, our margin over the best of its settings."""
    return {peer: margin_pct(mpjpe_mm[ours], mpjpe_mm[best_setting(peer, mpjpe_mm)]) for peer in PEERS}
