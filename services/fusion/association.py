"""Who among the persons of all pictures is the pupil.

Persons of two cameras who are one person triangulate to a body of human size whose projections fall on both; every other
camera's nearest person then joins. More cameras that agree win: a bystander at the edge of the room stands in two pictures and is
consistent in both. Among equals, the person nearer to where the cameras look, and larger, is the pupil.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.compiled import Counts, compiled
from models.skeleton import coco
from services.fusion.candidates import PERSONS, Candidates
from services.fusion.config import FusionConfig
from services.fusion.joint_filter import Expectation
from services.fusion.pairing import disagreements
from services.fusion.swap import repair
from services.fusion.triangulation import Triangulated, triangulate
from services.fusion.views import Sighting, Views

_MIRROR: Final = np.array(coco.MIRROR)
_MIN_JOINTS: Final = 6
_AGREEING: Final = 0.6
_LIMB_M: Final = (0.08, 0.75)
_TORSO_M: Final = (0.15, 1.0)
_SWAP_COST: Final = 0.25
_FAMILIAR: Final = 0.75
_NEAR_M: Final = 2.0


Familiar = frozenset[tuple[int, int]]
"""(camera index, track number) pairs by which a person is known."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """One person in space.

    Attributes:
        slots: which candidate of each camera it is, by camera index.
        joints: the joints at the instant of the search.
        score: number of cameras, less for exchanged sides, more for nearness and familiarity; higher is better.
    """

    slots: dict[int, int]
    joints: Triangulated
    score: float

    @property
    def centre_m(self) -> Float:
        """(3,) median of its joints."""
        centre: Float = np.nanmedian(self.joints.points_m, axis=0)
        return centre


def pick_pupil(persons: tuple[Sighting, ...], expected: Expectation, gate_m: float) -> Sighting | None:
    """The person of one picture who is where the pupil is expected; None if nobody is.

    Compared is the median distance, sides ignored, of keypoints from where they are expected; the expectation's own uncertainty
    widens the gate, to twice at most.
    """
    if not persons:
        return None
    distances = median_distances(persons, expected, gate_m)
    nearest = int(np.argmin(distances))
    return persons[nearest] if distances[nearest] < gate_m else None


def median_distances(persons: tuple[Sighting, ...], expected: Expectation, gate_m: float) -> Float:
    """(n,) distances in metres as `pick_pupil` compares them; infinite where too little can be compared."""
    known = expected.points_px, expected.variance_px2, expected.px_per_m, expected.known
    return np.array([median_distance(person.points_px, person.usable, *known, _MIRROR, gate_m) for person in persons])


@compiled
def median_distance(
    points: Float, usable: Bool, expected: Float, variance: Float, px_per_m: Float, known: Bool, mirror: Counts, allowance: float
) -> float:
    """Median distance in metres less the median uncertainty, at most `allowance`; infinite if too few can be compared."""
    distances, sigmas, count = np.empty(points.shape[0]), np.empty(points.shape[0]), 0
    for j in range(points.shape[0]):
        if not known[j]:
            continue
        nearest2 = np.inf
        for seen in (j, mirror[j]):
            if usable[seen]:
                nearest2 = min(nearest2, (points[seen, 0] - expected[j, 0]) ** 2 + (points[seen, 1] - expected[j, 1]) ** 2)
        if nearest2 < np.inf:
            distances[count] = np.sqrt(nearest2) / px_per_m[j]
            sigmas[count] = np.sqrt(variance[j]) / px_per_m[j]
            count += 1
    if count < _MIN_JOINTS:
        return np.inf
    distance: float = np.median(distances[:count]) - min(np.median(sigmas[:count]), allowance)
    return distance


@compiled
def agreement(points: Float, sigma: Float, usable: Bool, expected: Float, variance: Float, known: Bool, gate: float) -> float:
    """Share of a person's keypoints within `gate` squared sigmas of where they are expected; 1 if none can be compared."""
    count, agreeing = 0, 0
    for j in range(points.shape[0]):
        if usable[j] and known[j]:
            distance2 = (points[j, 0] - expected[j, 0]) ** 2 + (points[j, 1] - expected[j, 1]) ** 2
            count += 1
            agreeing += distance2 <= gate * (sigma[j] ** 2 + variance[j])
    return agreeing / count if count else 1.0


class PersonSearch:
    """Finds the persons in space that the candidates of all cameras at one instant can be."""

    def __init__(
        self, views: Views, candidates: Candidates, t_s: float, config: FusionConfig, only: Collection[int] | None = None
    ) -> None:
        """Search at time `t_s`, among all candidates or only among some slots."""
        self._views = views
        self._config = config
        points, sigma, usable = candidates.tracks.at(t_s, config.timing)
        slots = candidates.live(t_s, config.association.max_age_s)
        self._persons: dict[int, list[int]] = {}
        self._sightings: dict[int, Sighting] = {}
        for slot in slots:
            if usable[slot].sum() < _MIN_JOINTS or (only is not None and slot not in only):
                continue
            camera, track = candidates.identity(slot)
            seen = points[slot][usable[slot]]
            size = float(np.linalg.norm(seen.max(axis=0) - seen.min(axis=0)))
            forgiving = np.hypot(sigma[slot], config.association.slack * size)
            self._sightings[slot] = Sighting(camera, track, t_s, points[slot], forgiving, usable[slot])
            self._persons.setdefault(camera, []).append(slot)
        self._focus = _focus(views)

    def best(self, familiar: Familiar) -> Hypothesis | None:
        """The likeliest pupil, people who were the pupil before the seam or the loss being preferred."""
        found: list[Hypothesis] = []
        settled: set[int] = set()
        tried = 0
        for a, b in self._pairs():
            if a in settled or b in settled or any({a, b} <= set(hypothesis.slots.values()) for hypothesis in found):
                continue
            if tried == self._config.association.max_hypotheses:
                break
            tried += 1
            hypothesis = self._grow(a, b, familiar)
            if hypothesis is not None:
                found.append(hypothesis)
                # Most cameras don't agree by chance: whoever they agree on is nobody else.
                if len(hypothesis.slots) > max(2, len(self._persons) / 2):
                    settled.update(hypothesis.slots.values())
        return max(found, key=lambda hypothesis: hypothesis.score, default=None)

    def _pairs(self) -> list[tuple[int, int]]:
        """Pairs of slots of two cameras that may be one person, those first that agree best."""
        slots = sorted(slot for slots in self._persons.values() for slot in slots)
        persons = [self._sightings[slot] for slot in slots]
        costs = disagreements(self._views, persons, _MIN_JOINTS, _AGREEING, self._config.triangulation)
        first, second = np.nonzero(np.triu(np.isfinite(costs)))
        order = np.argsort(costs[first, second], kind="stable")
        return [(slots[first[i]], slots[second[i]]) for i in order]

    def everyone(self) -> Iterator[Hypothesis]:
        """One person after the other, the likeliest first; no candidate is of two of them."""
        while (found := self.best(frozenset())) is not None:
            yield found
            for camera, slot in found.slots.items():
                self._persons[camera].remove(slot)

    def _grow(self, a: int, b: int, familiar: Familiar) -> Hypothesis | None:
        members = {self._sightings[a].camera: self._sightings[a], self._sightings[b].camera: self._sightings[b]}
        slots = {slot // PERSONS: slot for slot in (a, b)}
        joints = self._triangulate(members)
        comparable = (self._sightings[a].usable & self._sightings[b].usable).sum()
        if (joints.count >= 2).sum() < max(_MIN_JOINTS, _AGREEING * comparable):
            return None
        if not _is_human(joints.points_m, joints.count >= 2):
            return None
        swaps = 0
        for camera, persons in self._persons.items():
            if camera in slots:
                continue
            expected = _expect(self._views.projections[camera], joints)
            chosen = pick_pupil(tuple(self._sightings[slot] for slot in persons), expected, self._config.association.person_gate_m)
            if chosen is not None:
                slots[camera] = next(slot for slot in persons if self._sightings[slot] is chosen)
                members[camera], swapped = repair(chosen, expected)
                swaps += bool(swapped[list(coco.TRUNK)].any())
        joints = self._triangulate(members)
        known = sum((camera, person.track) in familiar for camera, person in members.items()) / len(members)
        centre = np.nanmedian(joints.points_m, axis=0)
        nearness = 1.0 / (1.0 + float(np.sum((centre - self._focus)[:2] ** 2)) / _NEAR_M**2)
        size = float(np.mean([self._size(slot) for slot in slots.values()]))
        score = len(slots) - _SWAP_COST * swaps + _FAMILIAR * known + 0.5 * nearness + 0.2 * min(size, 1.0)
        return Hypothesis(slots, joints, score)

    def _triangulate(self, members: dict[int, Sighting]) -> Triangulated:
        cameras = len(self._views)
        points, sigma = np.zeros((cameras, coco.COUNT, 2)), np.ones((cameras, coco.COUNT))
        usable = np.zeros((cameras, coco.COUNT), np.bool_)
        for camera, person in members.items():
            points[camera], sigma[camera], usable[camera] = person.points_px, person.sigma_px, person.usable
        return triangulate(self._views, points, sigma, usable, self._config.triangulation)

    def _size(self, slot: int) -> float:
        person = self._sightings[slot]
        seen = person.points_px[person.usable]
        return float(np.ptp(seen[:, 1])) / self._views.rig.cameras[person.camera].size_px[1]


def _expect(projection: Float, joints: Triangulated) -> Expectation:
    known = (joints.count >= 2) & np.isfinite(joints.points_m[:, 0])
    seen = np.where(known[:, None], joints.points_m, 0.0) @ projection[:, :3].T + projection[:, 3]
    depth = np.where(known & (seen[:, 2] > 1e-6), seen[:, 2], 1.0)
    scale = np.linalg.norm(projection[0, :3]) / depth
    variance = np.trace(joints.covariance_m2, axis1=1, axis2=2) / 3 * scale**2
    return Expectation(seen[:, :2] / depth[:, None], variance, scale, known & (seen[:, 2] > 1e-6))


def _is_human(points_m: Float, known: Bool) -> bool:
    """Whether most measurable limbs and the torso have the size of a child's or an adult's."""
    spans = [(a, b, _LIMB_M) for a, b in coco.LIMBS.values()]
    left_shoulder, right_shoulder, left_hip, right_hip = coco.TRUNK
    spans += [(left_shoulder, left_hip, _TORSO_M), (right_shoulder, right_hip, _TORSO_M)]
    checks = [low <= np.linalg.norm(points_m[a] - points_m[b]) <= high for a, b, (low, high) in spans if known[a] and known[b]]
    return len(checks) >= 3 and sum(map(bool, checks)) >= 0.75 * len(checks)


def _focus(views: Views) -> Float:
    """(3,) the point nearest to all optical axes: where the cameras look."""
    axes = np.stack([camera.rotation[2] for camera in views.rig])
    away = np.eye(3) - axes[:, :, None] * axes[:, None, :]
    point: Float = np.linalg.lstsq(away.sum(axis=0), np.einsum("cij,cj->i", away, views.centres_m), rcond=None)[0]
    return point
