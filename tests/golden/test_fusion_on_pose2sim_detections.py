"""Fusion on real detections that are not part of the repository: OpenPose's on the single-person demo of Pose2Sim.

The geometry of that footage is off by 10 to 25 px before a shift of each camera, and a bystander stands in some views.
"""

import gzip
import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.messages.motion import JointState, Motion
from models.messages.observation import Crop, Observation, Person
from models.skeleton import coco
from services.fusion.pipeline import Tick
from tests.synthetic.play import Played, play

DATA = Path(__file__).parents[3] / "shared/data/pose2sim_single"
NAMES = ("cam01", "cam02", "cam03", "cam04")
T0_NS = 3_000_000_000_000
FRAMES = 100
SIGMA_PX = 6.0
SHIFTS_PX = {"cam01": (15.7, 0.7), "cam02": (-2.4, -5.1), "cam03": (11.8, 10.6), "cam04": (1.4, -3.5)}
"""What `services.calibration.shift` gives on frames 0-49 of these detections."""

pytestmark = [
    pytest.mark.shared_data,
    pytest.mark.slow,
    pytest.mark.skipif(not DATA.exists(), reason=f"measurement data is not at {DATA}; see CONTRIBUTING.md"),
]


def _rotation(vector: Float) -> Float:
    """Rodrigues' formula."""
    angle = math.sqrt(float(vector @ vector))
    x, y, z = vector / angle
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    rotation: Float = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return rotation


def _rig() -> Rig:
    table = tomllib.loads((DATA / "Calib_qualisys.toml").read_text())
    cameras = []
    for name in NAMES:
        entry = table[name]
        distortion = 64 * np.array([*entry["distortions"], 0.0])
        rotation = _rotation(np.array(entry["rotation"]))
        size = (int(entry["size"][0]), int(entry["size"][1]))
        matrix, translation, shift = np.array(entry["matrix"]), np.array(entry["translation"]), np.array(SHIFTS_PX[name])
        cameras.append(Camera(name, size, matrix, distortion, rotation, translation, shift))
    return Rig(tuple(cameras))


def _events(every: int) -> list[Observation | Tick]:
    """The detections at 30 frames a second, each camera looking at every n-th frame in its turn."""
    timed: list[tuple[float, Observation | Tick]] = []
    for index, name in enumerate(NAMES):
        with gzip.open(DATA / f"body25b_{name}.json.gz") as file:
            frames = json.load(file)
        for number in range(index % every, FRAMES, every):
            t_ns = T0_NS + round(number * 1e9 / 30)
            persons = tuple(
                person for track, flat in enumerate(frames[number]) if (person := _person(track, np.array(flat).reshape(-1, 3)))
            )
            timed.append((number / 30 + 0.05, Observation(name, 0, number, number, t_ns, t_ns, "body25b", persons)))
    timed += [(number / 30 + 1e-3, Tick(T0_NS + round(number * 1e9 / 30) + 1_000_000)) for number in range(1, FRAMES + 10)]
    timed.sort(key=lambda entry: entry[0])
    return [event for _, event in timed]


def _person(track: int, points: Float) -> Person | None:
    """BODY_25B begins with the COCO joints, in COCO's order; score 0 is "not found"."""
    score = points[: coco.COUNT, 2].astype(np.float32)
    if (score > 0).sum() < 6:
        return None
    sigma = np.full(coco.COUNT, SIGMA_PX, np.float32)
    return Person(track, Crop(0.0, 0.0, 1.0), points[: coco.COUNT, :2].astype(np.float32), sigma, score)


def _frames(motions: list[Motion]) -> dict[int, Motion]:
    return {round((motion.t_ns - T0_NS) * 30 / 1e9): motion for motion in motions}


@pytest.fixture(scope="module", params=[1, 3], ids=["30 Hz", "10 Hz in turns"])
def played(request: pytest.FixtureRequest) -> Played:
    return play(_rig(), _events(request.param))


def test_a_pose_in_every_frame_after_the_first_ten(played: Played) -> None:
    smooth, live = _frames(played.smooth), _frames(played.live)
    for frame in range(10, FRAMES):
        assert (smooth[frame].states == JointState.SEEN).sum() >= 14
        assert (live[frame].states == JointState.SEEN).sum() >= 12


def test_the_man_on_the_treadmill_is_followed_and_not_the_bystander(played: Played) -> None:
    frames = _frames(played.smooth)
    centres = np.array([np.median(frames[number].joints_m, axis=0) for number in range(5, FRAMES)])
    assert np.linalg.norm(np.diff(centres, axis=0), axis=1).max() < 0.3
    assert np.ptp(centres[:, 1]) < 0.3


def test_two_views_agree_on_almost_every_joint_and_limbs_keep_their_length(played: Played) -> None:
    motions = [motion for frame, motion in _frames(played.smooth).items() if 10 <= frame < FRAMES]
    assert np.mean([np.bitwise_count(motion.views) >= 2 for motion in motions]) > 0.95
    joints = np.array([motion.joints_m for motion in motions])
    lengths = [np.linalg.norm(joints[:, a] - joints[:, b], axis=1) for a, b in coco.LIMBS.values()]
    variation = [float(length.std() / length.mean()) for length in lengths]
    assert np.median(variation) < 0.035
    assert max(variation) < 0.12
