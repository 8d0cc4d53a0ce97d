"""Where vertices are while a picture is taken: a polynomial in time for each, so that every row can ask for its own instant."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from edge.simulation.shutter import Shutter
from models.arrays import Float

NODES = np.cos((2 * np.arange(4) + 1) * np.pi / 8)[::-1]
"""Chebyshev's of degree 3: an arm of 0.6 m that turns at 30 rad/s through a picture of 30 ms strays by 0.1 mm."""
_TO_POWERS = np.linalg.inv(np.vander(NODES, increasing=True))
_SHORTEST_S = 1e-6


@dataclass(frozen=True, eq=False)
class Course:
    """Places over s = (t - mid_s) / half_s, from -1 to 1.

    Attributes:
        mid_s: time of the picture.
        half_s: half of the time from the first row's beginning to the last row's end.
        powers: (K, V, 3) world, metres: the sum of powers[k] s^k. K is 1 for what stands still.
    """

    mid_s: float
    half_s: float
    powers: Float

    def at(self, t_s: float) -> Float:
        """(V, 3) places at a time."""
        s = (t_s - self.mid_s) / self.half_s
        return np.asarray(np.polynomial.polynomial.polyval(s, self.powers))


def half_s(shutter: Shutter) -> float:
    """Half of the time that a picture takes."""
    return max((shutter.readout_s + shutter.exposure_s) / 2, _SHORTEST_S)


def course_of(vertices_m: Callable[[float], Float | None], t_s: float, shutter: Shutter) -> Course | None:
    """The course through a picture at `t_s`.

    Args:
        vertices_m: (V, 3) at a time, as `edge.simulation.scene.Actor` has it.
        t_s: time of the picture.
        shutter: how long it takes.

    Returns:
        None if there is nothing at the picture's time. What comes or goes while the picture is taken stands still in it.
    """
    half = half_s(shutter)
    nodes = [vertices_m(t_s + half * float(node)) for node in NODES]
    known = [places for places in nodes if places is not None]
    if len(known) == len(NODES):
        return Course(t_s, half, np.tensordot(_TO_POWERS, np.stack(known), axes=1))
    middle = vertices_m(t_s)
    return None if middle is None else Course(t_s, half, middle[None])
