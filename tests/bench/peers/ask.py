"""Everybody's peers asked in one go, each in an empty folder of its own."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from tests.bench.metrics.position import margin_pct
from tests.bench.peers import aniposelib_group, pose2sim_project
from tests.bench.peers.answer import Answer, Keypoints

PEERS = (pose2sim_project.NAME, aniposelib_group.NAME)


def ask_peers(keypoints: list[Keypoints]) -> list[list[list[Answer]]]:
    """Each peer's answers in all its settings to each clip."""
    found = []
    for ask in (pose2sim_project.run_pose2sim, aniposelib_group.run_aniposelib):
        with tempfile.TemporaryDirectory() as folder:
            found.append(ask(Path(folder), keypoints))
    return found


def best_setting(peer: str, mpjpe_mm: Mapping[str, float]) -> str:
    """The setting of a peer with the smallest error, by "<peer>.<setting>"."""
    return min((method for method in mpjpe_mm if method.startswith(f"{peer}.")), key=lambda method: mpjpe_mm[method])


def margins_pct(ours: str, mpjpe_mm: Mapping[str, float]) -> dict[str, float]:
    """By peer, our margin over the best of its settings."""
    return {peer: margin_pct(mpjpe_mm[ours], mpjpe_mm[best_setting(peer, mpjpe_mm)]) for peer in PEERS}
