"""One epoch of the sources: who is the pupil, and from then on the pupil's estimates.

Nothing of an epoch is known to the next but who the pupil was.
"""

import numpy as np

from models.arrays import Float
from services.fusion.association import Familiar, Hypothesis, PersonSearch
from services.fusion.candidates import Candidates
from services.fusion.config import FusionConfig
from services.fusion.person_estimates import PersonEstimates
from services.fusion.views import Sighting, Views

_CHECK_EVERY = 3
"""Ticks between two triangulations of all joints, and two looks at who else is there."""


class Reconstruction:
    """The state of one epoch.

    Attributes:
        epoch: see `Observation.epoch`.
        pupil: None while nobody is chosen.
        first_s: the oldest observation, inf if none.
        newest_s: (C,) the newest observation of each camera, -inf if none.
    """

    def __init__(self, epoch: int, views: Views, familiar: Familiar = frozenset()) -> None:
        self.epoch = epoch
        self.pupil: PersonEstimates | None = None
        self.first_s = np.inf
        self.newest_s: Float = np.full(len(views), -np.inf)
        self._views = views
        self._candidates = Candidates(len(views))
        self._familiar = familiar
        self._challenged_s = np.inf
        self._ticks = 0

    @property
    def familiar(self) -> Familiar:
        """(camera, track) pairs by which the pupil is or was known."""
        return self.pupil.familiar if self.pupil is not None else self._familiar

    def observe(self, camera: int, t_s: float, persons: tuple[Sighting, ...], config: FusionConfig) -> None:
        """Take in one picture's persons."""
        self.newest_s[camera] = max(self.newest_s[camera], t_s)
        self.first_s = min(self.first_s, t_s)
        for person in persons:
            self._candidates.add(person)
        if self.pupil is not None:
            self.pupil.follow(camera, t_s, persons, config)

    def tick(self, config: FusionConfig) -> None:
        """Choose the pupil, or check the choice and the estimates."""
        now = float(self.newest_s.max())
        if not np.isfinite(now):
            return
        if self.pupil is not None:
            self._ticks += 1
            if self._ticks % _CHECK_EVERY == 0:
                self.pupil.check(now, config)
            if self.pupil.lost:
                self._familiar, self.pupil = self.pupil.familiar, None
            elif self._ticks % _CHECK_EVERY == 0:
                self._challenge(self.pupil, now, config)
        if self.pupil is None:
            self._choose(now, config)

    def searching(self, camera: int, config: FusionConfig) -> bool:
        """Whether a camera should look at everyone."""
        return self.pupil is None or bool(self.pupil.misses[camera] >= config.association.misses_to_search)

    def _choose(self, now: float, config: FusionConfig) -> None:
        best = PersonSearch(self._views, self._candidates, now, config).best(self._familiar)
        if best is None:
            return
        if len(best.slots) == len(self._views) or now - self.first_s >= config.association.patience_s:
            self.pupil = self._begin(best, now, config)

    def _challenge(self, pupil: PersonEstimates, now: float, config: FusionConfig) -> None:
        """Choose anew if somebody elsewhere has been seen by more cameras for long."""
        supporters = pupil.cameras_since(now - config.association.max_age_s)
        if supporters == len(self._views):
            self._challenged_s = np.inf
            return
        best = PersonSearch(self._views, self._candidates, now, config).best(pupil.familiar)
        if best is None or len(best.slots) <= supporters or not self._elsewhere(best, pupil, now, config):
            self._challenged_s = np.inf
            return
        self._challenged_s = min(self._challenged_s, now)
        if now - self._challenged_s >= config.association.challenge_s:
            self.pupil = self._begin(best, now, config)
            self._challenged_s = np.inf

    def _elsewhere(self, person: Hypothesis, pupil: PersonEstimates, now: float, config: FusionConfig) -> bool:
        apart = person.centre_m - pupil.body.at(now)[:3]
        return float(np.linalg.norm(apart)) > 2 * config.association.person_gate_m

    def _begin(self, chosen: Hypothesis, now: float, config: FusionConfig) -> PersonEstimates:
        """Start the estimates as far back as two cameras saw the chosen person, and fuse what was seen since."""
        slots = frozenset(chosen.slots.values())
        seen = self._candidates.since(slots, now - config.association.lookback_s)
        starts = sorted({sighting.camera: sighting.t_s for sighting in reversed(seen)}.values())
        start = starts[1] if len(starts) > 1 else now
        earlier = PersonSearch(self._views, self._candidates, start, config, slots).best(self._familiar)
        if earlier is None:
            start, earlier = now, chosen
        pupil = PersonEstimates(self._views, start, earlier.joints, config)
        for sighting in seen:
            if sighting.t_s >= start:
                pupil.follow(sighting.camera, sighting.t_s, (sighting,), config)
        return pupil
