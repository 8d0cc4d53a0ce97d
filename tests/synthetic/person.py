"""Where a walking, arm-swinging, throwing person's COCO keypoints are at any time. Every limb keeps its length exactly."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.skeleton import coco

I = coco.INDEX  # noqa: E741


@dataclass(frozen=True)
class Person:
    """Proportions and habits.

    Attributes:
        height_m: standing height.
        centre_m: (x, y) around which the person walks.
        radius_m: of the circle walked on; 0 stands still.
        throws: whether the right arm throws every 1.6 s (wrist up to about 9 m/s).
        phase: shifts everything in time, so that two persons do not move alike.
    """

    height_m: float = 1.6
    centre_m: tuple[float, float] = (0.0, 0.0)
    radius_m: float = 0.9
    throws: bool = True
    phase: float = 0.0

    def joints(self, t_s: float) -> Float:
        """(17, 3) world, metres."""
        t = t_s + 10.0 * self.phase
        h = self.height_m
        around = 0.7 * t
        heading = around + np.pi / 2
        forward = np.array((np.cos(heading), np.sin(heading), 0.0))
        left = np.array((-forward[1], forward[0], 0.0))
        up = np.array((0.0, 0.0, 1.0))
        gait = 2 * np.pi * 0.9 * t
        pelvis = np.array((*self.centre_m, 0.53 * h + 0.02 * np.sin(2 * gait)))
        pelvis[:2] += self.radius_m * np.array((np.cos(around), np.sin(around)))
        lean = 0.15 + 0.1 * np.sin(0.8 * gait)
        spine = np.cos(lean) * up + np.sin(lean) * forward
        ahead = np.cos(lean) * forward - np.sin(lean) * up
        out = np.zeros((coco.COUNT, 3))
        neck = pelvis + 0.3 * h * spine
        skull = neck + 0.09 * h * spine
        out[I["nose"]] = skull + 0.06 * h * ahead
        for side, sign in (("left", 1.0), ("right", -1.0)):
            out[I[f"{side}_eye"]] = skull + 0.05 * h * ahead + sign * 0.02 * h * left + 0.02 * h * spine
            out[I[f"{side}_ear"]] = skull + sign * 0.045 * h * left + 0.01 * h * spine
            shoulder = neck + sign * 0.11 * h * left
            hip = pelvis + sign * 0.06 * h * left
            swing = 0.5 * np.sin(gait + (0.0 if sign > 0 else np.pi))
            arm, bend = self._throw(t) if self.throws and sign < 0 else (-swing, 0.4 + 0.3 * np.sin(gait))
            elbow = shoulder + 0.17 * h * _swing(-spine, ahead, arm, sign * 0.15 * left)
            wrist = elbow + 0.15 * h * _swing(-spine, ahead, arm + bend, sign * 0.15 * left)
            knee_bend = 0.5 + 0.4 * np.sin(gait + (0.5 if sign > 0 else 0.5 + np.pi))
            knee = hip + 0.245 * h * _swing(-up, forward, swing + 0.2, np.zeros(3))
            ankle = knee + 0.245 * h * _swing(-up, forward, swing + 0.2 - knee_bend, np.zeros(3))
            parts = ("shoulder", shoulder), ("elbow", elbow), ("wrist", wrist), ("hip", hip), ("knee", knee), ("ankle", ankle)
            for part, place in parts:
                out[I[f"{side}_{part}"]] = place
        return out

    def _throw(self, t: float) -> tuple[float, float]:
        """Angles of arm and elbow: back slowly, then forward fast."""
        u = (t / 1.6) % 1.0
        whip = 1.0 / (1.0 + np.exp(-(u - 0.62) / 0.025))
        back = 0.5 * (1.0 - np.cos(2 * np.pi * u))
        return float(2.6 * back * (1.0 - whip) + 0.9 * whip * back), float(1.5 * back * (1.0 - whip) + 0.2)


def _swing(down: Float, ahead: Float, angle: float, aside: Float) -> Float:
    """Unit direction of a limb that hangs down at angle 0 and points ahead at 90 degrees."""
    direction = np.cos(angle) * down + np.sin(angle) * ahead + aside
    unit: Float = direction / np.linalg.norm(direction)
    return unit
