"""A lesson that nobody renders: pupils who move, cameras that would film them, and when their pictures would be inferred."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from edge.simulation.picture.shutter import Shutter
from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.motions.motion import RATE_HZ
from models.skeleton import coco
from services.fusion.governor import turn_offset_ns
from tests.twin.truth import VELOCITY_SPAN_S, Truth

SAMPLES_HZ = RATE_HZ / 2
"""Poses a second that are computed; between them points are interpolated by cubics, to a tenth of a millimetre in a throw."""


class Performer(Protocol):
    """Somebody who moves."""

    @property
    def stature_m(self) -> float:
        """Standing height."""

    def coco_m(self, t_s: float) -> Float:
        """(17 or more, 3) COCO points in the world at a time of the lesson, before its beginning and after its end, too."""


@dataclass(frozen=True, eq=False)
class PlainPerformer:
    """Anything that moves by a function of time, such as `coco_m` of a simulated lesson's pupil."""

    stature_m: float
    points_m: Callable[[float], Float]

    def coco_m(self, t_s: float) -> Float:
        """(17 or more, 3) as the function gives it."""
        return self.points_m(t_s)


@dataclass(frozen=True, eq=False)
class Lesson:
    """What the twin makes observations of.

    Attributes:
        rig: the cameras.
        pupils: the first is looked at; the others can hide it.
        times_s: by camera, mid-exposure of the pictures that are inferred, ascending; `turns` gives what the box would do.
        seed: of the errors.
        shutter: of all cameras.
        start_ns: CLOCK_MONOTONIC of the lesson's beginning.
        delays_s: quantiles of the time from exposure to arrival, at equal shares; None takes the twin's.
    """

    rig: Rig
    pupils: tuple[Performer, ...]
    times_s: tuple[Float, ...]
    seed: int = 0
    shutter: Shutter = field(default_factory=Shutter)
    start_ns: int = 1_000_000_000
    delays_s: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if len(self.times_s) != len(self.rig) or not self.pupils:
            raise ValueError("a lesson has times for each camera of its rig, and a pupil")

    @property
    def seconds(self) -> float:
        """Until the last picture."""
        return max((float(times_s[-1]) for times_s in self.times_s if len(times_s)), default=0.0)


def turns(rig: Rig, rates_hz: float | Sequence[float], seconds: float) -> tuple[Float, ...]:
    """Times of the pictures if every camera is inferred so often, the cameras taking turns as the governor lets them."""
    rates = [rates_hz] * len(rig) if isinstance(rates_hz, int | float) else list(rates_hz)
    offsets_s = [1e-9 * turn_offset_ns(index, len(rig), rate) for index, rate in enumerate(rates)]
    return tuple(np.arange(offset, seconds, 1.0 / rate) for offset, rate in zip(offsets_s, rates, strict=True))


class Sampled:
    """All pupils between two instants."""

    def __init__(self, pupils: Sequence[Performer], begin_s: float, end_s: float) -> None:
        margin_s = VELOCITY_SPAN_S + 4 / SAMPLES_HZ + 0.05
        first = int(np.floor((begin_s - margin_s) * SAMPLES_HZ))
        last = int(np.ceil((end_s + margin_s) * SAMPLES_HZ))
        self._first = first
        times_s = np.arange(first, last + 1) / SAMPLES_HZ
        self._points_m = np.stack([[pupil.coco_m(float(t_s))[: coco.COUNT] for t_s in times_s] for pupil in pupils])
        self.statures_m = np.array([pupil.stature_m for pupil in pupils])

    def at(self, t_s: Float) -> Float:
        """(n, P, 17, 3) where each point is at its own time, `t_s` (n, P, 17); cubic between samples (Lagrange)."""
        place = t_s * SAMPLES_HZ - self._first
        base = np.clip(np.floor(place).astype(np.int64) - 1, 0, self._points_m.shape[1] - 4)
        u = (place - base)[..., None]
        pupil, joint = np.arange(t_s.shape[1])[:, None], np.arange(coco.COUNT)
        p0, p1, p2, p3 = (self._points_m[pupil, base + i, joint] for i in range(4))
        near = p0 * (-(u - 1) * (u - 2) * (u - 3) / 6) + p1 * (u * (u - 2) * (u - 3) / 2)
        return np.asarray(near + p2 * (-u * (u - 1) * (u - 3) / 2) + p3 * (u * (u - 1) * (u - 2) / 6))


def truth_of(sampled: Sampled, camera: Camera, t_s: Float, shutter: Shutter) -> Truth:
    """What a camera's shutter finds: each point at the time of the row on which it is then."""
    rows_s = np.broadcast_to(t_s[:, None, None], (len(t_s), len(sampled.statures_m), coco.COUNT))
    points_m = sampled.at(rows_s)
    for _ in range(2 if shutter.readout_s else 0):
        rows = np.nan_to_num(camera.project(points_m)[..., 1])
        rows_s = t_s[:, None, None] + shutter.row_delay_s(np.clip(rows, 0, camera.size_px[1] - 1), camera.size_px[1])
        points_m = sampled.at(rows_s)
    later, earlier = (
        sampled.at(np.full_like(rows_s, 0.0) + t_s[:, None, None] + span) for span in (VELOCITY_SPAN_S, -VELOCITY_SPAN_S)
    )
    velocity = (later[:, 0] - earlier[:, 0]) / (2 * VELOCITY_SPAN_S)
    return Truth(camera, t_s, points_m, velocity, sampled.statures_m)
