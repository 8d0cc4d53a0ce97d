"""Flight: how long, how fast, how high. SI units; up is positive."""

from typing import Final

import numpy as np

from models.arrays import Float

GRAVITY_M_S2: Final = 9.81


def airborne_s(height_m: float, drop_m: float = 0.0) -> float:
    """Time in the air of a jump that lifts the centre of mass by `height_m` over where it was at take-off.

    Args:
        height_m: above the take-off's.
        drop_m: how much lower the centre of mass is at landing than at take-off; must be above `-height_m`.
    """
    return float(np.sqrt(2 * height_m / GRAVITY_M_S2) + np.sqrt(2 * (height_m + drop_m) / GRAVITY_M_S2))


def take_off_m_s(airborne: float, rise_m: float = 0.0) -> float:
    """Upward velocity for so many seconds in the air, landing `rise_m` higher than the take-off."""
    return rise_m / airborne + GRAVITY_M_S2 * airborne / 2


def push_off_s(rise_m: float, take_off: float) -> float:
    """How long a body takes from rest to the take-off's velocity while it rises by `rise_m`, pushing evenly; also how long a
    landing takes from that velocity to rest."""
    return 2 * rise_m / take_off


def thrown(place_m: Float, velocity_m_s: Float, times_s: Float) -> Float:
    """(T, 3) of something thrown at time zero from (3,) with (3,) m/s, without drag; before zero, of what arrives there so."""
    fall = np.array((0.0, 0.0, -GRAVITY_M_S2 / 2))
    return np.asarray(place_m + times_s[:, None] * velocity_m_s + times_s[:, None] ** 2 * fall)


def throw_to(place_m: Float, target_m: Float, up_deg: float) -> Float:
    """(3,) m/s of something that is thrown so many degrees above the horizontal, and hits the target.

    Raises:
        ValueError: at this angle it cannot.
    """
    way = target_m - place_m
    far = float(np.hypot(way[0], way[1]))
    slope = np.tan(np.radians(up_deg))
    drop = far * slope - way[2]
    if far <= 0 or drop <= 0:
        raise ValueError(f"nothing thrown at {up_deg:g} degrees reaches a point {far:g} m away and {way[2]:g} m up")
    level = far * np.sqrt(GRAVITY_M_S2 / (2 * drop))
    return np.array((*(way[:2] / far * level), level * slope))
