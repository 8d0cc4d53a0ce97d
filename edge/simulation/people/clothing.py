"""Sports clothes, cut from the body they are made for: shirt, bib, shorts and trousers, socks, shoes."""

from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from scipy.spatial import ConvexHull

from edge.simulation.people.anatomy import Anatomy
from edge.simulation.people.cloth import Garment, blown_up, creased, hanging, refined, turned_in, with_channels
from edge.simulation.people.paint import PRINT, cloth_uv, plain_uv
from edge.simulation.people.shell import Shell, clipped, joined, selected, smoothed, subdivided, within
from edge.simulation.people.skin import Colour
from models.arrays import Bool, Float
from models.skeleton import smpl

Print = Literal["plain", "band", "number", "stripes", "badge"]
PRINTS: Final[tuple[Print, ...]] = ("plain", "band", "number", "stripes", "badge")

_ARMS: Final = [smpl.INDEX[f"{side}_{name}"] for side in ("left", "right") for name in ("shoulder", "elbow", "wrist", "hand")]
_TRIM_M: Final = 0.012
_SPARE_M: Final = 0.015
_SKULL: Final = ("eyes", "cavities", "hair", "face")


@dataclass(frozen=True)
class Shirt:
    """A T-shirt, a shirt with long sleeves, or a hoodie.

    Attributes:
        colour: of the cloth.
        trim: of collar and cuffs.
        sleeve: from the shoulder (0) over the elbow (1) to the wrist (2).
        ease: 0 clings, 1 is two sizes too large.
        length: 0 ends at the waist, 1 just above the crotch.
        print: what is on the chest; a number is on the back, too.
        hood: it lies on the back.
    """

    colour: Colour
    trim: Colour
    sleeve: float = 0.6
    ease: float = 0.5
    length: float = 0.6
    print: Print = "plain"
    hood: bool = False


@dataclass(frozen=True)
class Legwear:
    """Shorts, leggings or trousers.

    Attributes:
        colour: of the cloth.
        stripe: down the outer sides; None is none.
        length: from the crotch (0) over the knee (1) to the ankle (2).
        ease: 0 are leggings, 1 are wide.
    """

    colour: Colour
    stripe: Colour | None
    length: float = 0.75
    ease: float = 0.6


@dataclass(frozen=True)
class Footwear:
    """Shoes and socks.

    Attributes:
        upper: colour of the shoe.
        sole: colour of its sole.
        sock: colour of the sock.
        sock_height: from the ankle (0) to the knee (1).
    """

    upper: Colour
    sole: Colour
    sock: Colour
    sock_height: float = 0.15


def sew_shirt(anatomy: Anatomy, shirt: Shirt, detail: int, random: np.random.Generator) -> Garment:
    """The shirt on the body, untucked."""
    scale = anatomy.scale
    # Under a hood the cloth goes up to the neck: no skin is between them.
    collar = _collar_m(anatomy, anatomy.skin.vertices_m, 0.45 if shirt.hood else 1.0)
    cuff = _cuff_m(anatomy, anatomy.skin.vertices_m, shirt.sleeve)
    hem_z = _hem_z(anatomy) + (1 - shirt.length) * 0.07 * scale
    hem = anatomy.skin.vertices_m[:, 2] - hem_z
    field = np.minimum(np.minimum(collar, cuff), hem)
    # Cut with something to spare, and cut straight when all is in its place.
    on_body = refined(_cut(anatomy, field + _SPARE_M, ~anatomy.part(*_SKULL), collar, np.minimum(cuff, hem)), detail)
    arm = on_body.weights[:, _ARMS].sum(1)
    down = np.clip((anatomy.armpit_z - on_body.vertices_m[:, 2]) / (anatomy.armpit_z - hem_z), 0, 1) * (1 - arm)
    out = _outwards(anatomy, on_body.vertices_m, shirt.sleeve)
    thickness = scale * (0.005 + 0.003 * down + shirt.ease * (0.003 + 0.014 * out + 0.004 * down))
    shell = blown_up(on_body, thickness, 3)
    centre = np.array((anatomy.joint("left_hip")[0], 0.0))
    shell = hanging(shell, centre, anatomy.armpit_z + 0.02 * scale, np.where(arm < 0.3, shirt.ease * (1 - arm), 0))
    shell = creased(shell, scale * (0.002 + 0.009 * shirt.ease * np.maximum(down, 0.6 * out)), scale, random)
    shell = turned_in(clipped(shell, shell.uv.min(1)), 0.004 * scale)
    trimmed = shell.uv.min(1) - _TRIM_M * scale
    cloth, trim = clipped(shell, trimmed), clipped(shell, -trimmed)
    pieces = [_printed(anatomy, cloth.painted(shirt.colour)), _plain(anatomy, trim.painted(shirt.trim))]
    if shirt.hood:
        pieces.append(_plain(anatomy, _hood(anatomy).painted(shirt.colour)))
    covered = np.where(anatomy.part(*_SKULL), -1.0, field - scale * (0.02 + 0.05 * shirt.ease))
    return Garment(joined(pieces), covered)


def sew_bib(anatomy: Anatomy, worn_over: Garment, colour: Colour, random: np.random.Generator) -> Garment:
    """A training bib over a shirt: no sleeves, deep armholes."""
    shirt, scale = worn_over.shell, anatomy.scale
    below = anatomy.armpit_z - 0.03 * scale - shirt.vertices_m[:, 2]
    armhole = 0.74 * anatomy.joint("left_shoulder")[1] + 2.2 * np.maximum(below, 0) - np.abs(shirt.vertices_m[:, 1])
    collar = _collar_m(anatomy, shirt.vertices_m, 1.25)
    body = shirt.weights[:, _ARMS].sum(1) < 0.75
    field = np.where(body, np.minimum(armhole, collar), -0.05)
    shell = clipped(with_channels(shirt, field, shirt.vertices_m[:, 2]), field)
    normals = smoothed(shell.normals, shell.faces, 2)
    shell = shell.moved(shell.vertices_m + 0.007 * scale * normals)
    shell = creased(shell, np.full(len(shell.vertices_m), 0.004 * scale), scale, random)
    shell = turned_in(shell, 0.003 * scale)
    edge = shell.uv[:, 0] - _TRIM_M * scale
    cloth, trim = clipped(shell, edge), clipped(shell, -edge)
    light = tuple(np.clip(0.55 * np.array(colour), 0, 1))
    pieces = [_printed(anatomy, cloth.painted(colour)), _plain(anatomy, trim.painted(light))]
    return Garment(joined(pieces), np.full(len(anatomy.skin.vertices_m), -1.0))


def sew_legwear(anatomy: Anatomy, legwear: Legwear, detail: int, random: np.random.Generator) -> Garment:
    """Shorts, leggings or trousers, worn under the shirt."""
    scale, skin = anatomy.scale, anatomy.skin.vertices_m
    waist_z = _hem_z(anatomy) + 0.11 * scale
    knee_z, ankle_z = anatomy.joint("left_knee")[2], anatomy.joint("left_ankle")[2] + 0.01 * scale
    bottom_z = float(np.interp(legwear.length, (0, 1, 2), (anatomy.crotch_z, knee_z, ankle_z)))
    field = np.minimum(waist_z - skin[:, 2], skin[:, 2] - bottom_z)
    on_body = refined(_cut(anatomy, field + _SPARE_M, np.ones(len(skin), np.bool_), skin[:, 1], field), detail)
    _, y, z = on_body.vertices_m.T
    down = np.clip((anatomy.crotch_z + 0.05 * scale - z) / (anatomy.crotch_z + 0.05 * scale - bottom_z), 0, 1)
    shell = blown_up(on_body, scale * (0.0035 + legwear.ease * (0.002 + 0.012 * down)), 3)
    for side in (1, -1):
        hip = anatomy.joint("left_hip") * (1, side, 1)
        own = on_body.vertices_m[:, 1] * side >= 0
        shell = hanging(shell, hip[:2], anatomy.crotch_z + 0.04 * scale, np.where(own, legwear.ease * down**0.5, 0))
    shell = creased(shell, scale * (0.001 + 0.011 * legwear.ease * down), scale, random)
    # Cloth of one leg stays on its own side, where the other leg's is.
    apart = np.where(np.abs(y) > 0.004 * scale, 0.003 * scale * down, 0)
    inner = np.sign(y) * np.maximum(np.abs(shell.vertices_m[:, 1]) * (np.sign(y) == np.sign(shell.vertices_m[:, 1])), apart)
    shell = shell.moved(
        np.column_stack(
            (shell.vertices_m[:, 0], np.where(z < anatomy.crotch_z, inner, shell.vertices_m[:, 1]), shell.vertices_m[:, 2])
        )
    )
    shell = turned_in(clipped(shell, shell.uv[:, 1]), 0.004 * scale)
    pieces = [shell]
    if legwear.stripe is not None:
        centre = anatomy.joint("left_hip")[0]
        off = np.abs(shell.vertices_m[:, 0] - centre - 0.004) - 0.013 * scale
        inside = np.abs(shell.uv[:, 0]) < anatomy.joint("left_hip")[1]
        field_stripe = np.where(inside, 0.05, off)
        pieces = [clipped(shell, field_stripe), clipped(shell, -field_stripe).painted(legwear.stripe)]
    pieces[0] = pieces[0].painted(legwear.colour)
    return Garment(joined([_plain(anatomy, piece) for piece in pieces]), field - scale * (0.02 + 0.06 * legwear.ease))


def sew_footwear(anatomy: Anatomy, footwear: Footwear, detail: int) -> Garment:
    """Shoes whose soles are where the bare soles are, and socks."""
    scale, skin = anatomy.scale, anatomy.skin.vertices_m
    ankle_z, knee_z = anatomy.joint("left_ankle")[2], anatomy.joint("left_knee")[2]
    mouth_z = ankle_z - 0.004 * scale
    top_z = ankle_z + footwear.sock_height * 0.85 * (knee_z - ankle_z) + 0.035 * scale
    sock_field = np.minimum(top_z - skin[:, 2], skin[:, 2] - (mouth_z - 0.008 * scale))
    everywhere = np.ones(len(skin), np.bool_)
    sock = refined(_cut(anatomy, sock_field + _SPARE_M, everywhere, sock_field, sock_field), detail)
    sock = blown_up(sock, np.full(len(sock.vertices_m), 0.0025 * scale), 2)
    sock = turned_in(clipped(sock, sock.uv[:, 0]), 0.0025 * scale)
    shoes = _cut(anatomy, mouth_z - skin[:, 2], everywhere, skin[:, 0], skin[:, 1])
    pieces = [_plain(anatomy, sock.painted(footwear.sock))]
    for side in (1, -1):
        one = selected(shoes, within(shoes, shoes.vertices_m[:, 1] * side > 0))
        upper, sole = _shoe(anatomy, one)
        pieces += [_plain(anatomy, upper.painted(footwear.upper)), replace(sole.painted(footwear.sole), uv=plain_uv(len(sole.uv)))]
    return Garment(joined(pieces), top_z - skin[:, 2] - 0.012 * scale)


def _shoe(anatomy: Anatomy, foot: Shell) -> tuple[Shell, Shell]:
    """Upper and sole of one shoe, from the skin of one foot up to the ankle: its convex hull, open around the ankle."""
    scale, floor_z = anatomy.scale, anatomy.sole_z
    bare = foot.vertices_m + 0.006 * scale * foot.normals
    bare = np.concatenate((bare, bare + np.array((0.006 * scale, 0, 0))))
    planes = ConvexHull(bare).equations
    calm = subdivided(foot.moved(smoothed(foot.vertices_m, foot.faces, 12)))
    out = smoothed(calm.normals, calm.faces, 10)
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)
    towards = out @ planes[:, :3].T
    room = -(calm.vertices_m @ planes[:, :3].T + planes[:, 3])
    reach = np.where(towards > 1e-6, room / np.maximum(towards, 1e-6), np.inf).min(1)
    mouth_z = foot.vertices_m[:, 2].max()
    low = np.clip((mouth_z - calm.vertices_m[:, 2]) / (0.035 * scale), 0, 1)
    places = calm.vertices_m + np.clip((0.25 + 0.72 * low) * reach, 0.009 * scale, 0.03 * scale)[:, None] * out
    places = smoothed(places, calm.faces, 2)
    edge_z = floor_z + 0.022 * scale
    # The wall of the sole stands upright and a little out.
    centre = np.median(places[:, :2], axis=0)
    below = np.clip((edge_z + 0.004 * scale - places[:, 2]) / (0.012 * scale), 0, 1)
    places[:, 1] = centre[1] + (places[:, 1] - centre[1]) * (1 + 0.10 * below)
    places[:, 0] = centre[0] + (places[:, 0] - centre[0]) * (1 + 0.03 * below)
    height = (places[:, 2] - floor_z) / (edge_z - floor_z)
    places[:, 2] = np.where(height < 1, floor_z + (edge_z - floor_z) * np.clip(4 * height - 2.2, 0, 1), places[:, 2])
    shell = turned_in(calm.moved(places), 0.006 * scale)
    above = shell.vertices_m[:, 2] - edge_z
    return clipped(shell, above), clipped(shell, -above)


def _cut(anatomy: Anatomy, field: Float, allowed: Bool, first: Float, second: Float) -> Shell:
    """The skin where the field is not negative, carrying two channels."""
    carrying = with_channels(anatomy.skin, first, second)
    faces = within(carrying, allowed & ~anatomy.part("eyes", "cavities"))
    used = np.unique(carrying.faces[faces])
    return clipped(selected(carrying, faces), field[used])


def _collar_m(anatomy: Anatomy, points_m: Float, wide: float) -> Float:
    """(V,) distance from the border of the neck's opening, negative inside it."""
    neck, skin, scale = anatomy.joint("neck"), anatomy.skin.vertices_m, anatomy.scale
    at_neck = anatomy.part("neck") & (np.abs(skin[:, 2] - neck[2] - 0.015 * scale) < 0.02 * scale)
    half = 1.18 * wide * float(np.abs(skin[at_neck, 1]).max())
    middle = np.array((float(skin[at_neck, 0].mean()) + 0.012 * scale, 0.0, neck[2] + 0.012 * scale))
    away = np.linalg.norm((points_m - middle) / (1.2 * half, half, 1.15 * half), axis=1)
    # The opening goes no higher up the nape than this.
    below = neck[2] + 0.004 * scale + 0.25 * (points_m[:, 0] - middle[0]) - points_m[:, 2]
    return np.asarray(np.minimum((away - 1) * half, below))


def _cuff_m(anatomy: Anatomy, points_m: Float, sleeve: float) -> Float:
    """(V,) distance from the sleeve's end along the arm."""
    ends = [anatomy.joint(f"left_{name}")[1] for name in ("shoulder", "elbow", "wrist")]
    return np.asarray(np.interp(sleeve, (0, 1, 2), ends) - np.abs(points_m[:, 1]))


def _outwards(anatomy: Anatomy, points_m: Float, sleeve: float) -> Float:
    """(V,) 0 at the shoulder to 1 at the end of a short sleeve; a long one clings at the wrist."""
    shoulder, elbow, wrist = (anatomy.joint(f"left_{name}")[1] for name in ("shoulder", "elbow", "wrist"))
    along = np.interp(np.abs(points_m[:, 1]), (shoulder, elbow, wrist), (0, 1, 2))
    return np.asarray(np.clip(along, 0, 1) if sleeve <= 1 else np.interp(along, (0, 0.6, 1.6, 2), (0, 1, 0.8, 0.1)))


def _hem_z(anatomy: Anatomy) -> float:
    """Where shirts end: over the hips, above the crotch."""
    return anatomy.crotch_z + 0.022 * anatomy.scale


def _plain(anatomy: Anatomy, shell: Shell) -> Shell:
    return replace(shell, uv=cloth_uv(shell.vertices_m, anatomy.scale))


def _printed(anatomy: Anatomy, shell: Shell) -> Shell:
    """The chest on the left half of the print, the back, as seen from behind, on the right half; sleeves are plain."""
    low, high = _hem_z(anatomy), anatomy.joint("neck")[2]
    trunk = shell.weights[:, _ARMS].sum(1) < 0.5
    reach = 1.02 * float(np.abs(shell.vertices_m[trunk, 1]).max())
    down = (high - shell.vertices_m[:, 2]) / (high - low)
    across = 0.5 + 0.5 * shell.vertices_m[:, 1] / reach
    of_trunk = within(shell, trunk)
    front = shell.vertices_m[shell.faces].mean(1)[:, 0] > anatomy.joint("left_hip")[0]
    pieces = [selected(replace(shell, uv=PRINT.uv(0.5 * across, down)), of_trunk & front)]
    pieces.append(selected(replace(shell, uv=PRINT.uv(1 - 0.5 * across, down)), of_trunk & ~front))
    pieces.append(selected(_plain(anatomy, shell), ~of_trunk))
    return joined([piece for piece in pieces if len(piece.faces)])


def _hood(anatomy: Anatomy) -> Shell:
    """A thick roll around the neck, lowest and widest at the back."""
    scale, neck = anatomy.scale, anatomy.joint("neck")
    around = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    across = np.linspace(0, 2 * np.pi, 10, endpoint=False)
    behind = (1 - np.cos(around)) / 2
    radius = scale * (0.062 + 0.022 * behind)
    thick, high = scale * (0.010 + 0.022 * behind), scale * (0.012 + 0.030 * behind)
    along = np.stack((np.cos(around), np.sin(around)), axis=-1)
    rings = []
    for angle in across:
        flat = (radius + thick * np.cos(angle))[:, None] * along
        rings.append(np.column_stack((flat, high * np.sin(angle) - 0.012 * scale * behind)))
    vertices = np.stack(rings, 1).reshape(-1, 3) + neck + np.array((-0.012, 0, -0.006)) * scale
    weights = np.zeros((len(vertices), smpl.COUNT))
    weights[:, smpl.INDEX["spine3"]], weights[:, smpl.INDEX["neck"]] = 0.6, 0.4
    return Shell(vertices, tube_faces(len(around), len(across)), weights, np.ones_like(vertices), np.zeros((len(vertices), 2)))


def tube_faces(along: int, across: int) -> np.ndarray:
    """(F, 3) triangles of a closed ring of `along` rings, each of `across` vertices that turn to the right seen along the ring."""
    ring, place = np.meshgrid(np.arange(along), np.arange(across), indexing="ij")
    a, b = ring * across + place, ring * across + (place + 1) % across
    c, d = (ring + 1) % along * across + place, (ring + 1) % along * across + (place + 1) % across
    quads = np.stack((a, c, b, b, c, d), axis=-1).reshape(-1, 3)
    return np.asarray(quads, np.int32)
