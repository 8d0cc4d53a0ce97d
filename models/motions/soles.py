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
_TOUCHES_M: Final = 0.005


@dataclass(frozen=True, eq=False)
class Sole:
    """Where the ankle is over the footprint, by pitch, and where the skin is that may touch the floor.

    Attributes:
        pitches_rad: (N,) ascending.
        ankles_m: (N, 2) of the ankle against the footprint of a foot that looks along x: forward and up. The lowest skin is at 0.
        under_m: (2, P, 3) skin that may be lowest, against the ankle and against the toes' joint, in the T-pose.
        shares: (2, P) how much each of these joints carries it.
    """

    pitches_rad: Float
    ankles_m: Float
    under_m: Float
    shares: Float

    def ankle_m(self, pitch_rad: Float) -> tuple[Float, Float]:
        """Forward and up of the ankle against the footprint, at pitches within `PITCH_DEG`."""
        forward, up = (np.interp(pitch_rad, self.pitches_rad, column) for column in self.ankles_m.T)
        return forward, up

    @property
    def heel_m(self) -> float:
        """Forward of where the heel ends that a flat foot stands on, against the footprint: below 0."""
        forward, up = self.ankle_m(np.zeros(1))
        touches = self.shares[0] * (up + self.under_m[0, :, 2]) < _TOUCHES_M
        return float(forward[0] + self.under_m[0, touches, 0].min())

    def lowest_m(self, joints_m: Float, turns: Float) -> Float:
        """(T,) the lowest skin over the floor, for (T, 2, 3) ankles and toes' joints and their (T, 2, 3, 3) turns in the world."""
        heights = joints_m[:, :, 2, None] + np.einsum("tja,jpa->tjp", turns[:, :, 2], self.under_m)
        return np.asarray((self.shares * heights).sum(1).min(1))

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
    under, shares = _under(body, ankle, toes)
    return Sole(pitches, np.array(rows), under, shares)


def _under(body: Body, ankle: int, toes: int) -> tuple[Float, Float]:
    """(2, P, 3) and (2, P) as in `Sole`: the skin that is lowest in some turn of the foot and its toes."""
    skin = body.model.skin
    shares = np.stack([((skin.joints == joint) * skin.weights).sum(1) for joint in (ankle, toes)])
    mine = np.flatnonzero(shares.sum(0) > 0.5)
    shares = shares[:, mine] / shares[:, mine].sum(0)
    points = body.rest_vertices_m[mine] - body.rest_joints_m[[ankle, toes], None]
    lever = body.rest_joints_m[toes] - body.rest_joints_m[ankle]
    lowest: set[int] = set()
    for pitch in np.radians(np.arange(-60, 80, 10)):
        for roll in np.radians((-40, -15, 0, 15, 40)):
            for bend in np.radians((-60, -30, 0, 20)):
                foot = rotations.about(1, pitch) @ rotations.about(0, roll)
                toe = foot @ rotations.about(1, bend)
                heights = shares[0] * (points[0] @ foot[2]) + shares[1] * (lever @ foot[2] + points[1] @ toe[2])
                lowest.add(int(heights.argmin()))
    found = sorted(lowest)
    return points[:, found], shares[:, found]
