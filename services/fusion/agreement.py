"""Whether the cameras see what the calibration says: exchanged plugs, a wrong file or a camera that was knocked.

Two cameras that see one person see each joint on the other's epipolar line, whoever is the pupil and wherever he is. So each
pair is judged by itself, by the distances from those lines over some seconds, as a share of the body's size in the picture
(measured on the built-in footage: 1 % with the right calibration, 3 to 40 % with two cameras exchanged). Two agree if most
distances are small, and disagree if hardly any is: for a while each may have looked at somebody else, which is no fault. Cameras
outside the largest group of pairs that agree are named, and whether exchanging two of them would make all agree.
"""

import statistics
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from models.messages.observation import Observation
from models.messages.trouble import Trouble
from services.fusion.config import SightingConfig
from services.fusion.epipolar import Couples, fundamentals
from services.fusion.views import Sighting, Views, sightings

TOLERANCE = 0.03
"""Of the body's size; at 1.7 m about 5 cm."""
PERIOD_S = 0.25
"""A pair is compared no more often."""
NEEDED, KEPT = 24, 40
"""Comparisons before a pair is said to agree; and before it is said not to, which accuses somebody: those that it is judged by."""
_AT_IT_S = 10.0
"""A pair that has not been compared `KEPT` times, but was within so long, soon will have been, and is waited for."""
_MAX_GAP_S = 0.35


class _Comparisons:
    """The newest comparisons of two cameras: of each, the couple that fits best."""

    def __init__(self) -> None:
        self.distances: deque[float] = deque(maxlen=KEPT)
        self._couples: Couples | None = None

    def add(self, couple: Couples, distance: float) -> None:
        """One more."""
        self.distances.append(distance)
        self._couples = couple if self._couples is None else self._couples.and_then(couple, KEPT)

    def agree(self) -> bool | None:
        """Whether the two cameras do; None as long as there is too little to tell, or if they do only now and then."""
        if len(self.distances) < NEEDED:
            return None
        if statistics.median(self.distances) < TOLERANCE:
            return True
        accused = len(self.distances) == KEPT and statistics.quantiles(self.distances, n=10)[0] >= TOLERANCE
        return False if accused else None

    def would_agree(self, fundamental: Float) -> bool:
        """Whether they would if that were their fundamental matrix."""
        return self._couples is not None and float(np.median(self._couples.distances(fundamental))) < TOLERANCE


@dataclass(frozen=True)
class Disagreement:
    """Cameras that do not agree with the calibration.

    Attributes:
        strangers: those outside the largest group of cameras that agree; all if no group is the largest.
        exchanged: each two whose exchange would make every pair agree; in a symmetric room there may be more than one.
        contradictory: whether it cannot be told who is right.
    """

    strangers: tuple[str, ...]
    exchanged: tuple[tuple[str, str], ...]
    contradictory: bool

    @property
    def trouble(self) -> Trouble:
        """What people are told of it."""
        if self.exchanged:
            pairs = ", or ".join(f"{a} and {b}" for a, b in self.exchanged)
            remedy = "exchange their plugs, or their files in the site file"
            return Trouble("cameras_exchanged", f"{pairs} seem to be exchanged", remedy)
        names = ", ".join(self.strangers)
        if self.contradictory:
            words = f"{names} do not agree with one another about where people are"
            return Trouble("cameras_disagree", words, "calibrate anew, or correct which camera is which")
        verb = "does" if len(self.strangers) == 1 else "do"
        remedy = "move back what was moved, calibrate anew, or correct which camera is which"
        return Trouble("camera_moved", f"{names} {verb} not agree with the calibration", remedy)


class Agreement:
    """Takes every observation, compares now and then, and tells when asked."""

    def __init__(self, rig: Rig, config: SightingConfig) -> None:
        self._views = Views.of(rig)
        self._fundamentals = fundamentals(self._views)
        self._config = config
        self._newest: list[deque[tuple[float, tuple[Sighting, ...]]]] = [deque(maxlen=2) for _ in rig]
        self._epochs = [0] * len(self._views)
        # When the newest pictures of a pair were looked at, and when somebody was in both of them who could be compared.
        self._looked_s: dict[tuple[int, int], float] = {}
        self._compared_s: dict[tuple[int, int], float] = {}
        self._compared = {pair: _Comparisons() for pair in combinations(range(len(self._views)), 2)}

    def observe(self, observation: Observation) -> None:
        """Compare a picture with those of the other cameras that were taken since this camera's last one."""
        camera, t_s = self._views.index[observation.camera], observation.t_mid_ns * 1e-9
        track = self._newest[camera]
        if observation.epoch != self._epochs[camera]:
            self._epochs[camera] = observation.epoch
            track.clear()
        if track and t_s <= track[-1][0]:
            return
        track.append((t_s, sightings(observation, self._views, self._config)))
        if len(track) < 2 or t_s - track[0][0] > _MAX_GAP_S:
            return
        for other, theirs in enumerate(self._newest):
            pair = min(camera, other), max(camera, other)
            if other == camera or not theirs or self._epochs[other] != observation.epoch:
                continue
            if not track[0][0] <= theirs[-1][0] <= t_s:
                continue
            looked_s = theirs[-1][0]
            if looked_s - self._looked_s.get(pair, -np.inf) >= PERIOD_S:
                self._looked_s[pair] = looked_s
                if self._compare(pair, theirs[-1][1], self._at(looked_s, camera), swapped=other > camera):
                    self._compared_s[pair] = looked_s

    def judge(self) -> Disagreement | None:
        """Who does not agree; None while all do, or as long as it cannot be told."""
        judged = {pair: agree for pair, seen in self._compared.items() if (agree := seen.agree()) is not None}
        groups = _groups({camera for pair in judged for camera in pair}, [pair for pair, agree in judged.items() if agree])
        # Cameras that were not compared with one another do not contradict one another.
        apart = [pair for pair, agree in judged.items() if not agree]
        groups = [group for group in groups if any((a in group) != (b in group) for a, b in apart)]
        if len(groups) < 2 or self._is_at_it(groups, judged):
            return None
        *smaller, largest = sorted(groups, key=len)
        tied = len(smaller[-1]) == len(largest)
        strangers = sorted(camera for group in groups for camera in group if tied or group is not largest)
        exchanged = [two for two in combinations(strangers, 2) if self._would_agree(*two, judged)]
        names = self._views.rig.names
        return Disagreement(tuple(names[i] for i in strangers), tuple((names[a], names[b]) for a, b in exchanged), tied)

    def _is_at_it(self, groups: list[set[int]], judged: Mapping[tuple[int, int], bool]) -> bool:
        """Whether two groups are being compared by a pair that is yet to be judged, and may turn out to be one.

        Of a pair that was compared often enough, and agrees only now and then, no more is to be expected: a camera that was turned
        can fit beside one other for as long as the pupil stands where he does.
        """
        group_of = {camera: number for number, group in enumerate(groups) for camera in group}
        newest_s = max(self._looked_s.values())
        return any(
            pair not in judged
            and len(self._compared[pair].distances) < KEPT
            and newest_s - t_s < _AT_IT_S
            and len({group_of.get(camera) for camera in pair} - {None}) == 2
            for pair, t_s in self._compared_s.items()
        )

    def _at(self, t_s: float, camera: int) -> list[Sighting]:
        """The persons of a camera at an instant between its two newest pictures, whom it tracked in both."""
        (before_s, before), (after_s, after) = self._newest[camera]
        share, earlier = (t_s - before_s) / (after_s - before_s), {person.track: person for person in before}
        return [
            Sighting(
                camera,
                person.track,
                t_s,
                (1 - share) * earlier[person.track].points_px + share * person.points_px,
                person.sigma_px,
                earlier[person.track].usable & person.usable,
            )
            for person in after
            if person.track in earlier
        ]

    def _compare(self, pair: tuple[int, int], theirs: Sequence[Sighting], own: Sequence[Sighting], *, swapped: bool) -> bool:
        """Keep the pair of persons who fit best; whether there is any pair that can be compared."""
        couples = Couples.of(own, theirs) if swapped else Couples.of(theirs, own)
        if couples is None:
            return False
        distances = couples.distances(self._fundamentals[pair])
        best = int(np.argmin(distances))
        self._compared[pair].add(couples.one(best), float(distances[best]))
        return True

    def _would_agree(self, a: int, b: int, judged: Mapping[tuple[int, int], bool]) -> bool:
        """Whether all pairs would agree if the pictures of two cameras were exchanged; keypoints keep their undistortion."""
        touched = [pair for pair in judged if a in pair or b in pair]
        if not all(agrees for pair, agrees in judged.items() if pair not in touched):
            return False
        other = {a: b, b: a}
        return all(
            self._compared[pair].would_agree(self._fundamentals[other.get(pair[0], pair[0]), other.get(pair[1], pair[1])])
            for pair in touched
        )


def _groups(cameras: set[int], agreeing: list[tuple[int, int]]) -> list[set[int]]:
    """Cameras that are joined by pairs that agree."""
    groups = [{camera} for camera in sorted(cameras)]
    for a, b in agreeing:
        joined = [group for group in groups if a in group or b in group]
        groups = [group for group in groups if group not in joined] + [set().union(*joined)]
    return groups
