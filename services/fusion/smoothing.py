"""The smoother: positions on the output grid, from every picture at its own time.

Eq. 8 penalises differences of positions and has no data term. Here a window of positions of each joint, one every 1/30 s,
minimises

    sum over pictures  rho( |z - projection(X(t))|^2 / sigma^2 )  +  sum |D^n X|^2 / s^2  +  sum (|X - Y| - L)^2 / q^2

where X(t) is cubic interpolation between the positions around the picture's own time t, D^n the n-th difference, and the last
term holds the distance to the joint Y at the limb's other end near the limb's length L (eq. 16, with q from what is known of Y).
One reweighted Gauss-Newton step a tick is a banded solution, linear in the window's length, of all joints at once: Y is where the
step before left it. A position is stepped on in every tick that it is in the window, so it is read out after at least seven.
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float, UInt32
from models.skeleton import coco
from services.fusion.banded import inverse_blocks, solve_banded
from services.fusion.config import SmoothingConfig
from services.fusion.limbs import ENDS, LimbLengths
from services.fusion.readout import read_window
from services.fusion.timing import Tracks
from services.fusion.views import Views
from services.fusion.window import BAND, assemble

_NO_CERTAINTY_M2 = 1e6 * np.eye(3)


class Equations:
    """Room for the normal equations, used anew in every step: `window.py` and `banded.py` say what is in it."""

    def __init__(self, knots: int, joints: int) -> None:
        self._blocks: Float = np.empty((knots, 4, 6, joints))
        self._penalty: Float = np.empty((knots, 4, joints))
        self.matrix: Float = np.empty((3 * knots, BAND, joints))
        self.pivots: Float = np.empty((3 * knots, joints))
        self.solution: Float = np.empty((knots, 3, joints))

    @property
    def arrays(self) -> tuple[Float, Float, Float, Float]:
        """What `assemble` fills."""
        return self._blocks, self._penalty, self.matrix, self.solution

    def solve(self) -> None:
        """Turn the right side into the solution."""
        solve_banded(self.matrix, self.solution.reshape(self.pivots.shape), self.pivots)


@dataclass(frozen=True, eq=False)
class Smoothed:
    """Joints at n instants.

    Attributes:
        points_m: (n, 17, 3).
        covariance_m2: (n, 17, 3, 3).
        views: (n, 17) bit i set if camera i agrees, near that instant.
    """

    points_m: Float
    covariance_m2: Float
    views: UInt32


class Smoother:
    """The window of one epoch.

    Attributes:
        first: grid index of the oldest position; position k is at (first + k) * frame_s.
        positions_m: (knots, 3, 17).
        covariance_m2: (17, 3, 3) of the first position read out last time; the neighbours' limb terms are weighed by it.
        known: (17, knots) whether a position holds anything.
    """

    def __init__(self, first: int, frame_s: float, config: SmoothingConfig) -> None:
        self.first = first
        self._frame_s = frame_s
        self._config = config
        self.positions_m: Float = np.zeros((config.knots, 3, coco.COUNT))
        self.covariance_m2: Float = np.tile(np.eye(3) * 0.02**2, (coco.COUNT, 1, 1))
        self.known: Bool = np.zeros((coco.COUNT, config.knots), np.bool_)
        self._strength: Float = 1.0 / config.difference_m**2
        self._bend: Float = 1.0 / config.bend_m**2
        self._equations = Equations(config.knots, coco.COUNT)

    @property
    def last(self) -> int:
        """Grid index of the newest position."""
        return self.first + self._config.knots - 1

    def extend(self) -> None:
        """Move on by one instant."""
        self.first += 1
        self.positions_m[:-1] = self.positions_m[1:]
        self.known[:, :-1] = self.known[:, 1:]

    def foresee(self, index: int, points_m: Float, known: Bool) -> None:
        """Take grid instant `index`, which pictures do not hold yet, to be at these (17, 3) where `known` (17,)."""
        knot = index - self.first
        np.copyto(self.positions_m[knot], points_m.T, where=known)
        self.known[:, knot] |= known

    def at(self, index: int) -> Float:
        """(17, 3) where the joints are taken to be at a grid instant within the window."""
        positions: Float = self.positions_m[index - self.first].T.copy()
        return positions

    def velocities_m_s(self, instants_s: Float) -> Float:
        """(n, 17, 3) at n instants, by the positions before and after each; beyond the window, as at its end."""
        knots = np.rint(instants_s / self._frame_s).astype(np.int64) - self.first
        middle = np.clip(knots, 1, self._config.knots - 2)
        way: Float = (self.positions_m[middle + 1] - self.positions_m[middle - 1]).swapaxes(1, 2)
        return way / (2 * self._frame_s)

    def move(self, index: int, points_m: Float, which: Bool) -> None:
        """Take the flagged joints (17,) to be at these (17, 3) at a grid instant within the window."""
        np.copyto(self.positions_m[index - self.first], points_m.T, where=which)

    def restart(self, joint: int, t_s: float, point_m: Float) -> None:
        """Take a joint to have been at a position (3,) from `t_s` on, and wherever it was unknown."""
        instants = (self.first + np.arange(self._config.knots)) * self._frame_s
        anew = (instants >= t_s) | ~self.known[joint]
        self.positions_m[anew, :, joint] = point_m
        self.known[joint] = True

    def exchange(self, mask: Bool, since_s: float) -> None:
        """Exchange left and right of the flagged joints (17,) from an instant on."""
        order = np.where(mask, coco.MIRROR, np.arange(coco.COUNT))
        from_knot = max(int(np.ceil(since_s / self._frame_s)) - self.first, 0)
        self.positions_m[from_knot:] = self.positions_m[from_knot:, :, order]

    def step(self, tracks: Tracks, views: Views, limbs: LimbLengths, instants_s: Float, memories_s: Float) -> Smoothed:
        """Improve all positions, and read out n instants (n,), naming views that agree within `memories_s` (n,) of each.

        An instant before the window has no view and no certainty.
        """
        config, equations = self._config, self._equations
        start_s, frame_s = self.first * self._frame_s, self._frame_s
        held = max(tracks.newest_s(slot) for slot in range(len(views))) / frame_s - self.first
        seen = tracks.times_s, tracks.counts, tracks.points_px, tracks.sigma_px, tracks.usable
        pictures = start_s, frame_s, views.projections, *seen
        differences = config.order, self._strength, config.difference_freedom, self._bend, config.robust_sigmas**2
        bones = ENDS, *limbs.current(), self.covariance_m2
        alive: Bool = np.logical_or.reduce(self.known, axis=1)
        for _ in range(config.iterations):
            assemble(self.positions_m, self.known, *pictures, *differences, *bones, held, *equations.arrays)
            equations.solve()
            np.copyto(self.positions_m, equations.solution, where=alive)
        self.known |= alive[:, None]
        # The later of the two positions around an instant is the less certain one.
        later = np.ceil(instants_s / frame_s - self.first - 1e-6).astype(np.int64)
        covariance = inverse_blocks(equations.matrix, equations.pivots, 3 * np.clip(later, 0, config.knots - 1))
        self.covariance_m2 = covariance[0]
        points, views_seen = read_window(self.positions_m, alive, *pictures, held, config.carry_s / frame_s, instants_s, memories_s)
        before = later < 0
        points[before], covariance[before], views_seen[before] = 0.0, _NO_CERTAINTY_M2, 0
        return Smoothed(points, covariance, views_seen)
