"""Streams that no healthy room makes: whatever the times, the output stays finite, bounded and honest."""

import numpy as np
import pytest

from models.messages.motion import JointState
from models.messages.observation import Crop, Observation, Person
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, predict_views, step
from tests.synthetic.gym import T0_NS, ring_rig
from tests.synthetic.person import Person as Pupil

RIG = ring_rig(4)
CONFIG = PRESETS["default"]
JOINTS = Pupil().joints(1.0)


def seen_by(index: int, t_ns: int, epoch: int = 0, sigma_px: float = 2.0) -> Observation:
    camera = RIG.cameras[index]
    points = camera.project(JOINTS).astype(np.float32)
    person = Person(1, Crop(640.0, 360.0, 400.0), points, np.full(17, sigma_px, np.float32), np.full(17, 0.9, np.float32))
    return Observation(camera.name, epoch, 0, 0, t_ns, t_ns, "thunder", (person,))


@pytest.mark.parametrize("seed", range(8))
def test_pictures_of_scattered_times_never_break_the_window(seed: int) -> None:
    random = np.random.default_rng(seed)
    state = initial_state(RIG)
    seen = []
    for tick in range(90):
        t_ns = T0_NS + round(tick * 1e9 / 30)
        for index in range(4):
            shift_s = random.normal(0, 0.05) if random.random() < 0.5 else random.choice((-1.0, -0.3, 0.0, 0.2, 0.3, 0.9))
            state, _ = step(state, seen_by(index, t_ns + round(shift_s * 1e9)), CONFIG)
        state, output = step(state, Tick(t_ns), CONFIG)
        for motion in output.motions:
            known = motion.states != JointState.UNKNOWN
            assert np.isfinite(motion.joints_m).all()
            assert np.isfinite(motion.covariance_m2).all()
            assert np.abs(motion.joints_m[known] - JOINTS[known]).max(initial=0.0) < 1.0
            seen.append(int((motion.states == JointState.SEEN).sum()))
    assert max(seen[-30:]) >= 9, "the pupil is still found"
    predict_views(state, t_ns)


@pytest.mark.parametrize("sigma_px", [1e-30, 1e-3, 1e6])
def test_extreme_sigmas_are_survived(sigma_px: float) -> None:
    state = initial_state(RIG)
    for tick in range(40):
        t_ns = T0_NS + round(tick * 1e9 / 30)
        for index in range(4):
            state, _ = step(state, seen_by(index, t_ns, sigma_px=sigma_px if index % 2 else 2.0), CONFIG)
        state, output = step(state, Tick(t_ns), CONFIG)
        assert all(np.isfinite(motion.joints_m).all() for motion in output.motions)
    assert output.motions
    for motion in output.motions:
        assert (motion.states == JointState.SEEN).all(), "two cameras are honest"
        assert np.abs(motion.joints_m - JOINTS).max() < 0.1


def test_one_cameras_wrong_epoch_does_not_blind_the_room_for_good() -> None:
    state = initial_state(RIG)
    seen = []
    for tick in range(150):
        t_ns = T0_NS + round(tick * 1e9 / 30)
        for index in range(4):
            epoch = 2**40 if index == 0 and tick >= 45 else 0
            state, _ = step(state, seen_by(index, t_ns, epoch), CONFIG)
        state, output = step(state, Tick(t_ns), CONFIG)
        live = [motion for motion in output.motions if motion.kind == "live"]
        seen.append(bool(live) and (live[-1].states == JointState.SEEN).all())
    assert seen[40]
    assert any(seen[-60:])
