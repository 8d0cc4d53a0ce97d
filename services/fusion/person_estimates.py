"""One person who is followed: every picture of him or her is fused here, and asked for here at any instant."""

import numpy as np

from models.arrays import Bool, Float, UInt32
from models.compiled import Counts
from models.messages.motion import JointState
from models.skeleton import coco
from services.fusion.association import Familiar, agreement, pick_pupil
from services.fusion.between_looks import gaps_s, unsure_m2
from services.fusion.body_filter import BodyFilter, centre_in_picture
from services.fusion.config import FusionConfig
from services.fusion.doubles import single
from services.fusion.history import FilterHistory, Seed
from services.fusion.joint_filter import Expectation
from services.fusion.limbs import ENDS, LimbLengths
from services.fusion.recapture import recapture
from services.fusion.singer import separations2
from services.fusion.smoothing import Smoother
from services.fusion.swap import repair
from services.fusion.timing import Tracks
from services.fusion.triangulation import Triangulated, triangulate
from services.fusion.verdict import Pose, judge_joints
from services.fusion.views import Sighting, Views

_TRUNK = np.array(coco.TRUNK)
_TRACK_DEPTH = 32
_REACH_M = 1.3
"""No joint is further from the body's centre."""
_SEED_SIGMA_M = 0.02
"""Added to a seed's sigma, for what triangulation at an interpolated instant does not know of."""
_STALE_S = 0.2


class PersonEstimates:
    """Estimates of one person within one epoch.

    Attributes:
        since_s: the instant from which on there are estimates.
        misses: (C,) consecutive observations in which the person was not found.
        body: the filter of the body's centre.
    """

    def __init__(self, views: Views, t_s: float, joints: Triangulated, config: FusionConfig) -> None:
        self.since_s = t_s
        self.misses: Counts = np.zeros(len(views), np.int64)
        self.body = BodyFilter(t_s, np.nanmedian(joints.points_m, axis=0))
        self._views = views
        self._identities: dict[int, int] = {}
        self._tracks = Tracks(len(views), _TRACK_DEPTH)
        self._filters = FilterHistory(t_s, views, config.filter)
        self._limbs = LimbLengths(config.smoothing)
        self._agreed_s: Float = np.full((len(views), coco.COUNT), -np.inf)
        self._repaired = [False] * len(views)
        self._swapped: Bool = np.zeros((len(views), coco.COUNT), np.bool_)
        self._doubted_s: Float = np.full(coco.COUNT, np.inf)
        self._disagreements: Counts = np.zeros(coco.COUNT, np.int64)
        self._smooth_agreed_s: Float = np.full(coco.COUNT, -np.inf)
        self._live_agreed_s: Float = np.full(coco.COUNT, -np.inf)
        last = int(np.ceil(t_s / config.frame_s)) + 1
        self._smoother = Smoother(last - config.smoothing.knots + 1, config.frame_s, config.smoothing)
        self._seed(t_s, joints, np.flatnonzero(joints.count >= 2))

    @property
    def familiar(self) -> Familiar:
        """(camera, track) pairs by which the person was last known."""
        return frozenset(self._identities.items())

    @property
    def lost(self) -> bool:
        """Whether no joint is estimated any more."""
        return not self._filters.newest.alive.any()

    def cameras_since(self, t_s: float) -> int:
        """How many cameras have seen the person since then."""
        return sum(self._tracks.newest_s(camera) >= t_s for camera in range(len(self._views)))

    def expect(self, camera: int, t_s: float) -> Expectation:
        """The joints as a camera should see them at an instant."""
        return self._filters.at(t_s).expect(self._views.projections[camera])

    def follow(self, camera: int, t_s: float, persons: tuple[Sighting, ...], config: FusionConfig) -> None:
        """Find the person in one picture and fuse it at the picture's own time."""
        projection = self._views.projections[camera]
        predicted = self._filters.at(t_s)
        expected = predicted.expect(projection)
        found = pick_pupil(persons, expected, config.association.person_gate_m)
        if found is None:
            self.misses[camera] += 1
            return
        sighting, swapped = repair(found, expected)
        if self._outvoted(camera, sighting, expected, config):
            return  # no miss: the camera looks at the right place, where somebody else stands before the person
        self.misses[camera] = 0
        self._identities[camera] = found.track
        repaired = sighting is not found
        sighting = single(sighting, expected, config.sighting.doubled)
        if not self._tracks.add(camera, sighting):
            return
        innovation = self._filters.observe(sighting, predicted)
        if innovation is not None:
            agreed = self._agreed_s[camera]
            agreed[innovation.used & (agreed < t_s)] = t_s
        if repaired or self._repaired[camera]:
            self._doubt_sides(camera, t_s, swapped)
        self._repaired[camera] = repaired
        self._see_body(t_s, projection, sighting, expected)

    def _outvoted(self, camera: int, sighting: Sighting, expected: Expectation, config: FusionConfig) -> bool:
        """Whether two other cameras see the person where this one sees, for the most part, somebody else."""
        seen = sighting.points_px, sighting.sigma_px, sighting.usable
        gate = config.filter.hard_gate
        if agreement(*seen, expected.points_px, expected.variance_px2, expected.known, gate) >= config.association.min_agreement:
            return False
        recent_s = sighting.t_s - config.filter.view_memory_s
        return sum(self._tracks.newest_s(other) >= recent_s for other in range(len(self._views)) if other != camera) >= 2

    def _see_body(self, t_s: float, projection: Float, sighting: Sighting, expected: Expectation) -> None:
        """Measure the body's centre."""
        seen = sighting.points_px, sighting.sigma_px, sighting.usable
        u, v, sigma_px = centre_in_picture(*seen, expected.points_px, expected.known, _TRUNK)
        if sigma_px < np.inf:
            self.body.observe(t_s, projection, np.array((u, v)), sigma_px)

    def check(self, now_s: float, config: FusionConfig) -> None:
        """Hold the filters against triangulation at the newest instant that all cameras reach, and give up what nobody sees.

        `now_s` is when the newest picture was taken, whether the person is in it or not.
        """
        fresh = self._fresh_s()
        if not len(fresh):
            return
        self._give_up(now_s, config)
        if now_s - fresh.max() > _longest_s(config):
            return
        instant = max(float(fresh.min()), self.since_s)
        filters = self._filters.at(instant)
        points, sigma, usable = self._tracks.at(instant, config.timing)
        prior = np.where(filters.alive[:, None], filters.state[:, :3], np.nan)
        found = triangulate(self._views, points, sigma, usable, config.triangulation, prior)
        near = np.linalg.norm(found.points_m - self.body.at(instant)[:3], axis=1) < _REACH_M
        self._limbs.learn(found.points_m, found.covariance_m2, (found.count >= 2) & near)
        distance2 = separations2(found.points_m, found.covariance_m2, filters.state, filters.covariance)
        supporters = (self._agreed_s >= instant - config.filter.view_memory_s).sum(axis=0)
        better = near & (found.count >= 2) & (found.count >= supporters)
        against = better & filters.alive & (distance2 > config.filter.reseed_gate)
        self._disagreements = np.where(against, self._disagreements + 1, 0)
        anew = (better & ~filters.alive) | (self._disagreements >= config.filter.reseed_after)
        if anew.any():
            self._seed(instant, found, np.flatnonzero(anew))
            self._disagreements[anew] = 0

    def skeleton(self, t_s: float) -> tuple[Float, Bool]:
        """Joints (17, 3) expected at an instant, and which are known (17,), for a rough use such as a crop."""
        filters = self._filters.at(t_s)
        return filters.state[:, :3], filters.alive

    def poses(self, now_s: float, live_s: float, grid: range, config: FusionConfig) -> tuple[Pose, list[Pose]]:
        """The pose at a live instant, and those at grid instants, from everything seen until `now_s`.

        The window's end is newer than the newest picture; what it says there is its own extrapolation.
        """
        self._reach(now_s, config)
        self._recapture(config)
        instants_s = np.append(np.array(grid) * config.frame_s, live_s)
        memory_s = config.filter.view_memory_s
        memories = np.append(np.full(len(grid), 0.5 * memory_s), memory_s)
        smoothed = self._smoother.step(self._tracks, self._views, self._limbs, instants_s, memories)
        *smooth, live = (
            self._pose(t, points, covariance, unsure, views, last, config)
            for t, points, covariance, unsure, views, last in zip(
                instants_s,
                smoothed.points_m,
                smoothed.covariance_m2,
                self._between_looks_m2(instants_s, config),
                smoothed.views,
                (*[self._smooth_agreed_s] * len(grid), self._live_agreed_s),
                strict=True,
            )
        )
        return live, smooth

    def _between_looks_m2(self, instants_s: Float, config: FusionConfig) -> Float:
        """(n, 17, 3, 3) how unsure joints are at n instants because of what happened between the looks."""
        newest_s = max(self._tracks.newest_s(camera) for camera in range(len(self._views)))
        gaps = gaps_s(self._tracks, self._smoother.first * config.frame_s, newest_s)
        return unsure_m2(self._smoother.velocities_m_s(instants_s), config.smoothing.between_looks * gaps)

    def _reach(self, now_s: float, config: FusionConfig) -> None:
        """Move the window on until its end is beyond `now_s`, and let the filters foresee what no picture holds yet."""
        end = int(np.floor(now_s / config.frame_s)) + 1
        for _ in range(min(end - self._smoother.last, config.smoothing.knots)):
            self._smoother.extend()
        held = int(np.floor(self._filters.newest.t_s / config.frame_s))
        ahead = self._filters.newest.copy()
        for index in range(max(held, self._smoother.first), self._smoother.last + 1):
            if index == held:
                past = self._filters.at(index * config.frame_s)
                self._smoother.foresee(index, past.state[:, :3], past.alive)
                continue
            ahead.advance(index * config.frame_s, config.filter)
            self._smoother.foresee(index, ahead.state[:, :3], ahead.alive)

    def _recapture(self, config: FusionConfig) -> None:
        """Catch what the smoother lost, at the instants between the slowest camera's newest picture and the fastest one's."""
        fresh = self._fresh_s()
        if not len(fresh):
            return
        oldest, newest = (int(np.floor(t_s / config.frame_s)) for t_s in (fresh.min(), fresh.max()))
        for index in range(max(oldest, self._smoother.first), min(newest, self._smoother.last) + 1):
            centre_m = self.body.at(index * config.frame_s)[:3]
            recapture(self._smoother, index, self._tracks, self._views, centre_m, _REACH_M, config)

    def _fresh_s(self) -> Float:
        """(n,) when each of the cameras that still see the person did last."""
        newest = np.array([self._tracks.newest_s(camera) for camera in range(len(self._views))])
        fresh: Float = newest[np.isfinite(newest) & (newest >= newest.max() - _STALE_S)]
        return fresh

    def _pose(
        self,
        t_s: float,
        points_m: Float,
        covariance_m2: Float,
        between_m2: Float,
        views: UInt32,
        agreed_s: Float,
        config: FusionConfig,
    ) -> Pose:
        """States from how many views agree now, and from when two last did (`agreed_s`, kept up to date here).

        That a joint moves makes it less sure (`between_m2`), and not less seen.
        """
        # Before the first estimate nothing is known, however sure the window's end is.
        guess_s = config.filter.guess_s + 1e-9 if t_s >= self.since_s - config.frame_s else -np.inf
        lengths_m, _ = self._limbs.current()
        max_variance_m2 = config.filter.max_sigma_m**2
        pose = Pose(*judge_joints(points_m, covariance_m2, views, agreed_s, t_s, guess_s, max_variance_m2, ENDS, lengths_m))
        known = pose.states != JointState.UNKNOWN
        pose.covariance_m2[known] += between_m2[known]
        return pose

    def _doubt_sides(self, camera: int, t_s: float, swapped: Bool) -> None:
        """If most cameras keep having to be repaired, it is the estimate whose left is right."""
        self._swapped[camera] = swapped
        fresh = [c for c in range(len(self._views)) if self._tracks.newest_s(c) >= t_s - _STALE_S]
        most = 2 * self._swapped[fresh].sum(axis=0) > len(fresh)
        self._doubted_s = np.where(most, np.minimum(self._doubted_s, t_s), np.inf)
        wrong = t_s - self._doubted_s > _STALE_S
        if wrong.any():
            since_s = float(self._doubted_s[wrong].min())
            self._tracks.exchange(wrong, since_s)
            self._smoother.exchange(wrong, since_s)
            self._filters.exchange(wrong)
            self._swapped[:, wrong] = False
            self._doubted_s[wrong] = np.inf

    def _seed(self, t_s: float, joints: Triangulated, which: Counts) -> None:
        doubt = np.eye(3) * _SEED_SIGMA_M**2
        self._filters.seed(t_s, tuple(Seed(int(j), joints.points_m[j], joints.covariance_m2[j] + doubt) for j in which))
        since_s = self._second_newest()
        for joint in which:
            agreed = ((int(joints.inliers[joint]) >> np.arange(len(self._views))) & 1).astype(np.bool_)
            self._smoother.restart(int(joint), float(since_s[joint]), joints.points_m[joint])
            self._agreed_s[agreed, joint] = np.maximum(self._agreed_s[agreed, joint], t_s)

    def _give_up(self, t_s: float, config: FusionConfig) -> None:
        gone = self._filters.newest.alive & (t_s - self._second_newest() > _longest_s(config))
        if gone.any():
            self._filters.seed(t_s, tuple(Seed(int(joint), None, None) for joint in np.flatnonzero(gone)))

    def _second_newest(self) -> Float:
        """(17,) when the second of two views last agreed with a joint."""
        newest: Float = np.sort(self._agreed_s, axis=0)[-2]
        return newest


def _longest_s(config: FusionConfig) -> float:
    """How long a joint is carried on after two views last agreed on it."""
    return config.filter.view_memory_s + config.filter.guess_s
