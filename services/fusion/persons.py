"""Several people at once: each is followed as the pupil is, and no sighting counts for two of them.

In every picture the sightings are shared out among the people known in space, so that the sum of the distances is smallest
(Kuhn 1955, the assignment problem); two people who pass each other thus can't both take the nearer one. What nobody claims is
searched for new people, best agreed upon first.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from models.arrays import Float
from models.compiled import Counts
from services.fusion.association import Hypothesis, PersonSearch, median_distances
from services.fusion.candidates import Candidates
from services.fusion.config import FusionConfig
from services.fusion.joint_filter import Expectation
from services.fusion.person_estimates import PersonEstimates
from services.fusion.views import Sighting, Views

NOBODY: Final = -1


@dataclass(frozen=True, eq=False)
class Known:
    """One of the people.

    Attributes:
        number: never used twice.
        estimates: of him or her.
    """

    number: int
    estimates: PersonEstimates


class Persons:
    """Everyone whom two cameras or more see, within one epoch.

    Attributes:
        people: in the order of their numbers.
    """

    def __init__(self, views: Views) -> None:
        self.people: tuple[Known, ...] = ()
        self._views = views
        self._candidates = Candidates(len(views))
        self._unclaimed: set[int] = set()
        self._next = 0

    def observe(self, camera: int, t_s: float, sightings: tuple[Sighting, ...], config: FusionConfig) -> Counts:
        """Take in one picture's persons; returns the number of the person that each is (n,), `NOBODY` for none."""
        expected = [known.estimates.expect(camera, t_s) for known in self.people]
        shares = share_out(sightings, expected, config.association.person_gate_m)
        for sighting, share in zip(sightings, shares, strict=True):
            slot = self._candidates.add(sighting)
            (self._unclaimed.add if share == NOBODY else self._unclaimed.discard)(slot)
        for index, known in enumerate(self.people):
            own = tuple(sighting for sighting, share in zip(sightings, shares, strict=True) if share == index)
            known.estimates.follow(camera, t_s, own, config)
        return np.array([NOBODY if share == NOBODY else self.people[share].number for share in shares], np.int64)

    def tick(self, t_s: float, config: FusionConfig) -> None:
        """Check the estimates, forget who is gone, and take in who is new at an instant."""
        for known in self.people:
            known.estimates.check(t_s, config)
        self.people = tuple(known for known in self.people if not known.estimates.lost)
        search = PersonSearch(self._views, self._candidates, t_s, config, self._unclaimed)
        for found in search.everyone():
            self._unclaimed.difference_update(found.slots.values())
            if not any(_same(found, known, t_s, config) for known in self.people):
                self.people += (Known(self._next, PersonEstimates(self._views, t_s, found.joints, config)),)
                self._next += 1


def _same(found: Hypothesis, known: Known, t_s: float, config: FusionConfig) -> bool:
    """Whether somebody found is somebody known, made of sightings from before he or she was known."""
    joints_m, alive = known.estimates.skeleton(t_s)
    common = alive & (found.joints.count >= 2)
    apart = np.linalg.norm(joints_m[common] - found.joints.points_m[common], axis=1)
    return bool(common.any() and np.median(apart) < config.association.person_gate_m)


def share_out(sightings: tuple[Sighting, ...], expected: list[Expectation], gate_m: float) -> Counts:
    """Which of the expected people each sighting of one picture is (n,), `NOBODY` for none: the nearest, each person once."""
    shares = np.full(len(sightings), NOBODY, np.int64)
    if not sightings or not expected:
        return shares
    distances: Float = np.stack([median_distances(sightings, person, gate_m) for person in expected], axis=1)
    # What is beyond the gate costs so much that no share within it is given up for it.
    cost = np.where(distances < gate_m, distances, 1e3 * gate_m)
    for sighting, person in zip(*linear_sum_assignment(cost), strict=True):
        if distances[sighting, person] < gate_m:
            shares[sighting] = person
    return shares
