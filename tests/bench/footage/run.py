"""The built-in footage through the box's own steps, without clock and sockets, so that a run repeats to the last bit.

See `tests.bench.closed_loop` for what is run.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from edge.cameras.video import Schedule, Video, load_video
from edge.footage.sets import ONE_PERSON, Footage
from edge.observe import Networks
from edge.perception.detection import load_person_detector
from edge.perception.networks import Provider
from edge.perception.pose import load_pose_network
from models.arrays import Float
from models.camera.rig import Rig
from models.messages.control import PoseNetwork
from models.skeleton import coco
from services.fusion.pipeline import Tick
from tests.bench.closed_loop import Event, Pace, watch
from tests.bench.reconstruct.each_frame import looks_at_pupil
from tests.bench.reconstruct.lesson import START_NS
from tests.bench.reconstruct.observed import CONFIG, FLUSH_TICKS, RATE_HZ


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
    return events + [Tick(times_ns[-1] + round(k * 1e9 / RATE_HZ)) for k in range(1, FLUSH_TICKS + 1)]


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
    for look in looks_at_pupil(rig, events, near_m):
        place, (pupil,) = (look.frame, rig.index(look.camera)), look.persons
        points[place], scores[place] = pupil.keypoints_px, pupil.score
    return points, scores
