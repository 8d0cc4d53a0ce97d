"""Forward kinematics, linear blend skinning and the analytic Jacobian of every point of the body.

A point of the body is a weighted sum of vertices, and every vertex is a weighted sum of rigid motions, so that a point is

    y = sum_t  a_t p_j(t) + R_j(t) (o_t + P_t f(theta))

with the joints' places p and rotations R, a share a_t of each joint that carries it, an offset o_t linear in the shape, and, for
bodies with pose correctives (SMPL's posedirs), P_t times f, the entries of the local rotations less the identity. A joint is the
simplest such point. So one kernel gives joints, COCO points and any other landmark without touching the skin, and its
derivative: turning joint m by the rotation vector d moves y by R_m J_r(theta_m) d x (S - A p_m), where S and A are the sums of the
terms that hang on m and J_r is the right Jacobian of the rotation group (Sola et al., "A micro Lie theory", 2018, eq. 143).
"""

import numpy as np

from models.arrays import Float
from models.compiled import Counts, compiled

_SMALL_RAD2 = 1e-8


@compiled
def place_joints(parents: Counts, rest: Float, translation: Float, rotations: Float) -> tuple[Float, Float, Float]:
    """Places and rotations of all joints.

    Args:
        parents: (J,) index of each joint's parent, -1 for the first.
        rest: (J, 3) joints in the T-pose, the first at the origin, metres.
        translation: (3,) place of the first joint, metres.
        rotations: (J, 3) rotation vectors, radians.

    Returns:
        (J, 3) places, (J, 3, 3) rotations in the world, (J, 3, 3) rotations against the parent.
    """
    count = rest.shape[0]
    places = np.empty((count, 3))
    world = np.empty((count, 3, 3))
    local = np.empty((count, 3, 3))
    for joint in range(count):
        _rotation(rotations[joint], local[joint])
        parent = parents[joint]
        if parent < 0:
            world[joint] = local[joint]
            places[joint] = translation
            continue
        _multiply(world[parent], local[joint], world[joint])
        for row in range(3):
            place = places[parent, row]
            for column in range(3):
                place += world[parent, row, column] * (rest[joint, column] - rest[parent, column])
            places[joint, row] = place
    return places, world, local


@compiled
def place_landmarks(places: Float, world: Float, starts: Counts, joints: Counts, shares: Float, offsets: Float) -> Float:
    """(K, 3) points: see this file's head.

    Args:
        places: (J, 3) and
        world: (J, 3, 3) of the joints.
        starts: (K + 1,) first term of each point.
        joints: (T,) joint of each term.
        shares: (T,) a_t.
        offsets: (T, 3) o_t of this person, pose correctives included, metres.
    """
    out = np.zeros((starts.shape[0] - 1, 3))
    for point in range(out.shape[0]):
        for term in range(starts[point], starts[point + 1]):
            joint = joints[term]
            for row in range(3):
                value = shares[term] * places[joint, row]
                for column in range(3):
                    value += world[joint, row, column] * offsets[term, column]
                out[point, row] += value
    return out


@compiled
def landmark_jacobian(
    parents: Counts,
    rest_shapedirs: Float,
    rotations: Float,
    places: Float,
    world: Float,
    local: Float,
    starts: Counts,
    joints: Counts,
    shares: Float,
    offsets: Float,
    offset_shapedirs: Float,
    offset_posedirs: Float,
) -> Float:
    """(K, 3, 3 + 3 J + S) derivative of the points by translation, rotation vectors and shape.

    Args:
        parents: (J,) as `place_joints`.
        rest_shapedirs: (J, 3, S) derivative of the joints in the T-pose by the shape.
        rotations: (J, 3) rotation vectors.
        places: and
        world: and
        local: what `place_joints` gave for them.
        starts: and
        joints: and
        shares: and
        offsets: as in `place_landmarks`.
        offset_shapedirs: (T, 3, S) derivative of the offsets by the shape.
        offset_posedirs: (T, 3, 9 (J - 1)) P_t, or no columns for a body without pose correctives.
    """
    count, coefficients = parents.shape[0], rest_shapedirs.shape[2]
    points = starts.shape[0] - 1
    first_shape = 3 + 3 * count
    out = np.zeros((points, 3, first_shape + coefficients))
    joint_by_shape = _joints_by_shape(parents, rest_shapedirs, world)
    own_axes = np.empty((count, 3, 3))
    turned_axes = np.empty((count, 3, 3))
    for joint in range(count):
        _right_jacobian(rotations[joint], own_axes[joint])
        _multiply(world[joint], own_axes[joint], turned_axes[joint])
    sums = np.empty((count, 3))
    carried = np.empty(count)
    place = np.empty(3)
    for point in range(points):
        sums[:] = 0.0
        carried[:] = 0.0
        for term in range(starts[point], starts[point + 1]):
            joint, share = joints[term], shares[term]
            for row in range(3):
                out[point, row, row] += share
                arm = 0.0
                for column in range(3):
                    turned = world[joint, row, column]
                    arm += turned * offsets[term, column]
                    for shape in range(coefficients):
                        out[point, row, first_shape + shape] += turned * offset_shapedirs[term, column, shape]
                for shape in range(coefficients):
                    out[point, row, first_shape + shape] += share * joint_by_shape[joint, row, shape]
                place[row] = share * places[joint, row] + arm
            _carry(parents, joint, place, share, sums, carried)
            if offset_posedirs.shape[2] > 0:
                _add_correctives(out[point], world[joint], local, own_axes, offset_posedirs[term])
        for joint in range(count):
            x = sums[joint, 0] - carried[joint] * places[joint, 0]
            y = sums[joint, 1] - carried[joint] * places[joint, 1]
            z = sums[joint, 2] - carried[joint] * places[joint, 2]
            for axis in range(3):
                a, b, c = turned_axes[joint, 0, axis], turned_axes[joint, 1, axis], turned_axes[joint, 2, axis]
                column = 3 + 3 * joint + axis
                out[point, 0, column] += b * z - c * y
                out[point, 1, column] += c * x - a * z
                out[point, 2, column] += a * y - b * x
    return out


@compiled
def skin(rest_joints: Float, places: Float, world: Float, rest: Float, joints: Counts, weights: Float) -> Float:
    """(V, 3) vertices by linear blend skinning.

    Args:
        rest_joints: (J, 3) joints in the T-pose.
        places: and
        world: what `place_joints` gave.
        rest: (V, 3) vertices in the T-pose, pose correctives included.
        joints: (V, W) the joints that carry each vertex.
        weights: (V, W) how much; rows sum to 1.
    """
    count = rest_joints.shape[0]
    motion = np.empty((count, 12))
    for joint in range(count):
        for row in range(3):
            shift = places[joint, row]
            for column in range(3):
                motion[joint, 4 * row + column] = world[joint, row, column]
                shift -= world[joint, row, column] * rest_joints[joint, column]
            motion[joint, 4 * row + 3] = shift
    out = np.empty(rest.shape)
    blend = np.empty(12)
    for vertex in range(rest.shape[0]):
        blend[:] = 0.0
        for place in range(joints.shape[1]):
            weight = weights[vertex, place]
            if weight != 0.0:
                joint = joints[vertex, place]
                for entry in range(12):
                    blend[entry] += weight * motion[joint, entry]
        x, y, z = rest[vertex, 0], rest[vertex, 1], rest[vertex, 2]
        for row in range(3):
            out[vertex, row] = blend[4 * row] * x + blend[4 * row + 1] * y + blend[4 * row + 2] * z + blend[4 * row + 3]
    return out


@compiled
def _carry(parents: Counts, joint: int, place: Float, share: float, sums: Float, carried: Float) -> None:
    """Hang one term on its joint and all joints above."""
    above = joint
    while above >= 0:
        for row in range(3):
            sums[above, row] += place[row]
        carried[above] += share
        above = parents[above]


@compiled
def _rotation(vector: Float, out: Float) -> None:
    """Rodrigues' formula."""
    x, y, z = vector[0], vector[1], vector[2]
    squared = x * x + y * y + z * z
    if squared < _SMALL_RAD2:
        a, b = 1.0 - squared / 6.0, 0.5 - squared / 24.0
    else:
        angle = np.sqrt(squared)
        a, b = np.sin(angle) / angle, 2.0 * (np.sin(0.5 * angle) / angle) ** 2
    _series(x, y, z, squared, a, b, out)


@compiled
def _right_jacobian(vector: Float, out: Float) -> None:
    """J_r: exp(v + d) = exp(v) exp(J_r d) for small d."""
    x, y, z = vector[0], vector[1], vector[2]
    squared = x * x + y * y + z * z
    if squared < _SMALL_RAD2:
        a, b = -0.5 + squared / 24.0, 1.0 / 6.0 - squared / 120.0
    else:
        angle = np.sqrt(squared)
        a, b = -2.0 * (np.sin(0.5 * angle) / angle) ** 2, (1.0 - np.sin(angle) / angle) / squared
    _series(x, y, z, squared, a, b, out)


@compiled
def _series(x: float, y: float, z: float, squared: float, a: float, b: float, out: Float) -> None:
    """1 + a K + b K^2 with K the cross product with (x, y, z)."""
    out[0, 0] = 1.0 + b * (x * x - squared)
    out[1, 1] = 1.0 + b * (y * y - squared)
    out[2, 2] = 1.0 + b * (z * z - squared)
    out[0, 1], out[1, 0] = b * x * y - a * z, b * x * y + a * z
    out[0, 2], out[2, 0] = b * x * z + a * y, b * x * z - a * y
    out[1, 2], out[2, 1] = b * y * z - a * x, b * y * z + a * x


@compiled
def _multiply(left: Float, right: Float, out: Float) -> None:
    for row in range(3):
        for column in range(3):
            out[row, column] = left[row, 0] * right[0, column] + left[row, 1] * right[1, column] + left[row, 2] * right[2, column]


@compiled
def _joints_by_shape(parents: Counts, rest_shapedirs: Float, world: Float) -> Float:
    """(J, 3, S) derivative of the posed joints by the shape."""
    out = np.zeros(rest_shapedirs.shape)
    for joint in range(parents.shape[0]):
        parent = parents[joint]
        if parent < 0:
            continue
        for row in range(3):
            for shape in range(rest_shapedirs.shape[2]):
                value = out[parent, row, shape]
                for column in range(3):
                    value += world[parent, row, column] * (
                        rest_shapedirs[joint, column, shape] - rest_shapedirs[parent, column, shape]
                    )
                out[joint, row, shape] = value
    return out


@compiled
def _add_correctives(out: Float, world: Float, local: Float, own_axes: Float, posedirs: Float) -> None:
    """Add R P df/dtheta of one term: the local rotation of joint m changes by R_m [J_r e]x for each axis e."""
    change = np.empty(9)
    moved = np.empty(3)
    for joint in range(1, local.shape[0]):
        for axis in range(3):
            a, b, c = own_axes[joint, 0, axis], own_axes[joint, 1, axis], own_axes[joint, 2, axis]
            for row in range(3):
                p, q, r = local[joint, row, 0], local[joint, row, 1], local[joint, row, 2]
                change[3 * row] = q * c - r * b
                change[3 * row + 1] = r * a - p * c
                change[3 * row + 2] = p * b - q * a
            for row in range(3):
                moved[row] = 0.0
                for entry in range(9):
                    moved[row] += posedirs[row, 9 * (joint - 1) + entry] * change[entry]
            for row in range(3):
                out[row, 3 + 3 * joint + axis] += world[row, 0] * moved[0] + world[row, 1] * moved[1] + world[row, 2] * moved[2]
