"""The built-in footage through the box's own steps, without clock and sockets, so that a run repeats to the last bit.

See `tests.bench.closed_loop` for what is run.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edge.cameras.video import Schedule, Video, load_video
from edge.footage.sets import ONE_PERSON, Footage
from edge.observe import Networks
from edge.perception.detection import load_person_detector
from edge.perception.networks import Provider
from edge.perception.pose import load_pose_network
from models.arrays import Float, UInt8, UInt32
from models.camera.rig import Rig
from models.messages.control import PoseNetwork
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation, Person
from models.skeleton import coco
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.pipeline import FusionOutput, Tick, initial_state, step
from services.fusion.triangulation import triangulate
from services.fusion.views import Views, sightings
from tests.bench.closed_loop import Event, Pace, watch

START_NS = 1_000_000_000
RATE_HZ = 30.0
FLUSH_FRAMES = 10
CONFIG = PRESETS["default"]


@dataclass(frozen=True)
class Reconstruction:
    """Motions by frame of the footage; NaN where there was none.

    Attributes:
        live_m, smooth_m: (frames, 17, 3).
        live_states, smooth_states: (frames, 17) `JointState`.
        views: (frames, 17) inlier views of the smooth motion, a bit a camera.
        cpu_s: CPU seconds of fusion's steps, all events.
    """

    live_m: Float
    smooth_m: Float
    live_states: UInt8
    smooth_states: UInt8
    views: UInt32
    cpu_s: float


def load_videos(rig: Rig, data: Path, footage: Footage = ONE_PERSON) -> list[Video]:
    """A prepared footage."""
    return [load_video(data / footage.name / f"{name}.avi", name) for name in rig.names]


def look(
    rig: Rig, videos: Sequence[Video], data: Path, rate_hz: float, network: PoseNetwork = "thunder", provider: Provider = "cpu"
) -> list[Event]:
    """Run the networks over the footage, each camera in its turn at `rate_hz`, fusion pointing them to the pupil.

    Returns:
        What fusion consumed, in its order.
    """
    pose = load_pose_network(network, data, provider)
    detector = load_person_detector(data, provider)
    networks = Networks(pose, lambda: detector)
    number = len(videos[0].pictures)
    schedule = Schedule(START_NS, 0, RATE_HZ)
    times_ns = [schedule.t_ns(index) for index in range(number)]
    pictures = (video.frame(0, index, times_ns[index]) for index in range(number) for video in videos)
    events = watch(rig, pictures, times_ns, networks, Pace(rate_hz, network, START_NS), CONFIG)
    return events + [Tick(times_ns[-1] + round(k * 1e9 / RATE_HZ)) for k in range(1, FLUSH_FRAMES + 1)]


def reconstruct(rig: Rig, events: Sequence[Event], frames: int, config: FusionConfig = CONFIG) -> Reconstruction:
    """Fuse recorded events."""
    state = initial_state(rig)
    joints = {kind: np.full((frames, coco.COUNT, 3), np.nan) for kind in ("live", "smooth")}
    states = {kind: np.zeros((frames, coco.COUNT), np.uint8) for kind in ("live", "smooth")}
    views = np.zeros((frames, coco.COUNT), np.uint32)
    outputs: list[FusionOutput] = []
    began = time.thread_time()
    for event in events:
        state, output = step(state, event, config)
        outputs.append(output)
    cpu_s = time.thread_time() - began
    motions: list[Motion] = [motion for output in outputs for motion in output.motions]
    for motion in motions:
        frame = round((motion.t_ns - START_NS) * 1e-9 * RATE_HZ)
        if not 0 <= frame < frames:
            continue
        known = motion.states != JointState.UNKNOWN
        joints[motion.kind][frame, known] = motion.joints_m[known]
        states[motion.kind][frame] = motion.states
        if motion.kind == "smooth":
            views[frame] = motion.views
    return Reconstruction(joints["live"], joints["smooth"], states["live"], states["smooth"], views, cpu_s)


def pupil_keypoints(rig: Rig, events: Sequence[Event], near_m: Float) -> tuple[Float, Float]:
    """The keypoints of the person that each camera saw nearest to a reconstruction.

    Args:
        rig: calibration.
        events: recorded.
        near_m: (frames, 17, 3) reconstruction that tells the pupil from others.

    Returns:
        (frames, cameras, 17, 2) pixels as observed and (frames, cameras, 17) scores; NaN where the camera did not look.
    """
    points = np.full((len(near_m), len(rig), coco.COUNT, 2), np.nan)
    scores = np.full((len(near_m), len(rig), coco.COUNT), np.nan)
    for event in events:
        if isinstance(event, Tick) or not event.persons or event.frame >= len(near_m):
            continue
        index = rig.index(event.camera)
        projected = rig.cameras[index].project(near_m[event.frame])
        person = min(event.persons, key=lambda person: _distance_px(person, projected))
        points[event.frame, index] = person.keypoints_px
        scores[event.frame, index] = person.score
    return points, scores


def frame_by_frame(rig: Rig, events: Sequence[Event], frames: int) -> Float:
    """(frames, 17, 3) robust triangulation of each frame alone, without any smoothing; NaN where two views don't agree.

    For runs in which every camera looks at every frame.
    """
    views = Views.of(rig)
    joints = np.full((frames, coco.COUNT, 3), np.nan)
    for number in range(frames):
        seen = [event for event in events if isinstance(event, Observation) and event.frame == number and event.persons]
        first = [sightings(observation, views, CONFIG.sighting)[0] for observation in seen]
        points = np.zeros((len(rig), coco.COUNT, 2))
        sigma = np.ones((len(rig), coco.COUNT))
        usable = np.zeros((len(rig), coco.COUNT), bool)
        for sighting in first:
            points[sighting.camera], sigma[sighting.camera] = sighting.points_px, sighting.sigma_px
            usable[sighting.camera] = sighting.usable
        found = triangulate(views, points, sigma, usable, CONFIG.triangulation)
        agreed = found.count >= 2
        joints[number, agreed] = found.points_m[agreed]
    return joints


def _distance_px(person: Person, projected: Float) -> float:
    distance = np.linalg.norm(person.keypoints_px - projected, axis=-1)
    finite = distance[np.isfinite(distance)]
    return float(np.median(finite)) if len(finite) else float(-person.score.mean())
