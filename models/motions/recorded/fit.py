"""Fits a body to recorded markers: its shape, where its markers are stuck, and its pose in each frame.

Levenberg-Marquardt with the analytic Jacobian of the body's landmarks throughout:
1. every frame for itself, begun with the last one's pose, the markers where the set has them;
2. some frames spread over the recording together: shape, the markers' displacements and those frames' poses at once (the
   normal equations, with the poses eliminated: Schur's complement);
3. every frame again, with that shape and those markers.

What markers do not tell (fingers, toes, how the spine shares a bend, the head where it carries none) is held by a weak prior of
the pose, at rest; no joint may turn beyond `models.body.limits`. The idea, of markers found along with the body that carries them,
is that of Loper et al., "MoSh: Motion and Shape Capture from Sparse Markers", ACM Trans. Graphics 33(6), 2014.
"""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.landmarks import Landmarks
from models.body.limits import excess_rad, limits_rad
from models.body.model import Body, BodyModel
from models.body.pose import PARAMETERS, Pose, from_vector
from models.body.prior import Likely
from models.errors import UserError
from models.motions.recorded.marker_spots import landmarks_of, spot_of
from models.motions.recorded.markers import Markers
from models.motions.rotations import vectors as rotation_vectors
from models.skeleton import smpl

FEWEST_MARKERS: Final = 12
_NOISE_M: Final = 0.004
"""What a marker moves on the skin while its bone does not, standard deviation."""
_NOISE_TOGETHER_M: Final = 0.012
"""The same for the frames that tell the shape: soft tissue moves alike in many frames, which is no proof that a limb is thin."""
_LIMIT_SIGMA_RAD: Final = 0.1
_FROM_LAST_FRAME_RAD: Final = 0.35
_TOGETHER: Final = 24
"""Frames from which the shape is found."""
_STEPS, _STEPS_TOGETHER = 40, 15
_ANOTHER_START: Final = 0.05
"""Metres or radians by which a neighbour's pose must differ to be worth a try of its own."""
_OUTLIER: Final = 5.0
"""Standard deviations from which on a marker is believed less and less (Cauchy's loss): some are swapped or torn off."""
_SMALLEST_STEP: Final = 1e-4
_TRUNK: Final = frozenset({"pelvis", "spine1", "spine2", "spine3", "left_collar", "right_collar"})
_GROWN_UP_YEARS: Final = 20.0


def _pose_sigmas_rad() -> Float:
    """(24, 3) how far a joint is from rest, usually; the pelvis is free."""
    usual = {"shoulder": 2.0, "elbow": 2.0, "hip": 2.0, "knee": 2.0, "ankle": 0.6, "foot": 0.1, "wrist": 0.4, "hand": 0.1}
    sigmas = [usual.get(name.split("_")[-1], 0.25) for name in smpl.NAMES]
    return np.repeat(np.array([np.inf, *sigmas[1:]]), 3).reshape(smpl.COUNT, 3)


def _standing() -> Float:
    """(24, 3) the pose to begin with: arms hang, elbows and knees are a little bent, so that a step tells which way they bend."""
    rotations = np.zeros((smpl.COUNT, 3))
    for name, turn in {"left_shoulder": (-1.2, 0, 0), "left_elbow": (0, 0, -0.3), "left_hip": (0, -0.1, 0)}.items():
        rotations[smpl.INDEX[name]] = turn
        rotations[smpl.INDEX[name.replace("left", "right")]] = np.array(turn) * (-1, 1, -1)
    rotations[[smpl.INDEX["left_knee"], smpl.INDEX["right_knee"]], 1] = 0.2
    return rotations


@dataclass(frozen=True, eq=False)
class MarkerFit:
    """What was found.

    Attributes:
        body: the person.
        rate_hz: of the recording.
        names: (M,) the markers that were used, in the recording's order.
        landmarks: the same markers on the body.
        poses: (T, 75) `Pose.vector` of each frame of the recording.
        errors_m: (T, M) distances of the body's markers from the recorded ones; NaN where a marker was not seen.
    """

    body: Body
    rate_hz: float
    names: tuple[str, ...]
    landmarks: Landmarks
    poses: Float
    errors_m: Float

    @property
    def residual_mm(self) -> float:
        """Root mean square of `errors_m`, in millimetres."""
        return float(np.sqrt(np.nanmean(self.errors_m**2)) * 1000)


def fit(markers: Markers, model: BodyModel, likely: Likely) -> MarkerFit:
    """Fit a body to a recording.

    Args:
        markers: the recording; names that `spot_of` does not know are left out.
        model: family of bodies.
        likely: which shapes to expect of the person.

    Raises:
        UserError: fewer than `FEWEST_MARKERS` known markers, or none of the trunk's in the first frame.
    """
    spots = {name: spot for name in markers.names if (spot := spot_of(name)) is not None}
    if len(spots) < FEWEST_MARKERS:
        raise UserError(
            f"{len(spots)} of the markers {', '.join(markers.names)} are known, needed are {FEWEST_MARKERS}; "
            "name them as OpenCap's or the Plug-in Gait set does"
        )
    used = [markers.names.index(name) for name in spots]
    observed = markers.filled()[:, used]
    body = model.shaped(likely.mean)
    spread = np.array([spot.sigma_m for spot in spots.values()])
    landmarks = landmarks_of(tuple(spots.values()), body)
    poses = _every_frame(body, landmarks, observed, np.hypot(_NOISE_M, spread))
    chosen = np.unique(np.linspace(0, len(observed) - 1, _TOGETHER).astype(int))
    problem = _Together(likely, landmarks, spread, observed[chosen])
    body, landmarks = problem.solve(model, poses[chosen])
    poses = _every_frame_again(body, landmarks, observed, poses)
    placed = np.array([body.landmarks_m(from_vector(pose), landmarks) for pose in poses])
    return MarkerFit(
        body, markers.rate_hz, tuple(spots), landmarks, poses, np.linalg.norm(placed - markers.positions_m[:, used], axis=-1)
    )


def _every_frame(body: Body, landmarks: Landmarks, observed: Float, sigmas: Float) -> Float:
    """(T, 75) poses, each begun with the last frame's."""
    last = _begin(body, landmarks, observed[0])
    last = _one_frame(body, landmarks, _Terms(observed[0], sigmas, None), last)[1]
    poses = np.empty((len(observed), PARAMETERS))
    for frame, points in enumerate(observed):
        poses[frame] = last = _one_frame(body, landmarks, _Terms(points, sigmas, last), last)[1]
    return poses


def _every_frame_again(body: Body, landmarks: Landmarks, observed: Float, poses: Float) -> Float:
    """(T, 75) poses: each the better of two, one found from its neighbour's and one from the pose already known.

    Forwards, then backwards, so that an arm that fell into a wrong valley is led out of it from one side or the other.
    """
    sigmas = np.full(len(landmarks), _NOISE_M)
    out, last = poses.copy(), poses[0]
    for order in (range(len(observed)), range(len(observed) - 1, -1, -1)):
        for frame in order:
            terms = _Terms(observed[frame], sigmas, last)
            starts = (out[frame], last) if np.abs(out[frame] - last).max() > _ANOTHER_START else (out[frame],)
            found = [_one_frame(body, landmarks, terms, start) for start in starts]
            out[frame] = last = min(found, key=lambda one: one[0])[1]
    return out


def _one_frame(body: Body, landmarks: Landmarks, terms: "_Terms", start: Float) -> tuple[float, Float]:
    """Cost, and (75,) the pose that puts the landmarks to the points."""
    vector, damping = start, 1e-3
    cost, gradient, hessian = terms.at(body, landmarks, vector)[:3]
    for _ in range(_STEPS):
        step = -np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), gradient)
        tried = terms.at(body, landmarks, vector + step)
        if tried[0] <= cost:
            vector, damping = vector + step, max(damping / 5, 1e-8)
            cost, gradient, hessian = tried[:3]
            if np.abs(step).max() < _SMALLEST_STEP:
                break
        else:
            damping *= 10
    return cost, _wrapped(vector)


class _Terms:
    """The sum of squares of one frame: markers, limits of the joints, the pose at rest, the last frame."""

    _LIMITS: Final = limits_rad(_GROWN_UP_YEARS)
    _REST: Final = 1 / _pose_sigmas_rad() ** 2

    def __init__(self, points: Float, sigmas: Float, near: Float | None) -> None:
        seen = _seen(points)
        self._points = np.where(seen[:, None], points, 0.0)
        self._weights = np.where(seen, 1 / sigmas, 0.0)
        self._near = near

    def at(self, body: Body, landmarks: Landmarks, vector: Float) -> tuple[float, Float, Float, Float, Float, Float]:
        """Half the cost, its gradient and (Gauss-Newton's) second derivative by the pose; then (M, 3) residuals of the markers
        and (M, 3, 75 + S) their Jacobian, both weighted, and (M, 3, 3) how a landmark moves with its displacement, weighted."""
        pose = from_vector(vector)
        placed, jacobian = body.landmarks_jacobian(pose, landmarks)
        residuals = (placed - self._points) * self._weights[:, None]
        surprise = np.sum(residuals**2, axis=1) / _OUTLIER**2
        cost = float(_OUTLIER**2 * np.log1p(surprise).sum()) / 2
        belief = self._weights / np.sqrt(1 + surprise)
        residuals = residuals / np.sqrt(1 + surprise)[:, None]
        jacobian = jacobian * belief[:, None, None]
        by_pose = jacobian[..., :PARAMETERS].reshape(-1, PARAMETERS)
        gradient = by_pose.T @ residuals.ravel()
        hessian = by_pose.T @ by_pose
        excess = excess_rad(pose.rotations_rad, self._LIMITS)
        excess[0] = 0.0
        pulls = [(excess, (excess != 0) / _LIMIT_SIGMA_RAD**2), (pose.rotations_rad, self._REST)]
        if self._near is not None:
            away = pose.rotations_rad - from_vector(self._near).rotations_rad
            away[0] = 0.0
            pulls.append((away, np.full(away.shape, 1 / _FROM_LAST_FRAME_RAD**2)))
        for difference, weight in pulls:
            cost += float((weight * difference**2).sum()) / 2
            gradient[3:] += (weight * difference).ravel()
            hessian[np.arange(3, PARAMETERS), np.arange(3, PARAMETERS)] += weight.ravel()
        turned = body.orientations(pose)[landmarks.joints] * belief[:, None, None]
        return cost, gradient, hessian, residuals, jacobian, turned


class _Together:
    """Shape, displacements of the markers and poses of some frames at once."""

    def __init__(self, likely: Likely, landmarks: Landmarks, spread: Float, observed: Float) -> None:
        self._likely = likely
        self._precision = np.linalg.inv(likely.covariance)
        self._landmarks = landmarks
        self._loose = 1 / np.repeat(spread, 3) ** 2
        sigmas = np.full(len(landmarks), _NOISE_TOGETHER_M)
        self._frames = [_Terms(points, sigmas, None) for points in observed]

    def solve(self, model: BodyModel, poses: Float) -> tuple[Body, Landmarks]:
        """The body and its markers, begun with the mean of what is likely, no displacement, and these (F, 75) poses."""
        shape, moved, damping = self._likely.mean, np.zeros(3 * len(self._landmarks)), 1e-3
        cost, steps = self._step(model, shape, moved, poses, damping)
        for _ in range(_STEPS_TOGETHER):
            tried = (shape + steps[0], moved + steps[1], poses + steps[2])
            new_cost, new_steps = self._step(model, *tried, damping / 5)
            if new_cost <= cost:
                (shape, moved, poses), cost, steps, damping = tried, new_cost, new_steps, damping / 5
            else:
                damping *= 10
                steps = self._step(model, shape, moved, poses, damping)[1]
        return model.shaped(shape), self._displaced(moved)

    def _displaced(self, moved: Float) -> Landmarks:
        return replace(self._landmarks, offsets=self._landmarks.offsets + moved.reshape(-1, 3))

    def _step(self, model: BodyModel, shape: Float, moved: Float, poses: Float, damping: float) -> tuple[float, list[Float]]:
        """Half the cost here, and the steps of shape, displacements and poses."""
        body, landmarks, coefficients = model.shaped(shape), self._displaced(moved), len(shape)
        from_mean = shape - self._likely.mean
        cost = float(from_mean @ self._precision @ from_mean + moved @ (self._loose * moved)) / 2
        gradient = np.concatenate((self._precision @ from_mean, self._loose * moved))
        hessian = np.diag(np.concatenate((np.zeros(coefficients), self._loose)))
        hessian[:coefficients, :coefficients] = self._precision
        eliminated = []
        for frame, vector in zip(self._frames, poses, strict=True):
            own_cost, own_gradient, own_hessian, residuals, jacobian, turned = frame.at(body, landmarks, vector)
            by_pose = jacobian[..., :PARAMETERS].reshape(-1, PARAMETERS)
            marks = np.zeros((len(residuals), 3, len(gradient)))
            marks[..., :coefficients] = jacobian[..., PARAMETERS:]
            for marker, turn in enumerate(turned):
                marks[marker, :, coefficients + 3 * marker : coefficients + 3 * marker + 3] = turn
            by_rest = marks.reshape(-1, len(gradient))
            own_hessian[np.diag_indices(PARAMETERS)] *= 1 + damping
            mixed = by_pose.T @ by_rest
            solved = np.linalg.solve(own_hessian, np.column_stack((own_gradient, mixed)))
            cost += own_cost
            gradient += by_rest.T @ residuals.ravel() - mixed.T @ solved[:, 0]
            hessian += by_rest.T @ by_rest - mixed.T @ solved[:, 1:]
            eliminated.append(solved)
        step = -np.linalg.solve(hessian + damping * np.diag(np.diag(hessian)), gradient)
        own_steps = np.array([-solved[:, 0] - solved[:, 1:] @ step for solved in eliminated])
        return cost, [step[:coefficients], step[coefficients:], own_steps]


def _begin(body: Body, landmarks: Landmarks, points: Float) -> Float:
    """(75,) standing, turned as the trunk's markers are (the rotation by Kabsch)."""
    rotations = _standing()
    on_trunk = np.isin(landmarks.joints, [smpl.INDEX[name] for name in _TRUNK]) & _seen(points)
    if on_trunk.sum() < 3:
        raise UserError("the first frame shows fewer than three markers of the trunk; cut the recording to where it shows them")
    placed = body.landmarks_m(Pose(np.zeros(3), rotations), landmarks)[on_trunk]
    wanted = points[on_trunk]
    u, _, v = np.linalg.svd((placed - placed.mean(0)).T @ (wanted - wanted.mean(0)))
    turn = v.T @ np.diag((1.0, 1.0, np.sign(np.linalg.det(v.T @ u.T)))) @ u.T
    rotations[0] = rotation_vectors(turn)
    return Pose(wanted.mean(0) - turn @ placed.mean(0), rotations).vector


def _seen(points: Float) -> Bool:
    return np.asarray(np.isfinite(points).all(axis=-1))


def _wrapped(vector: Float) -> Float:
    """The same pose with the pelvis turned by no more than half a turn."""
    angle = float(np.linalg.norm(vector[3:6]))
    out = vector.copy()
    if angle > np.pi:
        out[3:6] *= 1 - 2 * np.pi * np.ceil((angle - np.pi) / (2 * np.pi)) / angle
    return out
