"""The step of the edge process: a frame becomes an observation. Pure but for what is passed in (networks, clock)."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Protocol

import msgspec
import numpy as np

from edge.cameras.source import Frame
from edge.perception.crop import cut, reduction_for
from edge.perception.tracking import (
    Look,
    TrackingConfig,
    Tracks,
    choose_looks,
    wants_detection,
    with_detections,
    with_poses,
)
from models.arrays import Float, Float32, UInt8
from models.messages.control import ViewControl
from models.messages.observation import Observation, Person
from models.messages.precision import keypoints, magnitudes

DETECTION_SIDE_PX = 416
"""The detector sees the picture reduced as far as its longer side stays above this."""


class PoseEstimate(Protocol):
    """Keypoints of one crop: `points` (17, 2) and `sigma` (17,) in crop coordinates [0, 1], `score` (17,) in [0, 1]."""

    @property
    def points(self) -> Float32:
        """(17, 2) x, y."""

    @property
    def score(self) -> Float32:
        """(17,)"""

    @property
    def sigma(self) -> Float32:
        """(17,) one standard deviation per axis."""


class PoseEstimator(Protocol):
    """A pose network: its name, the side of its input, and itself."""

    @property
    def name(self) -> str:
        """As in `ViewControl.network`."""

    @property
    def size_px(self) -> int:
        """Side of the crop that it takes."""

    def estimate(self, crop_rgb: UInt8) -> PoseEstimate:
        """Keypoints of a crop (size_px, size_px, 3)."""


class PersonDetector(Protocol):
    """Finds people in a whole picture."""

    def detect(self, image_rgb: UInt8) -> tuple[Float, Float]:
        """Boxes (n, 4) as x0, y0, x1, y1 in pixels of `image_rgb` and scores (n,), best first."""


@dataclass(frozen=True)
class Networks:
    """The networks for one frame; the detector is fetched only when it is needed."""

    pose: PoseEstimator
    detector: Callable[[], PersonDetector]


@dataclass(frozen=True)
class EdgeConfig:
    """Settings of the step."""

    tracking: TrackingConfig = field(default_factory=TrackingConfig)


@dataclass(frozen=True)
class EdgeState:
    """What is carried from frame to frame.

    `t_seam_ns` is the instant of the first picture of the present epoch; 0 in the first one. `bright` is the grey level (0 to 255)
    of the brightest places of the last picture that was decoded; None before the first.
    """

    epoch: int | None = None
    t_seam_ns: int = 0
    sequence: int = 0
    tracks: Tracks = field(default_factory=Tracks)
    bright: float | None = None


@dataclass
class Stages:
    """Adds up the CPU time of each stage, by a clock that is passed in (nanoseconds)."""

    cpu_ns: Callable[[], int]
    spent_ns: dict[str, int] = field(default_factory=dict)

    @contextmanager
    def measure(self, stage: str) -> Iterator[None]:
        """Charge what happens inside to `stage`."""
        begin_ns = self.cpu_ns()
        try:
            yield
        finally:
            self.spent_ns[stage] = self.spent_ns.get(stage, 0) + self.cpu_ns() - begin_ns


_SAMPLES = 64
"""Rows and columns of which the brightness is taken."""
_BRIGHT_SHARE = 1000


class _Pictures:
    """One frame decoded at the resolutions that are asked for, each once."""

    def __init__(self, frame: Frame, stages: Stages) -> None:
        self._frame = frame
        self._stages = stages
        self._decoded: dict[int, UInt8] = {}

    def at(self, reduction: int) -> UInt8:
        if reduction not in self._decoded:
            with self._stages.measure("decode"):
                self._decoded[reduction] = self._frame.image(reduction)
        return self._decoded[reduction]

    def bright(self) -> float | None:
        """Grey level of the brightest thousandth of the picture, which a few hot pixels are not; None if none was decoded."""
        for image in self._decoded.values():
            sample = image[:: max(image.shape[0] // _SAMPLES, 1), :: max(image.shape[1] // _SAMPLES, 1), 1]
            rank = sample.size - 1 - sample.size // _BRIGHT_SHARE
            return float(np.partition(sample, rank, axis=None)[rank])
        return None


def observe(
    state: EdgeState, frame: Frame, networks: Networks, control: ViewControl, config: EdgeConfig, stages: Stages
) -> tuple[EdgeState, Observation]:
    """Find and follow people in one frame and estimate their poses.

    Args:
        state: what the last frame left.
        frame: grabbed; decoded here, once, at the resolution that is needed.
        networks: what to run.
        control: fusion's newest wish.
        config: settings.
        stages: takes the CPU time of each stage.

    Returns:
        The next state, and the observation, whose `t_published_ns` is still 0: publishing is the caller's.

    Raises:
        PictureError: the frame cannot be decoded; `state` stays valid.
    """
    state = _across_seam(state, frame)
    tracks, control = state.tracks, _of_this_epoch(control, state.t_seam_ns)
    pictures = _Pictures(frame, stages)
    if wants_detection(tracks, control, frame.t_mid_ns, config.tracking):
        boxes_px = _detect(pictures, frame, networks, stages)
        tracks = with_detections(tracks, boxes_px, frame.t_mid_ns, config.tracking)
    tracks, looks = choose_looks(tracks, control, frame.t_mid_ns, config.tracking)
    poses = tuple(_pose(pictures, look, networks.pose, stages) for look in looks)
    tracks, persons = with_poses(tracks, poses, frame.t_mid_ns, config.tracking)
    observation = Observation(
        camera=frame.camera,
        epoch=frame.epoch,
        sequence=state.sequence,
        frame=frame.index,
        t_mid_ns=frame.t_mid_ns,
        t_published_ns=0,
        network=networks.pose.name,
        persons=persons,
    )
    bright = pictures.bright()
    state = replace(state, sequence=state.sequence + 1, tracks=tracks, bright=state.bright if bright is None else bright)
    return state, observation


def _across_seam(state: EdgeState, frame: Frame) -> EdgeState:
    """The state for a frame's epoch."""
    if state.epoch == frame.epoch:
        return state
    t_seam_ns = 0 if state.epoch is None else frame.t_mid_ns
    return replace(state, epoch=frame.epoch, t_seam_ns=t_seam_ns, tracks=state.tracks.across_seam(frame.t_mid_ns))


def _of_this_epoch(control: ViewControl, t_seam_ns: int) -> ViewControl:
    """The plan without a prediction from before the seam: the person moved differently then."""
    if control.prediction is None or control.prediction.t_ns >= t_seam_ns:
        return control
    return msgspec.structs.replace(control, prediction=None)


def _detect(pictures: _Pictures, frame: Frame, networks: Networks, stages: Stages) -> Float:
    """Boxes (n, 4) in pixels of the whole picture, best first."""
    reduction = reduction_for(max(frame.size_px), DETECTION_SIDE_PX)
    image = pictures.at(reduction)
    with stages.measure("detect"):
        boxes, _ = networks.detector().detect(image)
    return np.asarray(boxes, np.float64).reshape(-1, 4) * reduction + (reduction - 1) / 2


def _pose(pictures: _Pictures, look: Look, network: PoseEstimator, stages: Stages) -> Person:
    reduction = reduction_for(look.crop.side_px, network.size_px)
    image = pictures.at(reduction)
    with stages.measure("crop"):
        pixels = cut(image, reduction, look.crop, network.size_px)
    with stages.measure("pose"):
        estimate = network.estimate(pixels)
    points_px = look.crop.to_image(np.asarray(estimate.points, np.float64))
    return Person(
        track=look.number,
        crop=look.crop,
        keypoints_px=keypoints(points_px),
        sigma_px=magnitudes(estimate.sigma * np.float32(look.crop.side_px)),
        score=magnitudes(estimate.score),
    )
