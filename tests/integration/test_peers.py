"""The adapters of other people's systems: on keypoints without noise each must find the truth, or its figures mean nothing."""

from pathlib import Path

import numpy as np
import pytest

from models.arrays import Float
from models.skeleton import coco
from tests.bench.peers.aniposelib_group import run_aniposelib
from tests.bench.peers.answer import Answer, Keypoints
from tests.bench.peers.environment import is_installed
from tests.bench.peers.pose2sim_project import JOINTS, SETTINGS, SWAPS, run_pose2sim
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]

FRAMES = 24
INNER = slice(8, -8)
"""Away from the ends, where filters have less to go by; Pose2Sim's drop the last frame altogether."""
TOLERANCE_MM = 1.0
BENDS_MM = {"pose2sim.butterworth_on_speed": 10.0, "aniposelib.optim_library": 10.0}
"""The former is documented to offset what it filters, the latter penalises speed itself."""
EVERYTHING = list(range(coco.COUNT))


def require(peer: str) -> None:
    """Skip, saying so, where a peer is not installed: `make test` installs none, the benches do."""
    if not is_installed(peer):
        pytest.skip(f"{peer} is not installed; run `make build/peers/{peer}/.ready`")


def perfect(*, walks: bool) -> tuple[Keypoints, Float]:
    """Exact keypoints of a person, and where the joints are.

    Who does not walk glides, stiff, straight and slowly: that no smoothing may bend, whatever its strength.
    """
    rig, person = ring_rig(4), Person()
    along = np.array((0.2, 0.06, 0.0)) / 30
    joints = np.stack([person.joints(k / 30) if walks else person.joints(0.0) + (k - FRAMES / 2) * along for k in range(FRAMES)])
    points = np.stack([camera.project(joints) for camera in rig], axis=1)
    return Keypoints(rig, points, np.full((FRAMES, 4, coco.COUNT), 0.9), 30.0, scale=1.5), joints


def worst_mm(answer: Answer, joints_m: Float, joints: list[int]) -> float:
    return float(1e3 * np.linalg.norm(answer.joints_m[INNER][:, joints] - joints_m[INNER][:, joints], axis=-1).max())


def test_pose2sim_reproduces_a_perfect_scene_in_our_axes_and_units(tmp_path: Path) -> None:
    require("pose2sim")
    (walk, walk_m), (glide, glide_m) = perfect(walks=True), perfect(walks=False)
    (walked, *_), glided = run_pose2sim(tmp_path, [walk, glide])
    assert [answer.method for answer in glided] == [f"pose2sim.{setting}" for setting in SETTINGS]
    assert worst_mm(walked, walk_m, list(JOINTS)) < TOLERANCE_MM
    for answer in glided:
        bent_mm = BENDS_MM.get(answer.method.removesuffix(SWAPS), TOLERANCE_MM)
        assert worst_mm(answer, glide_m, list(JOINTS)) < bent_mm, answer.method
        assert answer.cpu_ms > 0
        assert answer.wall_ms > 0


def test_aniposelib_reproduces_a_perfect_scene_in_every_setting(tmp_path: Path) -> None:
    require("aniposelib")
    (walk, walk_m), (glide, glide_m) = perfect(walks=True), perfect(walks=False)
    (plain, ransac, *_), glided = run_aniposelib(tmp_path, [walk, glide])
    for answer in (plain, ransac):
        assert worst_mm(answer, walk_m, EVERYTHING) < TOLERANCE_MM, answer.method
    for answer in glided:
        assert worst_mm(answer, glide_m, EVERYTHING) < BENDS_MM.get(answer.method, TOLERANCE_MM), answer.method


def test_what_the_network_doubts_is_withheld_from_aniposelib(tmp_path: Path) -> None:
    require("aniposelib")
    clip, joints_m = perfect(walks=True)
    clip.points_px[:, 0, 9] += 80.0
    clip.scores[:, 0, 9] = 0.2
    ((plain,),) = run_aniposelib(tmp_path, [clip], ["plain"])
    assert worst_mm(plain, joints_m, [9]) < TOLERANCE_MM
