"""Hair and what is worn over it."""

from dataclasses import replace
from typing import Final, Literal, get_args

import numpy as np
from scipy import ndimage

from edge.simulation.people.anatomy import Anatomy
from edge.simulation.people.cloth import Garment, blown_up, refined, turned_in
from edge.simulation.people.paint import HAIR, cloth_uv
from edge.simulation.people.shell import Shell, clipped, joined, selected, smoothed, within
from edge.simulation.people.skin import Colour, azimuth
from models.arrays import Float
from models.skeleton import smpl

Style = Literal["cropped", "short", "fringe", "bob", "pony_tail", "bun", "scarf"]
STYLES: Final[tuple[Style, ...]] = get_args(Style)

_HAIRLINES: Final = {
    "high": ((0, 0.66), (30, 0.64), (48, 0.52), (66, 0.40), (76, -0.02), (88, 0.0), (100, 0.12), (125, -0.20), (180, -0.34)),
    "fringe": ((0, 0.34), (30, 0.33), (48, 0.30), (66, 0.20), (76, -0.10), (88, -0.05), (100, 0.10), (125, -0.25), (180, -0.42)),
}
_THICKNESS_M: Final = {"cropped": 0.006, "short": 0.014, "fringe": 0.016, "bob": 0.014, "pony_tail": 0.007, "bun": 0.007}
_EAR_M: Final = 0.027


def hairline(style: Style) -> tuple[tuple[float, float], ...]:
    """(azimuth in degrees, height over the eyes as a share of the way to the crown) of the lower edge."""
    return _HAIRLINES["fringe" if style in {"fringe", "bob"} else "high"]


def grow(anatomy: Anatomy, style: Style, colour: Colour, detail: int) -> Garment:
    """The hair of a style, or a scarf in that colour that covers it."""
    none = np.full(len(anatomy.skin.vertices_m), -1.0)
    if style == "scarf":
        return _scarf(anatomy, colour, detail)
    pieces = [_scalp(anatomy, style, detail)]
    if style == "bob":
        pieces.append(_curtain(anatomy))
    if style in {"pony_tail", "bun"}:
        pieces.append(_tail(anatomy, style))
    return Garment(joined(pieces).painted(colour), none)


def _up(anatomy: Anatomy, points_m: Float) -> Float:
    eye_z = anatomy.point("left_eye")[2]
    return np.asarray((points_m[:, 2] - eye_z) / (anatomy.crown_z - eye_z))


def _scalp(anatomy: Anatomy, style: Style, detail: int) -> Shell:
    size = anatomy.head_scale
    keep = anatomy.part("hair", "face", "neck")
    head = selected(anatomy.skin, within(anatomy.skin, keep))
    head = refined(head, max(detail, 1))
    around = np.degrees(azimuth(anatomy, head.vertices_m))
    edge = np.interp(around, *np.array(hairline(style)).T)
    field = (_up(anatomy, head.vertices_m) - edge) * (anatomy.crown_z - anatomy.point("left_eye")[2])
    for ear in ("left_ear", "right_ear"):
        near = np.linalg.norm((head.vertices_m - anatomy.point(ear)) * (1, 0.6, 0.85), axis=1) - _EAR_M * size
        field = np.minimum(field, near)
    on_head = clipped(replace(head, uv=np.stack((field, field), -1)), field)
    full = _THICKNESS_M[style] * size
    rise = np.clip(on_head.uv[:, 0] / (0.020 * size), 0, 1)
    on_top = np.clip(_up(anatomy, on_head.vertices_m), 0, 1)
    thickness = full * (0.12 + (0.38 + 0.5 * on_top) * rise * (2 - rise))
    normals = smoothed(on_head.normals, on_head.faces, 2)
    shell = on_head.moved(smoothed(on_head.vertices_m + thickness[:, None] * normals, on_head.faces, 1))
    shell = turned_in(shell, 0.006 * size)
    return replace(shell, uv=_strand_uv(anatomy, shell.vertices_m))


def _strand_uv(anatomy: Anatomy, points_m: Float) -> Float:
    return HAIR.uv(azimuth(anatomy, points_m) / np.pi, 0.5 - 0.5 * _up(anatomy, points_m))


def _curtain(anatomy: Anatomy) -> Shell:
    """Hair that hangs over ears and nape, down to the chin."""
    size, skin = anatomy.head_scale, anatomy.skin.vertices_m
    head = skin[anatomy.part("hair", "face")]
    axis = float(anatomy.point("left_ear")[0] + anatomy.point("right_ear")[0]) / 2
    angle = np.degrees(np.arctan2(head[:, 1], head[:, 0] - axis))
    columns = np.radians(np.linspace(64, 296, 33))
    level = np.abs(_up(anatomy, head) - 0.25) < 0.35
    reach = np.array([_widest(head[level], angle[level], np.degrees(turn), axis) for turn in columns])
    reach = ndimage.gaussian_filter1d(reach, 1.5, mode="nearest") + 0.010 * size
    heights = np.linspace(0, 1, 9)
    eye_z = anatomy.point("left_eye")[2]
    top_z, hem_z = eye_z + 0.62 * (anatomy.crown_z - eye_z), anatomy.chin_z + 0.004 * size
    rows = []
    for share in heights:
        z = top_z + share * (hem_z - top_z)
        inwards = 1 - 0.22 * np.clip(1 - share / 0.35, 0, 1) ** 2 - 0.06 * np.clip((share - 0.75) / 0.25, 0, 1) ** 2
        rows.append(np.stack((axis + reach * inwards * np.cos(columns), reach * inwards * np.sin(columns), np.full(33, z)), -1))
    outer = np.stack(rows, 1).reshape(-1, 3)
    weights = np.zeros((len(outer), smpl.COUNT))
    weights[:, smpl.INDEX["head"]] = 1
    count = len(heights)
    ring, place = np.meshgrid(np.arange(len(columns) - 1), np.arange(count - 1), indexing="ij")
    a, b, c = ring * count + place, ring * count + place + 1, (ring + 1) * count + place
    faces = np.stack((a, b, c, b, c + 1, c), axis=-1).reshape(-1, 3)
    shell = Shell(outer, faces.astype(np.int32), weights, np.ones_like(outer), np.zeros((len(outer), 2)))
    shell = turned_in(shell, 0.010 * size)
    return replace(shell, uv=_strand_uv(anatomy, shell.vertices_m))


def _widest(points_m: Float, angle_deg: Float, turn_deg: float, axis: float) -> float:
    off = np.abs((angle_deg - turn_deg + 180) % 360 - 180)
    near = off < max(14.0, float(np.sort(off)[2]))
    return float(np.hypot(points_m[near, 0] - axis, points_m[near, 1]).max())


def _tail(anatomy: Anatomy, style: Style) -> Shell:
    """A pony tail or a bun at the back of the head."""
    size = anatomy.head_scale
    skin = anatomy.skin.vertices_m[anatomy.part("hair")]
    back = float(skin[:, 0].min())
    eye_z = anatomy.point("left_eye")[2]
    start = np.array((back + 0.006 * size, 0.0, eye_z + 0.45 * (anatomy.crown_z - eye_z)))
    if style == "bun":
        line = np.array(((0.012, 0, 0), (-0.004, 0, 0), (-0.024, 0, 0), (-0.042, 0, 0), (-0.050, 0, 0)))
        radii = np.array((0.018, 0.030, 0.034, 0.022, 0.002))
    else:
        line = np.array(
            (
                (0.010, 0, 0),
                (-0.014, 0, 0.004),
                (-0.036, 0, -0.006),
                (-0.052, 0, -0.032),
                (-0.056, 0, -0.075),
                (-0.052, 0, -0.12),
                (-0.044, 0, -0.155),
                (-0.040, 0, -0.17),
            )
        )
        radii = np.array((0.012, 0.013, 0.019, 0.023, 0.023, 0.019, 0.011, 0.001))
    line, radii = start + size * line, size * radii
    tangents = np.gradient(line, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    side = np.array((0.0, 1.0, 0.0))
    up = np.cross(tangents, side)
    turns = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    vertices = (
        line[:, None] + radii[:, None, None] * (np.cos(turns)[None, :, None] * side + np.sin(turns)[None, :, None] * up[:, None])
    ).reshape(-1, 3)
    rings, count = len(line), len(turns)
    ring, place = np.meshgrid(np.arange(rings - 1), np.arange(count), indexing="ij")
    a, b = ring * count + place, ring * count + (place + 1) % count
    faces = np.stack((a, a + count, b, b, a + count, b + count), axis=-1).reshape(-1, 3)
    weights = np.zeros((len(vertices), smpl.COUNT))
    weights[:, smpl.INDEX["head"]] = 1
    shell = Shell(vertices, faces.astype(np.int32), weights, np.ones_like(vertices), np.zeros((len(vertices), 2)))
    return replace(shell, uv=_strand_uv(anatomy, shell.vertices_m))


def _scarf(anatomy: Anatomy, colour: Colour, detail: int) -> Garment:
    """A sports scarf: covers hair, ears and neck, leaves the face free."""
    size, skin = anatomy.head_scale, anatomy.skin.vertices_m
    eye_z, low_z = anatomy.point("left_eye")[2], anatomy.chin_z - 0.004 * size
    high_z = eye_z + 0.58 * (anatomy.crown_z - eye_z)
    middle_z, half = (low_z + high_z) / 2, (high_z - low_z) / 2
    around = np.degrees(azimuth(anatomy, skin)) / 66
    oval = (np.hypot(around, (skin[:, 2] - middle_z) / half) - 1) * 0.06 * size
    oval = np.where(np.abs(skin[:, 2] - middle_z) < 2 * half, oval, 0.06 * size)
    neck = anatomy.joint("neck")
    bottom = skin[:, 2] - (neck[2] - 0.035 * anatomy.scale) + 0.35 * (0.03 * anatomy.scale - (skin[:, 0] - neck[0]))
    field = np.minimum(oval, bottom)
    field[~anatomy.head] = np.minimum(field[~anatomy.head], bottom[~anatomy.head])
    ground = anatomy.head | anatomy.part("chest")
    faces = within(anatomy.skin, ground & ~anatomy.part("eyes", "cavities"))
    piece = selected(anatomy.skin, faces)
    on_head = refined(clipped(piece, field[np.unique(anatomy.skin.faces[faces])]), detail)
    calm = on_head.moved(smoothed(on_head.vertices_m, on_head.faces, 10))
    ears = [anatomy.point(name) for name in ("left_ear", "right_ear")]
    near = np.min([np.linalg.norm(on_head.vertices_m - ear, axis=1) for ear in ears], axis=0) / (0.045 * size)
    pressed = np.exp(-(near**4))[:, None]
    calm = calm.moved((1 - pressed) * calm.vertices_m + pressed * smoothed(calm.vertices_m, calm.faces, 60))
    shell = blown_up(calm, np.full(len(calm.vertices_m), 0.008 * size), 2)
    outside = ((shell.vertices_m - on_head.vertices_m) * calm.normals).sum(1) - 0.005 * size
    shell = shell.moved(shell.vertices_m + (1 - pressed) * np.maximum(-outside, 0)[:, None] * calm.normals)
    shell = turned_in(shell, 0.006 * size).painted(colour)
    return Garment(replace(shell, uv=cloth_uv(shell.vertices_m, anatomy.scale)), field - 0.012 * size)
