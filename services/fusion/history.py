"""The joint filters over the last observations, so that one which arrives late is still fused at its own time.

Four cameras share two cores: an observation may overtake another that is 50 ms older. The late one is put in its place and
the filters run again from there, which costs microseconds.
"""

from dataclasses import dataclass, field

from models.arrays import Bool, Float
from services.fusion.config import FilterConfig
from services.fusion.joint_filter import Innovation, JointFilter
from services.fusion.views import Sighting, Views


@dataclass(frozen=True, eq=False)
class Seed:
    """A joint started anew at a position (3,) with covariance (3, 3), or given up if there is no position."""

    joint: int
    point_m: Float | None
    covariance_m2: Float | None


@dataclass(eq=False)
class _Step:
    t_s: float
    sighting: Sighting | None
    seeds: tuple[Seed, ...]
    exchanged: Bool | None = None
    after: JointFilter = field(init=False)


class FilterHistory:
    """The joint filters after each of the last events, in order of time."""

    def __init__(self, t_s: float, views: Views, config: FilterConfig) -> None:
        self._views = views
        self._config = config
        self._before = JointFilter(t_s)
        self._steps: list[_Step] = []

    @property
    def newest(self) -> JointFilter:
        """The filters after the newest event; not to be changed."""
        return self._steps[-1].after if self._steps else self._before

    def at(self, t_s: float) -> JointFilter:
        """A copy of the filters as the events up to `t_s` leave them, predicted to `t_s`."""
        found = self._before
        for step in reversed(self._steps):
            if step.t_s <= t_s:
                found = step.after
                break
        copy = found.copy()
        copy.advance(t_s, self._config)
        return copy

    def seed(self, t_s: float, seeds: tuple[Seed, ...]) -> None:
        """Start joints anew, or give them up, at a time within the history."""
        self._insert(_Step(t_s, None, seeds))

    def exchange(self, mask: Bool) -> None:
        """Exchange left and right of the flagged joints (17,) from the newest event on."""
        self._insert(_Step(self.newest.t_s, None, (), mask))

    def observe(self, sighting: Sighting, predicted: JointFilter) -> Innovation | None:
        """Fuse a sighting at its own time; None if it is older than the history.

        `predicted` is what `at` gave for that time; it is taken over.
        """
        return self._insert(_Step(sighting.t_s, sighting, ()), predicted)

    def _insert(self, step: _Step, predicted: JointFilter | None = None) -> Innovation | None:
        if step.t_s < self._before.t_s:
            return None
        place = len(self._steps)
        while place and self._steps[place - 1].t_s > step.t_s:
            place -= 1
        self._steps.insert(place, step)
        innovation = self._run(place, predicted)
        for later in range(place + 1, len(self._steps)):
            self._run(later)
        if len(self._steps) > self._config.history:
            self._before = self._steps.pop(0).after
        return innovation

    def _run(self, place: int, predicted: JointFilter | None = None) -> Innovation | None:
        step = self._steps[place]
        if predicted is None:
            predicted = (self._steps[place - 1].after if place else self._before).copy()
            predicted.advance(step.t_s, self._config)
        step.after = predicted
        for seed in step.seeds:
            if seed.point_m is None or seed.covariance_m2 is None:
                step.after.alive[seed.joint] = False
            else:
                step.after.seed(seed.joint, seed.point_m, seed.covariance_m2, self._config)
        if step.exchanged is not None:
            step.after.exchange(step.exchanged)
        if step.sighting is None:
            return None
        projection = self._views.projections[step.sighting.camera]
        return step.after.update(projection, step.sighting.points_px, step.sighting.sigma_px, step.sighting.usable, self._config)
