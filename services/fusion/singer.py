"""Compiled steps of the joints' Kalman filters: prediction, correction by one picture, and what a picture should show.

The model of motion is Singer's (1970): acceleration is a first-order Markov process; here velocity dies away as well. The
transition is a 3 x 3 matrix times the identity of space, which the loops exploit.
"""

import numpy as np

from models.arrays import Bool, Float
from models.compiled import compiled

_SMALLEST_PIVOT = 1e-16
"""Share of its diagonal that a pivot keeps where rounding leaves nothing of it; see `triangulation`."""


@compiled
def _transition(dt: float, acceleration_memory: float, velocity_memory: float) -> Float:
    """(3, 3) transition of position, velocity and acceleration of one coordinate."""
    alpha = 1.0 / acceleration_memory
    fade = np.exp(-alpha * dt)
    out = np.zeros((3, 3))
    out[0, 0] = 1.0
    out[0, 1] = velocity_memory * (1.0 - np.exp(-dt / velocity_memory))
    out[0, 2] = (alpha * dt - 1.0 + fade) / (alpha * alpha)
    out[1, 1] = np.exp(-dt / velocity_memory)
    out[1, 2] = (1.0 - fade) / alpha
    out[2, 2] = fade
    return out


@compiled
def advance_joints(
    state: Float, covariance: Float, alive: Bool, dt: float, acceleration: Float, acceleration_memory: float, velocity_memory: float
) -> None:
    """The kernel of `JointFilter.advance`. F is a 3 x 3 matrix times the identity of space, which the loops exploit."""
    transition = _transition(dt, acceleration_memory, velocity_memory)
    noise = np.empty((3, 3))
    noise[0, 0], noise[0, 1], noise[0, 2] = dt**5 / 20.0, dt**4 / 8.0, dt**3 / 6.0
    noise[1, 0], noise[1, 1], noise[1, 2] = dt**4 / 8.0, dt**3 / 3.0, dt**2 / 2.0
    noise[2, 0], noise[2, 1], noise[2, 2] = dt**3 / 6.0, dt**2 / 2.0, dt
    half = np.empty((9, 9))
    for j in range(state.shape[0]):
        if not alive[j]:
            continue
        intensity = 2.0 * acceleration[j] ** 2 / acceleration_memory
        for k in range(3):
            p, v, a = state[j, k], state[j, 3 + k], state[j, 6 + k]
            state[j, k] = p + transition[0, 1] * v + transition[0, 2] * a
            state[j, 3 + k] = transition[1, 1] * v + transition[1, 2] * a
            state[j, 6 + k] = transition[2, 2] * a
        matrix = covariance[j]
        for column in range(9):
            for k in range(3):
                p, v, a = matrix[k, column], matrix[3 + k, column], matrix[6 + k, column]
                half[k, column] = p + transition[0, 1] * v + transition[0, 2] * a
                half[3 + k, column] = transition[1, 1] * v + transition[1, 2] * a
                half[6 + k, column] = transition[2, 2] * a
        for row in range(9):
            for k in range(3):
                p, v, a = half[row, k], half[row, 3 + k], half[row, 6 + k]
                matrix[row, k] = p + transition[0, 1] * v + transition[0, 2] * a
                matrix[row, 3 + k] = transition[1, 1] * v + transition[1, 2] * a
                matrix[row, 6 + k] = transition[2, 2] * a
        for a_block in range(3):
            for b_block in range(3):
                for k in range(3):
                    matrix[3 * a_block + k, 3 * b_block + k] += intensity * noise[a_block, b_block]


@compiled
def update_joints(
    state: Float,
    covariance: Float,
    alive: Bool,
    projection: Float,
    points: Float,
    sigma: Float,
    usable: Bool,
    soft_gate: float,
    hard_gate: float,
    max_speed: float,
) -> tuple[Float, Bool]:
    """The kernel of `JointFilter.update`: squared innovations in sigmas (J,), and which measurements were used (J,)."""
    joints = state.shape[0]
    distance2 = np.full(joints, np.nan)
    used = np.zeros(joints, np.bool_)
    jacobian, cross = np.empty((2, 3)), np.empty((9, 2))
    for j in range(joints):
        if not (alive[j] and usable[j]):
            continue
        u, v, depth = _project(projection, state[j], jacobian)
        if depth <= 1e-6:
            continue
        matrix = covariance[j]
        for row in range(9):
            for side in range(2):
                cross[row, side] = 0.0
                for k in range(3):
                    cross[row, side] += matrix[row, k] * jacobian[side, k]
        du, dv = points[j, 0] - u, points[j, 1] - v
        distance2[j] = _correct(state[j], matrix, jacobian, cross, du, dv, sigma[j] * sigma[j], soft_gate, hard_gate)
        used[j] = distance2[j] <= hard_gate
        speed = np.sqrt(state[j, 3] ** 2 + state[j, 4] ** 2 + state[j, 5] ** 2)
        if speed > max_speed:
            for k in range(3, 6):
                state[j, k] *= max_speed / speed
    return distance2, used


@compiled
def _project(projection: Float, point: Float, jacobian: Float) -> tuple[float, float, float]:
    """Pixel and depth of a world point; fills the (2, 3) Jacobian. Depth <= 0 is behind the camera."""
    x, y, z = point[0], point[1], point[2]
    w = projection[2, 0] * x + projection[2, 1] * y + projection[2, 2] * z + projection[2, 3]
    if w <= 1e-6:
        return 0.0, 0.0, w
    u = (projection[0, 0] * x + projection[0, 1] * y + projection[0, 2] * z + projection[0, 3]) / w
    v = (projection[1, 0] * x + projection[1, 1] * y + projection[1, 2] * z + projection[1, 3]) / w
    for k in range(3):
        jacobian[0, k] = (projection[0, k] - u * projection[2, k]) / w
        jacobian[1, k] = (projection[1, k] - v * projection[2, k]) / w
    return u, v, w


@compiled
def _correct(
    state: Float,
    matrix: Float,
    jacobian: Float,
    cross: Float,
    du: float,
    dv: float,
    noise: float,
    soft_gate: float,
    hard_gate: float,
) -> float:
    """Kalman correction of one joint by a 2D residual, unless it is beyond the gate; returns its squared length in sigmas."""
    spread_uu = spread_uv = spread_vv = 0.0
    for k in range(3):
        spread_uu += jacobian[0, k] * cross[k, 0]
        spread_uv += jacobian[0, k] * cross[k, 1]
        spread_vv += jacobian[1, k] * cross[k, 1]
    uu, vv = spread_uu + noise, spread_vv + noise
    determinant = uu * vv - spread_uv * spread_uv
    distance2: float = (du * du * vv - 2.0 * du * dv * spread_uv + dv * dv * uu) / determinant
    if distance2 > hard_gate:
        return distance2
    if distance2 > soft_gate:
        noise *= distance2 / soft_gate
        uu, vv = spread_uu + noise, spread_vv + noise
        determinant = uu * vv - spread_uv * spread_uv
    gain = np.empty((9, 2))
    for row in range(9):
        gain[row, 0] = (cross[row, 0] * vv - cross[row, 1] * spread_uv) / determinant
        gain[row, 1] = (cross[row, 1] * uu - cross[row, 0] * spread_uv) / determinant
        state[row] += gain[row, 0] * du + gain[row, 1] * dv
    for row in range(9):
        for column in range(row + 1):
            value = matrix[row, column] - gain[row, 0] * cross[column, 0] - gain[row, 1] * cross[column, 1]
            matrix[row, column] = value
            matrix[column, row] = value
    return distance2


@compiled
def expect_joints(state: Float, covariance: Float, alive: Bool, projection: Float) -> tuple[Float, Float, Float, Bool]:
    """The kernel of `JointFilter.expect`."""
    joints = state.shape[0]
    points, variance, scale = np.zeros((joints, 2)), np.zeros(joints), np.ones(joints)
    known = np.zeros(joints, np.bool_)
    focal = np.sqrt(projection[0, 0] ** 2 + projection[0, 1] ** 2 + projection[0, 2] ** 2)
    jacobian = np.empty(3)
    for j in range(joints):
        if not alive[j]:
            continue
        x, y, z = state[j, 0], state[j, 1], state[j, 2]
        w = projection[2, 0] * x + projection[2, 1] * y + projection[2, 2] * z + projection[2, 3]
        if w <= 1e-6:
            continue
        known[j] = True
        scale[j] = focal / w
        for side in range(2):
            pixel = (projection[side, 0] * x + projection[side, 1] * y + projection[side, 2] * z + projection[side, 3]) / w
            points[j, side] = pixel
            for k in range(3):
                jacobian[k] = (projection[side, k] - pixel * projection[2, k]) / w
            for k in range(3):
                for m in range(3):
                    variance[j] += 0.5 * jacobian[k] * covariance[j, k, m] * jacobian[m]
    return points, variance, scale, known


@compiled
def separations2(points: Float, spreads: Float, state: Float, covariance: Float) -> Float:
    """(J,) squared distances in sigmas of points (J, 3), of covariance (J, 3, 3), from the filters' positions; infinite for NaN."""
    out = np.full(points.shape[0], np.inf)
    spread = np.empty((3, 3))
    for j in range(points.shape[0]):
        if np.isnan(points[j]).any():
            continue
        for k in range(3):
            for m in range(3):
                spread[k, m] = spreads[j, k, m] + covariance[j, k, m]
            spread[k, k] += 1e-6
        out[j] = distance2(spread, points[j] - state[j, :3])
    return out


@compiled
def distance2(spread: Float, apart: Float) -> float:
    """Squared length in sigmas of a vector (3,), by the factors L D L^T of its covariance (Golub and Van Loan, 4.1.2)."""
    first = spread[0, 0]
    l10, l20 = spread[1, 0] / first, spread[2, 0] / first
    second = max(spread[1, 1] - l10 * spread[1, 0], _SMALLEST_PIVOT * spread[1, 1])
    l21 = (spread[2, 1] - l20 * spread[1, 0]) / second
    third = max(spread[2, 2] - l20 * spread[2, 0] - l21 * l21 * second, _SMALLEST_PIVOT * spread[2, 2])
    b = apart[1] - l10 * apart[0]
    c = apart[2] - l20 * apart[0] - l21 * b
    squared: float = apart[0] * apart[0] / first + b * b / second + c * c / third
    return squared
