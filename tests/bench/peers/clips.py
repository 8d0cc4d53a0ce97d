"""Clips of the synthetic gym, as the box's event stream and as the frames that offline systems take, from the same keypoints."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from models.arrays import Float
from models.messages.observation import Observation
from models.skeleton import coco
from services.fusion.pipeline import Tick
from tests.bench.peers.answer import Keypoints
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.person import Person

RATE_HZ: Final = 30.0
SECONDS: Final = 3.0
LATE_S: Final = 0.1
FRAMES: Final = round(SECONDS * RATE_HZ)
MOTIONS: Final = {
    "walk": Person(throws=False),
    "throw": Person(radius_m=0.0),
    "walk_throw": Person(),
}
HEIGHTS_M: Final = (1.35, 1.45, 1.6, 1.7, 1.85)


@dataclass(frozen=True, eq=False)
class Clip:
    """One motion, seen by four cameras with all faults.

    Attributes:
        motion: of `MOTIONS`.
        seed: of the faults, and of the person's height and phase.
        gym: knows the truth.
        events: what the box receives, in order of arrival.
        keypoints: what an offline system receives.
        times_ns: (frames,) the instant that a frame of `keypoints` is of: the mean of its cameras' exposures.
    """

    motion: str
    seed: int
    gym: Gym
    events: list[Observation | Tick]
    keypoints: Keypoints
    times_ns: Float


def make_clip(motion: str, seed: int, *, aligned: bool) -> Clip:
    """A clip at 30 Hz in which all cameras expose at the same instant, or each at its own.

    Cameras that run freely are paired with the nearest frame of camera 0, as offline systems do that synchronise by whole frames.
    """
    person = replace(MOTIONS[motion], height_m=HEIGHTS_M[seed % len(HEIGHTS_M)], phase=0.37 * seed)
    phases = np.zeros(4) if aligned else np.random.default_rng((99, seed)).uniform(0, 1 / RATE_HZ, 4)
    gym = Gym(pupil=person, seconds=SECONDS, rates_hz=(RATE_HZ,), jitter=0.0, phases_s=tuple(phases.tolist()), seed=seed)
    events = gym.events()
    # What arrives late at the end is missing for the box; it would be a hole in the middle of the frames.
    pictures = [event for event in events if isinstance(event, Observation) and event.t_mid_ns < T0_NS + (SECONDS - LATE_S) * 1e9]
    pictures.sort(key=lambda picture: picture.t_mid_ns)
    seen = [[picture for picture in pictures if picture.camera == name] for name in gym.rig.names]
    first = np.array([observation.t_mid_ns for observation in seen[0]])
    points = np.full((FRAMES, len(gym.rig), coco.COUNT, 2), np.nan)
    scores = np.full((FRAMES, len(gym.rig), coco.COUNT), np.nan)
    times = np.full((FRAMES, len(gym.rig)), np.nan)
    for camera, observations in enumerate(seen):
        instants = np.array([observation.t_mid_ns for observation in observations])
        for frame in range(min(FRAMES, len(first))):
            nearest = observations[int(np.abs(instants - first[frame]).argmin())]
            points[frame, camera], scores[frame, camera] = nearest.persons[0].keypoints_px, nearest.persons[0].score
            times[frame, camera] = nearest.t_mid_ns - T0_NS
    whole = np.isfinite(times).all(axis=1)
    keypoints = Keypoints(gym.rig, points[whole], scores[whole], RATE_HZ)
    return Clip(motion, seed, gym, events, keypoints, times[whole].mean(axis=1).round() + T0_NS)
