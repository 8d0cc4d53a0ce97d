"""A lesson on film: what each camera shows at each of its pictures, and what is true then."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from edge.simulation.lesson.plan import Plan
from edge.simulation.lesson.stage import Stage
from edge.simulation.lesson.world_faults import camera_at, exposure_gain, light_level, picture_count, picture_times_s
from edge.simulation.picture.renderer import Renderer, View
from edge.simulation.picture.sensor import Sensor
from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.truth import LessonTruth, Truth, joined
from edge.simulation.truth.witness import Witness
from models.arrays import UInt8

_WHITE_BALANCE = 0.04
"""By how much cameras of one kind disagree about white."""


class Film:
    """The pictures of a lesson, taken whenever they are asked for, in any order: they are the same to the bit.

    Args:
        plan: the lesson's plan.
        stage: what it puts before the cameras.
        noisy: False leaves out the sensors' noise, for pictures that get it later (`edge.simulation.shipped.install`).

    Raises:
        UserError: nothing can be rendered on this machine; says what is missing.
    """

    def __init__(self, plan: Plan, stage: Stage, *, noisy: bool = True) -> None:
        self._plan = plan
        self._stage = stage
        self._renderer = Renderer(stage.scene)
        self._shutter = Shutter(plan.shutter.exposure_ms / 1e3, plan.shutter.readout_ms / 1e3)
        self._sensors = {name: sensor_of(plan, name) for name in stage.rig.names}
        if not noisy:
            self._sensors = {name: replace(each, full_well_e=np.inf, read_noise_e=0.0) for name, each in self._sensors.items()}
        self._seats: dict[str, _Seat] = {}
        self._times_s = {name: picture_times_s(plan, name, picture_count(plan, stage.length_s)) for name in stage.rig.names}

    def take(self, camera: str, number: int) -> tuple[UInt8, Truth]:
        """Picture `number` of a camera of the rig, (H, W, 3) blue, green, red, and what is true in it."""
        t_s = float(self._times_s[camera][number])
        seat = self._seat(camera, t_s)
        light = seat.view.picture(t_s) * np.float32(light_level(self._plan, t_s))
        sensor = self._sensors[camera]
        picture = replace(sensor, exposure=sensor.exposure * exposure_gain(self._plan, camera, t_s)).develop(light, number)
        return picture, seat.witness.take_down(t_s)

    def truth_of(self, pictures: Mapping[str, Sequence[Truth]], origin: str) -> LessonTruth:
        """What is true in pictures of every camera, by the camera's name; `origin` says of which lesson."""
        pupils = self._stage.scene.pupils
        return LessonTruth(
            origin=origin,
            pupils=tuple(pupil.name for pupil in pupils),
            shapes=np.stack([pupil.body.shape for pupil in pupils]),
            rest_joints_m=np.stack([pupil.body.rest_joints_m for pupil in pupils]),
            shutter=self._shutter,
            sizes_px={camera.name: camera.size_px for camera in self._stage.rig},
            cameras={camera: joined(truths) for camera, truths in pictures.items()},
        )

    def _seat(self, camera: str, t_s: float) -> "_Seat":
        """Where a camera really is."""
        there = camera_at(self._plan, self._stage.rig.cameras[self._stage.rig.index(camera)], t_s)
        seat = self._seats.get(camera)
        if seat is None or not np.array_equal(seat.view.camera.projection, there.projection):
            view = self._renderer.view(there, self._shutter)
            witness = Witness(self._stage.scene, view.lens, self._shutter, self._renderer.courses)
            seat = self._seats[camera] = _Seat(view, witness)
        return seat


class _Seat(NamedTuple):
    view: View
    witness: Witness


def sensor_of(plan: Plan, camera: str) -> Sensor:
    """The sensor of a camera, before the plan changes its exposure."""
    generator = np.random.default_rng(plan.lot("white balance", camera))
    red, blue = (float(generator.uniform(1 - _WHITE_BALANCE, 1 + _WHITE_BALANCE)) for _ in range(2))
    return Sensor(white_balance=(red, 1.0, blue), seed=plan.lot("noise", camera))
