"""Compiles every hot loop before the first live frame, by fusing two seconds of a person who stands still."""

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.messages.observation import Crop, Observation, Person
from models.skeleton import coco
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, predict_views, step

_BEGIN_NS = 1_000_000_000
"""A clock that has run for a while, as CLOCK_MONOTONIC has: the first motion is of the time before the first tick."""
_PERIOD_NS = 33_333_333
_SIDE_M = {"left": 1.0, "right": -1.0, "nose": 0.0}
_PLACES_M = {
    "nose": (0.0, 1.50),
    "eye": (0.03, 1.54),
    "ear": (0.07, 1.52),
    "shoulder": (0.18, 1.32),
    "elbow": (0.30, 1.10),
    "wrist": (0.40, 0.90),
    "hip": (0.10, 0.85),
    "knee": (0.12, 0.45),
    "ankle": (0.13, 0.08),
}
"""Distance to the side and height of each kind of joint."""


def warm_up() -> None:
    """Run every kernel once with the types that live data has. Seconds on a box's first start, milliseconds after."""
    config = PRESETS["default"]
    rig = Rig(tuple(_camera(name, x, y) for name, x, y in (("a", 5.0, 0.0), ("b", 0.0, 5.0), ("c", -4.0, 3.0))))
    joints = _standing()
    state = initial_state(rig)
    sequence = 0
    for tick in range(1, 61):
        t_ns = _BEGIN_NS + tick * _PERIOD_NS
        for camera in rig:
            pixels = camera.project(joints).astype(np.float32)
            crop = Crop(float(pixels[:, 0].mean()), float(pixels[:, 1].mean()), 400.0)
            person = Person(1, crop, pixels, np.full(coco.COUNT, 2.0, np.float32), np.full(coco.COUNT, 0.9, np.float32))
            state, _ = step(state, Observation(camera.name, 0, sequence, tick, t_ns, t_ns, "none", (person,)), config)
            sequence += 1
        state, out = step(state, Tick(t_ns + _PERIOD_NS // 2), config)
    predict_views(state, t_ns)
    if not out.found:
        raise AssertionError("fusion does not find a person who stands still before three cameras")


def _camera(name: str, x: float, y: float) -> Camera:
    forward = -np.array((x, y, 0.0)) / np.hypot(x, y)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    rotation = np.stack((right, np.cross(forward, right), forward))
    matrix = np.array(((700.0, 0.0, 640.0), (0.0, 700.0, 360.0), (0.0, 0.0, 1.0)))
    centre = np.array((x, y, 1.0))
    return Camera(name, (1280, 720), matrix, np.zeros(5), rotation, -rotation @ centre, np.zeros(2))


def _standing() -> Float:
    def place(name: str) -> tuple[float, float, float]:
        side, _, part = name.partition("_")
        across, height = _PLACES_M[part or name]
        return _SIDE_M[side] * across, 0.02 * (part == ""), height

    return np.array([place(name) for name in coco.NAMES])
