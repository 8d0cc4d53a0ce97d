"""From the world of KineBox (right-handed, z up) to those of programs in which y is up, and back. Turns, no mirrors.

Who looks along our x looks along x in OpenSim's world and along z in that of BVH and glTF, as each has it for its own figures. The
same maps take a body's axes (front, left, up) to (front, up, right), and to (left, up, front).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float


@dataclass(frozen=True)
class World:
    """Another program's axes, as rows: each in ours."""

    rows: tuple[tuple[int, int, int], tuple[int, int, int], tuple[int, int, int]]

    @property
    def turn(self) -> Float:
        """(3, 3) from our axes into the program's."""
        return np.array(self.rows, np.float64)

    def to(self, points: Float) -> Float:
        """(..., 3) points or directions of ours, in the program's axes."""
        return np.asarray(points @ self.turn.T + 0.0)

    def back(self, points: Float) -> Float:
        """The inverse of `to`."""
        return np.asarray(points @ self.turn + 0.0)

    def turns_to(self, turns: Float) -> Float:
        """(..., 3, 3) rotations of ours, between the program's axes."""
        return np.asarray(self.turn @ turns @ self.turn.T)


OURS: Final = World(((1, 0, 0), (0, 1, 0), (0, 0, 1)))
"""Also C3D's."""
OPENSIM: Final = World(((1, 0, 0), (0, 0, 1), (0, -1, 0)))
"""x forward, y up, z to the right: TRC and .mot."""
FIGURES: Final = World(((0, 1, 0), (0, 0, 1), (1, 0, 0)))
"""x to the figure's left, y up, z forward: BVH and glTF."""
