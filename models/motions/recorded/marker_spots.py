"""Where on the body the markers of usual sets are stuck.

A marker rides on one bone. It is stuck where a ray from within the body, across the bone, leaves the skin; its centre is
a little further out. What a person's own marker differs from that is found by the fit, within the spot's `sigma_m`: landmarks
that are felt through the skin are found to a centimetre or two, clusters on a thigh or forearm are put anywhere.

Sources: Vicon, "Plug-in Gait Reference Guide" (full-body marker set); Uhlrich et al., "OpenCap: Human movement dynamics from
smartphone videos", PLoS Computational Biology 2023 (the markers of its validation). Axes are those of the T-pose.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from models.arrays import Float
from models.body.landmarks import Landmarks
from models.body.model import Body
from models.skeleton import smpl

RADIUS_M: Final = 0.009
"""From the skin to a marker's centre."""
_FELT_M, _ANYWHERE_M = 0.015, 0.05

Vector = tuple[float, float, float]
FRONT, BACK, OUT, UP, DOWN = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)


@dataclass(frozen=True)
class Spot:
    """A place for a marker.

    Attributes:
        bone: joint whose segment carries it.
        near: joint where the ray begins, or
        far: towards which it begins, at
        share: of the way.
        direction: of the ray.
        shift_m: of the ray's beginning, in a body of 1.75 m.
        sigma_m: how far, along each axis, a person's own marker may be from here (standard deviation).
    """

    bone: str
    near: str
    direction: Vector
    shift_m: Vector = (0.0, 0.0, 0.0)
    far: str = ""
    share: float = 0.0
    sigma_m: float = _FELT_M

    def mirrored(self) -> "Spot":
        """The same place on the right."""
        return replace(
            self,
            **{name: getattr(self, name).replace("left_", "right_") for name in ("bone", "near", "far")},
            direction=(self.direction[0], -self.direction[1], self.direction[2]),
            shift_m=(self.shift_m[0], -self.shift_m[1], self.shift_m[2]),
        )


def _cluster(bone: str, far: str, share: float, direction: Vector) -> Spot:
    return Spot(bone, bone, direction, far=far, share=share, sigma_m=_ANYWHERE_M)


_LEFT: Final = {
    "asis": Spot("pelvis", "left_hip", (1, 0.15, 0), (0, 0.01, 0.09)),
    "psis": Spot("pelvis", "pelvis", BACK, (0, 0.045, 0.09)),
    "thigh": _cluster("left_hip", "left_knee", 0.5, (0.4, 1, 0)),
    "knee": Spot("left_hip", "left_knee", OUT),
    "shank": _cluster("left_knee", "left_ankle", 0.5, (0.4, 1, 0)),
    "tuberosity": Spot("left_knee", "left_knee", FRONT, (0, 0, -0.05), sigma_m=0.03),
    "ankle": Spot("left_knee", "left_ankle", OUT),
    "heel": Spot("left_ankle", "left_ankle", (-1, 0, -0.5)),
    "toe": Spot("left_ankle", "left_foot", UP, (-0.025, -0.01, -0.01), sigma_m=0.025),
    "small_toe": Spot("left_ankle", "left_foot", OUT, (-0.02, 0, -0.01)),
    "shoulder": Spot("left_collar", "left_shoulder", UP),
    "sternum": Spot("spine3", "neck", FRONT, (0, 0.03, -0.06), sigma_m=0.025),
    "scapula": Spot("spine3", "spine3", BACK, (0, 0.09, 0.08), sigma_m=_ANYWHERE_M),
    "upper_arm": _cluster("left_shoulder", "left_elbow", 0.5, UP),
    "elbow": Spot("left_shoulder", "left_elbow", UP),
    "elbow_inside": Spot("left_shoulder", "left_elbow", DOWN),
    "forearm": _cluster("left_elbow", "left_wrist", 0.5, UP),
    "wrist_thumb": Spot("left_elbow", "left_wrist", FRONT),
    "wrist_small_finger": Spot("left_elbow", "left_wrist", BACK),
    "finger": Spot("left_wrist", "left_hand", UP, (0.01, -0.015, -0.005), sigma_m=0.025),
    "forehead": Spot("head", "head", (1, 0.7, 0), (0, 0, 0.11), sigma_m=0.03),
    "back_of_head": Spot("head", "head", (-1, 0.7, 0), (0, 0, 0.11), sigma_m=0.03),
}
_MIDDLE: Final = {
    "c7": Spot("spine3", "neck", BACK),
    "t10": Spot("spine2", "spine3", BACK, (0, 0, -0.06), sigma_m=0.03),
    "jugular": Spot("spine3", "neck", FRONT, (0, 0, -0.05), sigma_m=0.025),
    "xiphoid": Spot("spine3", "spine3", FRONT, (0, 0, 0.02), sigma_m=0.03),
}

_OPENCAP: Final = {
    **{name: name for name in ("asis", "psis", "knee", "ankle", "toe", "shoulder", "sternum")},
    **{f"thigh{number}": "thigh" for number in range(1, 6)},
    **{f"sh{number}": "shank" for number in range(2, 5)},
    "shank_antsup": "tuberosity",
    "calc": "heel",
    "5meta": "small_toe",
    "humerus": "upper_arm",
    "forearm": "forearm",
    "elbow_lat": "elbow",
    "elbow_med": "elbow_inside",
    "wrist_radius": "wrist_thumb",
    "wrist_ulna": "wrist_small_finger",
}
"""What follows `L_`, `R_`, `r_`, `L.` or `r.`; the hip joints' centres in these files are computed, not measured."""
_PLUG_IN_GAIT: Final = {
    "ASI": "asis",
    "PSI": "psis",
    "THI": "thigh",
    "KNE": "knee",
    "TIB": "shank",
    "ANK": "ankle",
    "HEE": "heel",
    "TOE": "toe",
    "SHO": "shoulder",
    "BAK": "scapula",
    "UPA": "upper_arm",
    "ELB": "elbow",
    "FRM": "forearm",
    "FIN": "finger",
    "WRA": "wrist_thumb",
    "WRB": "wrist_small_finger",
    "FHD": "forehead",
    "BHD": "back_of_head",
}
"""What follows `L` or `R`."""
_MIDDLE_NAMES: Final = {"C7": "c7", "T10": "t10", "CLAV": "jugular", "STRN": "xiphoid"}


def spot_of(marker: str) -> Spot | None:
    """Where a marker of this name is stuck; None if it is not known."""
    if marker in _MIDDLE_NAMES:
        return _MIDDLE[_MIDDLE_NAMES[marker]]
    side, rest = marker[:1].upper(), marker[1:]
    name = _OPENCAP.get(rest[1:].lower()) if rest[:1] in {"_", "."} else _PLUG_IN_GAIT.get(rest)
    if side not in {"L", "R"} or name is None:
        return None
    return _LEFT[name] if side == "L" else _LEFT[name].mirrored()


def landmarks_of(spots: tuple[Spot, ...], body: Body) -> Landmarks:
    """Each marker as a point of its bone that follows the shape as the skin beneath does.

    Raises:
        ValueError: a ray does not meet the skin.
    """
    bones = np.array([smpl.INDEX[spot.bone] for spot in spots])
    offsets, shapedirs = [], []
    for spot, bone in zip(spots, bones, strict=True):
        corners, weights = _hit(spot, body)
        model = body.model
        outwards = RADIUS_M * np.array(spot.direction) / np.linalg.norm(spot.direction)
        offsets.append(weights @ model.skin.vertices[corners] - model.joints[bone] + outwards)
        shapedirs.append(np.tensordot(weights, model.skin.shapedirs[corners], axes=1) - model.joint_shapedirs[bone])
    count = len(spots)
    return Landmarks(
        starts=np.arange(count + 1),
        joints=bones,
        shares=np.ones(count),
        offsets=np.array(offsets),
        shapedirs=np.array(shapedirs),
        posedirs=np.zeros((count, 3, body.model.skin.posedirs.shape[2])),
    )


def _hit(spot: Spot, body: Body) -> tuple[Float, Float]:
    """Corners of the triangle where the ray first leaves the skin, and their weights there (Moeller and Trumbore 1997)."""
    joints = dict(zip(smpl.NAMES, body.rest_joints_m, strict=True))
    origin = joints[spot.near] + np.array(spot.shift_m) * body.stature_m / 1.75
    if spot.far:
        origin = origin + spot.share * (joints[spot.far] - joints[spot.near])
    direction = np.array(spot.direction) / np.linalg.norm(spot.direction)
    a, b, c = (body.rest_vertices_m[body.model.faces[:, corner]] for corner in range(3))
    across = np.cross(direction, c - a)
    determinant = np.einsum("fi,fi->f", b - a, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("fi,fi->f", origin - a, across) / determinant
        q = np.cross(origin - a, b - a)
        v = q @ direction / determinant
        distance = np.einsum("fi,fi->f", c - a, q) / determinant
    met = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (distance > 0)
    if not met.any():
        raise ValueError(f"from {spot.near} along {spot.direction} there is no skin")
    face = int(np.flatnonzero(met)[np.argmin(distance[met])])
    return body.model.faces[face], np.array((1 - u[face] - v[face], u[face], v[face]))
