"""What goes wrong with the cameras of a simulated lesson, as pure functions of its plan: the same in every run.

Faults of two kinds. What changes the picture itself acts when it is rendered: free-running shutters, light, exposure, a camera that
was knocked. What happens to the picture on its way acts when it is played: cameras that swapped their names here, and pictures
lost, late, dark or with a wrong time in `edge.cameras.faulty`, which does the same to any other source.
"""

import math
from dataclasses import replace

import msgspec
import numpy as np

from edge.simulation.lesson.plan import Plan
from models.arrays import Float
from models.camera.pinhole import Camera
from models.config.site import FaultConfig


def phase_s(plan: Plan, camera: str) -> float:
    """How much later than at a whole number of periods a camera exposes: 0 if all are synced, else less than a period."""
    if plan.shutter.phases == "synced":
        return 0.0
    return float(np.random.default_rng(plan.lot("phase", camera)).uniform(0, 1 / plan.rate_hz))


def picture_count(plan: Plan, length_s: float) -> int:
    """Pictures of each camera in a lesson of this length."""
    return max(1, round(length_s * plan.rate_hz))


def picture_times_s(plan: Plan, camera: str, count: int) -> Float:
    """(count,) mid-exposure of the middle row of each picture of a camera, from the lesson's beginning."""
    return phase_s(plan, camera) + np.arange(count) / plan.rate_hz


def light_level(plan: Plan, t_s: float) -> float:
    """How bright the gym's lamps are at an instant; 1 is as usual."""
    return math.prod(change.level for change in plan.lights if change.at_s <= t_s < change.at_s + change.for_s)


def exposure_gain(plan: Plan, camera: str, t_s: float) -> float:
    """How bright a camera makes its pictures at an instant; 1 is as at first. Doubles with every stop, evenly in time."""
    stops = 0.0
    for change in plan.exposures:
        if change.camera == camera and t_s >= change.at_s:
            stops += change.stops * (min(1.0, (t_s - change.at_s) / change.over_s) if change.over_s > 0 else 1.0)
    return float(2.0**stops)


def camera_at(plan: Plan, camera: Camera, t_s: float) -> Camera:
    """A camera where it really is at an instant: as calibrated, until it is knocked."""
    for number, bump in enumerate(plan.bumps):
        if bump.camera == camera.name and t_s >= bump.at_s:
            generator = np.random.default_rng(plan.lot("bump", number))
            turn = _rotation(_direction(generator), math.radians(bump.turn_deg))
            centre_m = camera.centre_m + _direction(generator) * bump.move_cm / 100
            rotation = turn @ camera.rotation
            camera = replace(camera, rotation=rotation, translation_m=-rotation @ centre_m)
    return camera


def shown_by(plan: Plan, name: str, t_s: float) -> str:
    """The camera whose pictures arrive under a name at an instant."""
    swaps = sorted((swap for swap in plan.swaps if swap.at_s <= t_s), key=lambda swap: swap.at_s)
    # The newest exchange is of names: what the name stood for before it is what the other one stands for now.
    for swap in reversed(swaps):
        if name in swap.cameras:
            name = swap.cameras[1 - swap.cameras.index(name)]
    return name


def delivery_faults(plan: Plan, camera: str, length_s: float) -> list[FaultConfig]:
    """What happens to the pictures of a camera on their way, for a lesson that is played over and over.

    Args:
        plan: whose `faults` count from the lesson's beginning.
        camera: its name.
        length_s: of the lesson.

    Returns:
        The same faults for a `Script` that counts from the first lesson's beginning: each comes again with every lesson.
    """
    found = []
    for fault in plan.faults:
        if fault.camera != camera:
            continue
        times = math.ceil((length_s - fault.at_s) / fault.every_s) if fault.every_s > 0 else 1
        for number in range(times):
            at_s = fault.at_s + number * fault.every_s
            for_s = min(fault.for_s, length_s - at_s, fault.every_s or math.inf)
            if for_s > 0:
                found.append(msgspec.structs.replace(fault, at_s=at_s, for_s=for_s, every_s=length_s))
    return found


def _direction(generator: np.random.Generator) -> Float:
    vector = generator.standard_normal(3)
    return np.asarray(vector / np.linalg.norm(vector))


def _rotation(axis: Float, angle_rad: float) -> Float:
    """Rodrigues' formula."""
    x, y, z = axis
    cross = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    return np.asarray(np.eye(3) + math.sin(angle_rad) * cross + (1 - math.cos(angle_rad)) * cross @ cross)
