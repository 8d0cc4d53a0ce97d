"""OpenSim's .mot: coordinates of the full-body model of Rajagopal et al. over time, as far as 17 points determine them.

Model: Rajagopal et al., "Full-body musculoskeletal model for muscle-driven simulation of human gait", IEEE Trans. Biomedical Eng.
63(10), 2016. A body's axes are front (x), up (y), right (z); all joints with three angles turn about z, then x, then y.

- The pelvis has the line of the hips as its right, and lies in the direction of the trunk: where the spine bends between the two
  was not seen. So there is no `lumbar_extension`, and none of ankle, foot, forearm and hand.
- An upper arm's and a thigh's turn about themselves shows in the plane in which the limb bends. While it is straighter than
  `STRAIGHT_DEG`, the last turn that was seen is held.
- What is unknown in a frame is held; a coordinate that is known in no frame is left out.
"""

from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions.rotations import through
from models.skeleton import coco
from services.lesson.export.axes import OPENSIM
from services.lesson.export.directions import complete, pair, unit
from services.lesson.export.holding import held
from services.lesson.export.rows import rows
from services.lesson.export.take import Take, TakeError
from services.lesson.export.zxy import zxy_deg

SUFFIX = ".mot"
STRAIGHT_DEG: Final = 15.0
HIP_IN_PELVIS: Final = np.array((-0.05628, -0.07849, 0.07726))
"""Where the model's right hip is in its pelvis, metres; the pupil's is larger or smaller as the distance of his hips is."""

Coordinates = dict[str, tuple[Float, Bool]]
"""Name: (T,) values in degrees or metres, complete, and (T,) where they are held."""


def encode(take: Take) -> bytes:
    """The file. Angles in degrees, positions in metres.

    Raises:
        TakeError: both hips and both shoulders are nowhere known at once.
    """
    found = coordinates(take)
    table = np.column_stack((take.seconds, *(values for values, _ in found.values())))
    head = ["Coordinates", "version=1", f"nRows={len(table)}", f"nColumns={len(found) + 1}", "inDegrees=yes", "endheader"]
    return ("\n".join((*head, "\t".join(("time", *found)), *rows(table, 6, "\t"))) + "\n").encode()


def coordinates(take: Take) -> Coordinates:
    """What the file holds, in its order. Raises as `encode` does."""
    point = {name: OPENSIM.to(take.joints_m[:, index]) for index, name in enumerate(coco.NAMES)}
    hips, shoulders = ((point[f"left_{part}"] + point[f"right_{part}"]) / 2 for part in ("hip", "shoulder"))
    right_hips, right_shoulders = (point[f"right_{part}"] - point[f"left_{part}"] for part in ("hip", "shoulder"))
    pelvis = _pelvis_axes(right_hips, shoulders - hips)
    torso = _torso_axes(shoulders - hips, right_shoulders)
    if not complete(pelvis).any():
        raise TakeError("has no frame in which both hips and both shoulders are known, without which there is no pelvis")
    found: Coordinates = {}
    _add_angles(found, pelvis, ("pelvis_tilt", "pelvis_list", "pelvis_rotation"))
    width = np.linalg.norm(right_hips, axis=1)
    scale = float(np.median(width[np.isfinite(width)])) / (2 * float(HIP_IN_PELVIS[2]))
    origin = hips - through(pelvis, scale * HIP_IN_PELVIS * (1, 1, 0))
    for axis, name in enumerate(("pelvis_tx", "pelvis_ty", "pelvis_tz")):
        _add(found, name, origin[:, axis])
    _add_angles(found, pelvis.swapaxes(1, 2) @ torso, ("", "lumbar_bending", "lumbar_rotation"))
    for side, mirror in (("right", 1.0), ("left", -1.0)):
        limbs = (
            ("hip", "knee", "ankle", ("hip_flexion", "hip_adduction", "hip_rotation"), "knee_angle", pelvis, -1.0),
            ("shoulder", "elbow", "wrist", ("arm_flex", "arm_add", "arm_rot"), "elbow_flex", torso, 1.0),
        )
        for near, middle, far, names, bend, carrier, forwards in limbs:
            first, second = (point[f"{side}_{b}"] - point[f"{side}_{a}"] for a, b in ((near, middle), (middle, far)))
            labels = tuple(f"{name}_{side[0]}" for name in names)
            _add_limb(found, carrier, (first, second), labels, f"{bend}_{side[0]}", mirror=mirror, forwards=forwards)
    return found


def _add_limb(
    found: Coordinates,
    carrier: Float,
    segments: tuple[Float, Float],
    names: tuple[str, ...],
    bend_name: str,
    *,
    mirror: float,
    forwards: float,
) -> None:
    """The angles of a limb.

    Args:
        found: where they go.
        carrier: (T, 3, 3) axes of what the limb hangs on.
        segments: (T, 3) along its first and its second segment.
        names: of the first segment's angles.
        bend_name: of the angle between the two.
        mirror: -1 for the left, where the model's second and third angle count the other way round.
        forwards: 1 if the limb bends to its front, as an elbow does, -1 to its back.
    """
    first, second = (unit(segment) for segment in segments)
    bend = np.rad2deg(np.arctan2(np.linalg.norm(np.cross(first, second), axis=1), np.sum(first * second, axis=1)))
    # Where the first segment points needs no elbow or knee.
    x, y, z = through(carrier.swapaxes(1, 2), first).T
    pointing = np.rad2deg((np.arctan2(x, -y), mirror * np.arctan2(-z, np.hypot(x, y))))
    for name, values in zip(names, pointing, strict=False):
        _add(found, name, values, turning=True)
    bent = np.where((bend > STRAIGHT_DEG)[:, None, None], _bent_axes(-first, forwards * second), np.nan)
    _add_angles(found, carrier.swapaxes(1, 2) @ bent, ("", "", names[2]), mirror)
    _add(found, bend_name, bend)


def _add_angles(found: Coordinates, turns: Float, names: tuple[str, str, str], mirror: float = 1.0) -> None:
    """Those of the three angles of (T, 3, 3) that have a name."""
    known = complete(turns)
    if known.any():
        angles = zxy_deg(held(turns, known)) * (1.0, mirror, mirror)
        found.update({name: (angles[:, index], ~known) for index, name in enumerate(names) if name})


def _add(found: Coordinates, name: str, values: Float, *, turning: bool = False) -> None:
    """One coordinate. One that turns goes on over half a turn rather than jump by a whole one."""
    known = np.isfinite(values)
    if known.any():
        whole = held(values, known)
        found[name] = (np.unwrap(whole, period=360.0) if turning else whole, ~known)


def _pelvis_axes(right: Float, up: Float) -> Float:
    """(T, 3, 3) with exactly this right, and up as near as can be."""
    z, y = pair(right, up)
    return np.stack((np.cross(y, z), y, z), axis=-1)


def _torso_axes(up: Float, right: Float) -> Float:
    """(T, 3, 3) with exactly this up, and right as near as can be."""
    y, z = pair(up, right)
    return np.stack((np.cross(y, z), y, z), axis=-1)


def _bent_axes(up: Float, front: Float) -> Float:
    """(T, 3, 3) with exactly this up, and front as near as can be."""
    y, x = pair(up, front)
    return np.stack((x, y, np.cross(x, y)), axis=-1)
