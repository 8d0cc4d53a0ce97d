"""Feet on the floor, and bodies in the air: feet that are held neither slide nor sink, a body that flies follows gravity."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import limits_rad
from models.compiled import Counts
from models.motions.figure import Figure
from models.motions.inverse_kinematics import Limb, limb_of
from models.motions.soles import PITCH_DEG, toes_rad
from models.skeleton import smpl

_HALVINGS = 22
_ROUNDS = 8
_SPARE_RAD = np.radians(1.5)
"""How far from its limit an ankle is kept."""


@dataclass(frozen=True, eq=False)
class Footing:
    """How a foot that is held stands.

    Attributes:
        ankles_m: (T, 3).
        pitch_rad: (T,) heel up; see `models.motions.soles`.
        toes_rad: (T,) of the toes against the foot.
    """

    ankles_m: Float
    pitch_rad: Float
    toes_rad: Float


def footing(figure: Figure, side: str, hips_m: Float, places_m: Float, yaw_rad: Float, pitch_rad: Float) -> Footing:
    """Stand a foot on its footprint, and raise its heel as far as the leg is too short, or the ankle too stiff, for a flat foot.

    Args:
        figure: of the subject.
        side: of the foot.
        hips_m: (T, 3) where the leg hangs.
        places_m: (T, 3) footprints; z is how far the sole is off the floor.
        yaw_rad: (T,) to where the toes point.
        pitch_rad: (T,) at least wanted.
    """
    sole, limb = figure.soles[side], limb_of(figure, side, "leg")
    wanted = np.linalg.norm(sole.ankles_at(places_m, yaw_rad, pitch_rad) - hips_m, axis=-1)
    span = limb.soft_span_m(wanted)
    stiff = limits_rad(figure.subject.age_years)[smpl.INDEX[f"{side}_ankle"], 1, 0] + _SPARE_RAD

    def raise_more(pitch: Float, of: Counts) -> Bool:
        to_hip = hips_m[of] - sole.ankles_at(places_m[of], yaw_rad[of], pitch)
        return np.asarray((np.linalg.norm(to_hip, axis=-1) > span[of]) | (_flexion_rad(limb, to_hip, yaw_rad[of]) + pitch < stiff))

    short = np.flatnonzero(raise_more(pitch_rad, np.arange(len(pitch_rad))))
    low, high = pitch_rad[short], np.full(len(short), np.radians(PITCH_DEG[1]))
    for _ in range(_HALVINGS if len(short) else 0):
        middle = (low + high) / 2
        more = raise_more(middle, short)
        low, high = np.where(more, middle, low), np.where(more, high, middle)
    raised = pitch_rad.copy()
    raised[short] = high
    return Footing(sole.ankles_at(places_m, yaw_rad, raised), raised, toes_rad(raised))


def _flexion_rad(limb: Limb, to_hip_m: Float, yaw_rad: Float) -> Float:
    """(T,) turn of the ankle about y that keeps the foot flat under this leg; dorsiflexion is negative."""
    far = np.maximum(np.linalg.norm(to_hip_m, axis=-1), 1e-6)
    thigh, shank = np.linalg.norm(limb.upper_m), np.linalg.norm(limb.lower_m)
    at_ankle = np.arccos(np.clip((shank**2 + far**2 - thigh**2) / (2 * shank * far), -1.0, 1.0))
    forward = to_hip_m[:, 0] * np.cos(yaw_rad) + to_hip_m[:, 1] * np.sin(yaw_rad)
    return np.asarray(-(np.arctan2(forward, to_hip_m[:, 2]) + at_ankle))


def balanced(figure: Figure, wanted_m: Float, local: Float, legs: Callable[[Float, Float], object]) -> Float:
    """Place the pelvis so that the centre of mass is where it is wanted.

    Legs that stand move with the pelvis and shift the centre of mass; so the pelvis is moved by what is amiss, again and again,
    which leaves less than a fifth each time.

    Args:
        figure: of the subject.
        wanted_m: (T, 3) centre of mass.
        local: (T, 24, 3, 3) rotations against the parents.
        legs: turns the legs of `local`, in place, for (T, 3) places of the pelvis.

    Returns:
        (T, 3) of the pelvis.
    """
    pelvis = wanted_m.copy()
    for _ in range(_ROUNDS):
        legs(pelvis, local)
        pelvis = pelvis + wanted_m - figure.centres_of_mass_m(figure.place_local(pelvis, local))
    legs(pelvis, local)
    return pelvis
