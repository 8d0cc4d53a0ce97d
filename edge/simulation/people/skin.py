"""The skin that is to be seen, and the face painted on it."""

from collections.abc import Sequence

import numpy as np

from edge.simulation.people.anatomy import Anatomy
from edge.simulation.people.paint import EYE, FACE, Picture, plain_uv
from edge.simulation.people.shell import Shell, clipped, joined, selected, within
from models.arrays import Bool, Float

Colour = tuple[float, float, float]

_IRIS_SHARE = 0.52
"""Radius of the iris over that of the part of the eye that is seen."""


def azimuth(anatomy: Anatomy, points_m: Float) -> Float:
    """(V,) angle around the head from straight ahead, 0 to pi on either side: the face is the same left and right."""
    axis = (anatomy.point("left_ear")[0] + anatomy.point("right_ear")[0]) / 2
    return np.asarray(np.abs(np.arctan2(points_m[:, 1], points_m[:, 0] - axis)))


def _down(anatomy: Anatomy, z: Float) -> Float:
    low = anatomy.chin_z - 0.07 * anatomy.head_scale
    return np.asarray((anatomy.crown_z - z) / (anatomy.crown_z - low))


def visible_skin(anatomy: Anatomy, covered_m: Float, tone: Colour) -> Shell:
    """Skin and eyes without what clothes cover.

    Args:
        anatomy: whose.
        covered_m: (V,) how far each of the body's vertices is under a garment, negative where it is not covered.
        tone: of the skin, sRGB.
    """
    shell = anatomy.skin.painted(_blushed(anatomy, tone))
    eyes = anatomy.part("eyes")
    head = anatomy.head & ~eyes
    of_head, of_eyes = within(shell, head), within(shell, eyes)
    uv = plain_uv(len(shell.vertices_m))
    uv[head] = FACE.uv(azimuth(anatomy, shell.vertices_m) / np.pi, _down(anatomy, shell.vertices_m[:, 2]))[head]
    painted = Shell(shell.vertices_m, shell.faces, shell.weights, shell.colours, uv)
    plain = Shell(shell.vertices_m, shell.faces, shell.weights, shell.colours, plain_uv(len(uv)))
    field = np.where(anatomy.part("cavities"), 1.0, -covered_m)
    # Vertices on the border of head and body occur twice, at the same place: once for each part of the picture.
    pieces = [
        _cut(painted, field, of_head),
        _cut(plain, field, ~(of_head | of_eyes)),
        _eyes(anatomy, selected(shell, of_eyes)),
    ]
    return joined([piece for piece in pieces if len(piece.faces)])


def _cut(shell: Shell, field: Float, faces: Bool) -> Shell:
    used = np.unique(shell.faces[faces])
    return clipped(selected(shell, faces), field[used])


def _blushed(anatomy: Anatomy, tone: Colour) -> Float:
    """(V, 3) the tone, redder where blood is near: hands, elbows, knees, ears, nose."""
    colours = np.tile(np.asarray(tone, np.float64), (len(anatomy.skin.vertices_m), 1))
    places = [(anatomy.joint(f"{side}_{name}"), 0.05) for side in ("left", "right") for name in ("elbow", "knee", "hand")]
    places += [(anatomy.point("nose"), 0.018), (anatomy.point("left_ear"), 0.025), (anatomy.point("right_ear"), 0.025)]
    for centre, reach in places:
        near = np.exp(-((np.linalg.norm(anatomy.skin.vertices_m - centre, axis=1) / (reach * anatomy.scale)) ** 2))
        colours *= 1 - near[:, None] * np.array((0.0, 0.07, 0.07))
    inside = anatomy.part("cavities")
    colours[inside] *= (0.45, 0.25, 0.25)
    return colours


def _eyes(anatomy: Anatomy, eyes: Shell) -> Shell:
    """Both eyeballs, with iris and pupil from the picture."""
    uv = np.empty((len(eyes.vertices_m), 2))
    for side, name in ((1, "left_eye"), (-1, "right_eye")):
        own = eyes.vertices_m[:, 1] * side > 0
        centre = (eyes.vertices_m[own].max(0) + eyes.vertices_m[own].min(0)) / 2
        reach = np.ptp(eyes.vertices_m[own, 2]) / 2
        gaze = np.array((centre[1], anatomy.point(name)[2]))
        place = (eyes.vertices_m[own][:, 1:] - gaze) / reach
        uv[own] = EYE.uv(0.5 + 0.5 * place[:, 0], 0.5 - 0.5 * place[:, 1])
    return Shell(eyes.vertices_m, eyes.faces, eyes.weights, np.ones_like(eyes.vertices_m), uv)


def paint_face(
    picture: Picture, anatomy: Anatomy, tone: Colour, brows: Colour, iris: Colour, hairline: Sequence[tuple[float, float]]
) -> None:
    """Brows, eyelids, lips, nostrils, cheeks, and the ground under the hair.

    Args:
        picture: to be painted on.
        anatomy: whose.
        tone: of the skin.
        brows: colour of brows and hair.
        iris: colour of the eyes.
        hairline: (azimuth in degrees, height over the eyes as a share of the way to the crown) of the hair's lower edge.
    """
    across, down = FACE.axes()
    around = np.degrees(across * np.pi)
    low = anatomy.chin_z - 0.07 * anatomy.head_scale
    z = anatomy.crown_z - down * (anatomy.crown_z - low)
    size = anatomy.head_scale
    radius = 0.085 * size
    eye_z, nose_z = float(anatomy.point("left_eye")[2]), float(anatomy.point("nose")[2])
    eye_at = float(np.degrees(azimuth(anatomy, anatomy.point("left_eye")[None])[0]))

    def blob(at_deg: float, at_z: float, wide_m: float, high_m: float, hard: float = 1.0) -> Float:
        """1 in the middle of an ellipse, 1/e at its edge."""
        sideways = np.radians(around - at_deg) * radius / (wide_m * size)
        return np.asarray(np.exp(-((sideways**2 + ((z - at_z) / (high_m * size)) ** 2) ** hard)))

    light = np.ones((*around.shape, 3))

    def tint(amount: Float, colour: Sequence[float] | Float) -> None:
        light[...] = light * (1 - amount[..., None]) + light * amount[..., None] * np.asarray(colour)

    dark = np.clip(np.asarray(brows) / np.maximum(tone, 0.05), 0, 0.75)
    tint(0.45 * blob(34, eye_z - 0.030 * size, 0.020, 0.016), (1.0, 0.86, 0.86))
    tint(0.20 * blob(eye_at, eye_z, 0.022, 0.014, 2), (0.78, 0.68, 0.66))
    tint(0.70 * blob(eye_at, eye_z, 0.0158, 0.0072, 3), (0.36, 0.27, 0.25))
    tint(0.55 * blob(eye_at, eye_z + 0.0072 * size, 0.015, 0.0020, 2), (0.2, 0.15, 0.14))
    arch = (eye_z + 0.0225 * size) - 0.000006 * size * (around - eye_at) ** 2
    tint(0.8 * blob(eye_at + 1, 0, 0.0155, 1.0, 2) * np.exp(-(((z - arch) / (0.0030 * size)) ** 4)), dark)
    tint(0.65 * blob(4.5, nose_z - 0.0085 * size, 0.0045, 0.0026), (0.4, 0.25, 0.25))
    tint(0.2 * blob(10, nose_z - 0.003 * size, 0.005, 0.009), (0.75, 0.66, 0.66))
    smile = anatomy.mouth_z - 0.0025 * size + 0.000010 * size * around**2
    lips = blob(0, 0, 0.022, 1.0, 2) * np.exp(-(((z - smile) / (0.0072 * size)) ** 4))
    tint(0.6 * lips, (0.88, 0.60, 0.60))
    tint(0.6 * blob(0, 0, 0.020, 1.0, 2) * np.exp(-(((z - smile) / (0.0013 * size)) ** 2)), (0.45, 0.25, 0.25))
    jaw = np.clip((anatomy.chin_z + 0.004 * size - z) / (0.02 * size), 0, 1) * np.exp(-((around / 75) ** 4))
    tint(0.30 * jaw, (0.62, 0.52, 0.5))
    degrees, heights = np.array(hairline).T
    edge = eye_z + np.interp(around, degrees, heights) * (anatomy.crown_z - eye_z)
    tint(0.9 / (1 + np.exp(-(z - edge) / (0.003 * size))), np.clip(np.asarray(brows) / np.maximum(tone, 0.05), 0, 1))
    picture.tint(FACE, light)
    _paint_eye(picture, iris)


def _paint_eye(picture: Picture, iris: Colour) -> None:
    across, down = EYE.axes()
    away = np.hypot(across - 0.5, down - 0.5) * 2
    light = np.ones((*away.shape, 3)) * (0.90, 0.89, 0.88)
    light[away < _IRIS_SHARE] = iris
    light[away < 0.45 * _IRIS_SHARE] = (0.03, 0.03, 0.03)
    light[np.hypot(across - 0.56, down - 0.42) < 0.035] = (1.0, 1.0, 1.0)
    picture.tint(EYE, light)
