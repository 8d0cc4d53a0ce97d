"""Fusion as one pure function: `state, out = step(state, event, config)`.

An event is an observation, as it arrives, or a tick of the output's clock. The same events give the same output to the last
bit, so a recorded lesson replays through this code. The state is changed in place and belongs to the caller of `step`.
"""

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from models.camera.rig import Rig
from models.messages.control import CropPrediction
from models.messages.motion import CameraUse, JointState, Motion
from models.messages.observation import Observation
from models.messages.precision import covariances
from models.skeleton import coco
from services.fusion.config import FusionConfig
from services.fusion.landmarks import corrected
from services.fusion.prediction import predict_crop
from services.fusion.reconstruction import Reconstruction
from services.fusion.verdict import Pose
from services.fusion.views import Views, sightings

_NOBODY = Pose(
    np.zeros((coco.COUNT, 3)),
    np.zeros((coco.COUNT, 3, 3)),
    np.full(coco.COUNT, JointState.UNKNOWN, np.uint8),
    np.zeros(coco.COUNT, np.uint32),
)
_MAX_FUTURE_S = 0.25
"""A picture further ahead of the newest tick is refused; the smoother's window must still reach back to what is read out."""
_OUTVOTED_S = 1.0
"""Cameras that have shown an epoch for this long count; so long must the newest epoch have lasted to be given up."""
_MAX_GRID = 8
"""Smooth instants that one tick may give; a longer pause of the ticks leaves a hole."""


@dataclass(frozen=True)
class Tick:
    """Output is due: CLOCK_MONOTONIC nanoseconds."""

    t_ns: int


Ignored = Literal["not_calibrated", "of_the_future", "of_a_lone_epoch", "beyond_its_epoch", "of_a_past_epoch"]
"""Why an observation is not fused."""


@dataclass(frozen=True)
class FusionOutput:
    """What one event led to.

    Attributes:
        motions: live and smooth motions that became due; `t_published_ns` is the tick's time.
        found: whether the pupil is chosen.
        searching: by camera name, whether it should look at everyone; empty but at ticks.
        ignored: why the observation was not fused; None if it was, and at ticks.
    """

    motions: tuple[Motion, ...] = ()
    found: bool = False
    searching: dict[str, bool] = field(default_factory=dict)
    ignored: Ignored | None = None


@dataclass(eq=False)
class FusionState:
    """Everything that fusion remembers.

    Attributes:
        epochs: the running epoch last; before it the one whose instants are still to be given out.
        seams_s: when each of `epochs` begins.
        tick_ns: the newest tick, 0 before the first.
        grid: index of the next smooth instant, None before the first.
        sequences: motions given out, by kind.
        ignored: observations that were not fused, by camera and reason.
        stragglers_s: when each camera last showed an epoch that is past.
        outvoted: cameras that were ahead of most others; they open no epoch until they agree with another one.
    """

    views: Views
    epochs: list[Reconstruction] = field(default_factory=list)
    seams_s: list[float] = field(default_factory=list)
    tick_ns: int = 0
    grid: int | None = None
    sequences: dict[str, int] = field(default_factory=lambda: {"live": 0, "smooth": 0})
    ignored: dict[tuple[str, Ignored], int] = field(default_factory=dict)
    stragglers_s: dict[str, float] = field(default_factory=dict)
    outvoted: set[str] = field(default_factory=set)


def initial_state(rig: Rig) -> FusionState:
    """The state before the first event."""
    return FusionState(Views.of(rig))


def step(state: FusionState, event: Observation | Tick, config: FusionConfig) -> tuple[FusionState, FusionOutput]:
    """Take in one event."""
    if isinstance(event, Tick):
        return state, _tick(state, event.t_ns, config)
    reason = _observe(state, event, config)
    if reason is not None:
        state.ignored[event.camera, reason] = state.ignored.get((event.camera, reason), 0) + 1
    return state, FusionOutput(found=bool(state.epochs) and state.epochs[-1].pupil is not None, ignored=reason)


def predict_views(state: FusionState, t_ns: int) -> dict[str, CropPrediction | None]:
    """Where each camera should look at an instant near the newest tick; None where that is not known."""
    pupil = state.epochs[-1].pupil if state.epochs else None
    return {camera.name: None if pupil is None else predict_crop(pupil, camera, t_ns) for camera in state.views.rig}


def _observe(state: FusionState, observation: Observation, config: FusionConfig) -> Ignored | None:
    """Fuse an observation, or say why not."""
    t_s = observation.t_mid_ns * 1e-9
    if observation.camera not in state.views.index:
        return "not_calibrated"
    if state.tick_ns and t_s > state.tick_ns * 1e-9 + _MAX_FUTURE_S:
        return "of_the_future"
    if not state.epochs or observation.epoch > state.epochs[-1].epoch:
        if observation.camera in state.outvoted:
            return "of_a_lone_epoch"
        _open_epoch(state, observation.epoch, t_s)
    for index, reconstruction in enumerate(state.epochs):
        if reconstruction.epoch == observation.epoch:
            if index + 1 < len(state.epochs) and t_s >= state.seams_s[index + 1]:
                return "beyond_its_epoch"
            persons = sightings(observation, state.views, config.sighting)
            reconstruction.observe(state.views.index[observation.camera], t_s, persons, config)
            state.seams_s[index] = min(state.seams_s[index], t_s)
            state.outvoted.discard(observation.camera)
            return None
    state.stragglers_s[observation.camera] = t_s
    if _outvoted(state, t_s):
        newest_s = state.epochs[-1].newest_s
        state.outvoted = {name for name, index in state.views.index.items() if newest_s[index] > t_s - _OUTVOTED_S}
        state.epochs.clear()
        state.seams_s.clear()
        state.stragglers_s.clear()
    return "of_a_past_epoch"


def _outvoted(state: FusionState, t_s: float) -> bool:
    """Whether more cameras are in a past epoch than in the newest: one camera's wrong count must not blind the room."""
    newest_s = state.epochs[-1].newest_s
    present = int((newest_s > t_s - _OUTVOTED_S).sum())
    past = sum(seen_s > t_s - _OUTVOTED_S for seen_s in state.stragglers_s.values())
    return past > present and t_s - state.seams_s[-1] > _OUTVOTED_S


def _open_epoch(state: FusionState, epoch: int, t_s: float) -> None:
    familiar = state.epochs[-1].familiar if state.epochs else frozenset()
    state.epochs.append(Reconstruction(epoch, state.views, familiar))
    state.seams_s.append(t_s)


def _tick(state: FusionState, t_ns: int, config: FusionConfig) -> FusionOutput:
    if t_ns <= state.tick_ns:
        return FusionOutput()
    state.tick_ns = t_ns
    if not state.epochs:
        return FusionOutput(searching=dict.fromkeys(state.views.index, True))
    t_s = t_ns * 1e-9
    for reconstruction in state.epochs:
        reconstruction.tick(config)
    motions = _motions(state, t_s, config)
    current = state.epochs[-1]
    searching = {name: current.searching(index, config) for name, index in state.views.index.items()}
    return FusionOutput(motions, current.pupil is not None, searching)


def _motions(state: FusionState, now_s: float, config: FusionConfig) -> tuple[Motion, ...]:
    """The live instant and all grid instants that became due, each by the epoch that it belongs to."""
    live_s = now_s - config.live_lag_frames * config.frame_s
    until_s = live_s - config.smooth_lag_frames * config.frame_s
    until = int(np.floor(until_s / config.frame_s + 1e-6))
    first = int(np.ceil(state.epochs[0].first_s / config.frame_s))
    begin = max(first if state.grid is None else state.grid, until - _MAX_GRID + 1)
    motions = []
    for index, reconstruction in enumerate(state.epochs):
        begins_s = state.seams_s[index] if index else -np.inf
        ends_s = state.seams_s[index + 1] if index + 1 < len(state.epochs) else np.inf
        end = min(until + 1, int(np.ceil(min(ends_s, now_s) / config.frame_s)))
        grid = range(begin, max(begin, end))
        begin = grid.stop
        live, smooth = _NOBODY, [_NOBODY] * len(grid)
        if reconstruction.pupil is not None:
            live, smooth = reconstruction.pupil.poses(min(now_s, ends_s), live_s, grid, config)
            if config.landmark_bias is not None:
                live, *smooth = (corrected(pose, config.landmark_bias) for pose in (live, *smooth))
        if begins_s <= live_s < ends_s:
            motions.append(_motion(state, "live", reconstruction, live_s, live))
        motions += [
            _motion(state, "smooth", reconstruction, k * config.frame_s, pose) for k, pose in zip(grid, smooth, strict=True)
        ]
    state.grid = begin
    while len(state.epochs) > 1 and until_s >= state.seams_s[1]:
        del state.epochs[0], state.seams_s[0]
    return tuple(motions)


def _motion(state: FusionState, kind: str, reconstruction: Reconstruction, t_s: float, pose: Pose) -> Motion:
    newest_s = reconstruction.newest_s.tolist()
    used = int(np.bitwise_or.reduce(pose.views))
    ages_ms = [(t_s - newest) * 1e3 if newest > -math.inf else math.nan for newest in newest_s]
    cameras = tuple(CameraUse(name, bool((used >> i) & 1), ages_ms[i]) for name, i in state.views.index.items())
    sequence = state.sequences[kind]
    state.sequences[kind] = sequence + 1
    return Motion(
        kind="live" if kind == "live" else "smooth",
        sequence=sequence,
        epoch=reconstruction.epoch,
        t_ns=round(t_s * 1e9),
        t_newest_ns=round(max(newest_s) * 1e9),
        t_published_ns=state.tick_ns,
        joints_m=pose.joints_m.astype(np.float32),
        covariance_m2=covariances(pose.covariance_m2),
        states=pose.states,
        views=pose.views,
        cameras=cameras,
    )
