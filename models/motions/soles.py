"""The soles: where a foot's skin is lowest when it is pitched, so that it can be put on the floor, on its heel or on its toes.

A foot is placed by its **footprint**: the point of the floor under its ball (the toes' joint) when it stands flat, and its yaw.
Pitch 0 is flat. Positive pitch raises the heel: the foot turns about the ball, and the toes stay flat on the floor. Negative
pitch raises the toes: the foot turns about its heel.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.body.model import Body
from models.body.pose import t_pose
from models.motions import rotations
from models.skeleton import smpl

PITCH_DEG: Final = (-50.0, 58.0)
_STEP_DEG: Final = 2.0


@dataclass(frozen=True, eq=False)
class Sole:
    """Where the ankle is over the footprint, by pitch, and where the skin is that may touch the floor.

    Attributes:
        pitches_rad: (N,) ascending.
        ankles_m: (N, 2) of the ankle against the footprint of a foot that looks along x: forward and up. The lowest skin is at 0.
        under_foot_m: (P, 3) skin under the foot against the ankle, in the T-pose.
        under_toes_m: (Q, 3) skin under the toes against their joint, in the T-pose.
    """

    pitches_rad: Float
    ankles_m: Float
    under_foot_m: Float
    under_toes_m: Float

    def ankle_m(self, pitch_rad: Float) -> tuple[Float, Float]:
        """Forward and up of the ankle against the footprint, at pitches within `PITCH_DEG`."""
        forward, up = (np.interp(pitch_rad, self.pitches_rad, column) for column in self.ankles_m.T)
        return forward, up

    def lowest_m(self, joints_m: Float, turns: Float) -> Float:
        """(T,) the lowest skin over the floor, for (T, 2, 3) ankles and toes' joints and their (T, 2, 3, 3) turns in the world."""
        under = (self.under_foot_m, self.under_toes_m)
        heights = [joints_m[:, part, 2] + (turns[:, part, 2] @ points.T).min(1) for part, points in enumerate(under)]
        return np.asarray(np.minimum(*heights))

    def ankles_at(self, places_m: Float, yaw_rad: Float, pitch_rad: Float) -> Float:
        """(T, 3) ankles of (T, 3) footprints (z: how far the sole is off the floor) with (T,) yaw and pitch."""
        forward, up = self.ankle_m(pitch_rad)
        return np.asarray(places_m + np.stack((forward * np.cos(yaw_rad), forward * np.sin(yaw_rad), up), axis=-1))


def toes_rad(pitch_rad: Float) -> Float:
    """How the toes bend against the foot at this pitch: they stay flat while the heel is up."""
    return np.asarray(-np.maximum(pitch_rad, 0.0))


def sole_of(body: Body, side: str) -> Sole:
    """Measured on the skin."""
    ankle, toes = (smpl.INDEX[f"{side}_{joint}"] for joint in ("ankle", "foot"))
    carried = np.isin(body.model.skin.joints, (ankle, toes)) * body.model.skin.weights
    skin = carried.sum(1) > 0.5
    lever = body.rest_joints_m[toes] - body.rest_joints_m[ankle]
    pitches = np.radians(np.arange(PITCH_DEG[0], PITCH_DEG[1] + _STEP_DEG, _STEP_DEG))
    heel = body.rest_vertices_m[skin][np.argmin(body.rest_vertices_m[skin][:, 0])] - body.rest_joints_m[ankle]
    rows = []
    for pitch in pitches:
        pose = t_pose()
        pose.rotations_rad[ankle, 1], pose.rotations_rad[toes, 1] = pitch, toes_rad(pitch)
        up = body.rest_joints_m[ankle, 2] - body.vertices_m(pose)[skin, 2].min()
        turned = rotations.about(1, pitch)
        # From the footprint to the ankle: back from the ball, or back to the heel's print and up its lever.
        forward = -(turned @ lever)[0] if pitch >= 0 else -lever[0] + heel[0] - (turned @ heel)[0]
        rows.append((forward, up))
    return Sole(pitches, np.array(rows), _under(body, ankle), _under(body, toes))


def _under(body: Body, joint: int) -> Float:
    """(P, 3) the skin that a joint carries more than any other, as far as it can be lowest in some turn: no inner points."""
    skin = body.model.skin
    mine = skin.joints[np.arange(len(skin.joints)), skin.weights.argmax(1)] == joint
    points = body.rest_vertices_m[mine] - body.rest_joints_m[joint]
    around = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    down = np.concatenate(
        [np.stack((np.cos(around) * c, np.sin(around) * c, np.full(16, -1.0)), axis=1) for c in (0.0, 0.5, 1.0, 2.0, 6.0)]
    )
    return np.asarray(points[np.unique((points @ down.T).argmax(0))])
