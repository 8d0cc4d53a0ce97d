"""Triangles in the T-pose that follow a skeleton: what skin, clothes, hair and shoes are cut, blown up and joined from."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from edge.simulation.surface import Faces
from models.arrays import Bool, Float
from models.compiled import Counts

_ROUND = 0.7
"""How far a new vertex goes to where the normals of its edge's ends put it (Boubekeur, Alexa, "Phong tessellation", 2008)."""


@dataclass(frozen=True, eq=False)
class Shell:
    """A piece of a clothed pupil.

    Attributes:
        vertices_m: (V, 3) in the T-pose.
        faces: (F, 3) counter-clockwise seen from outside.
        weights: (V, 24) how much each joint carries each vertex.
        colours: (V, 3) sRGB, 0 to 1.
        uv: (V, 2) place in the pupil's picture; see `edge.simulation.people.paint`.
    """

    vertices_m: Float
    faces: Faces
    weights: Float
    colours: Float
    uv: Float

    @property
    def normals(self) -> Float:
        """(V, 3) unit normals, zero for a vertex without triangles."""
        return vertex_normals(self.vertices_m, self.faces)

    def painted(self, colour: Sequence[float] | Float) -> "Shell":
        """In one colour, (3,) or (V, 3)."""
        return replace(self, colours=np.broadcast_to(np.asarray(colour, np.float64), self.vertices_m.shape).copy())

    def moved(self, vertices_m: Float) -> "Shell":
        """With its vertices elsewhere."""
        return replace(self, vertices_m=vertices_m)


def vertex_normals(vertices_m: Float, faces: Faces) -> Float:
    """(V, 3) means of the triangles' normals, weighted with their areas."""
    a, b, c = (vertices_m[faces[:, corner]] for corner in range(3))
    of_faces = np.cross(b - a, c - a)
    out = np.zeros_like(vertices_m)
    for corner in range(3):
        np.add.at(out, faces[:, corner], of_faces)
    return np.asarray(out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-15))


def smoothed(values: Float, faces: Faces, rounds: int) -> Float:
    """(V, K) values moved to the mean of their neighbours, half of the way a round; along a border, of those on the border."""
    count = len(values)
    pairs, rim = edges(faces), borders(faces)
    on_rim = np.zeros(count, np.bool_)
    on_rim[rim] = True
    both = np.concatenate((pairs, pairs[:, ::-1]))
    both = np.concatenate((both[~on_rim[both[:, 0]]], rim, rim[:, ::-1]))
    links = sparse.csr_matrix((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(count, count))
    degree = np.asarray(links.sum(1)).ravel()
    step = sparse.diags(0.5 / np.maximum(degree, 1)) @ links
    stay = np.where(degree > 0, 0.5, 1.0)[:, None]
    out = np.asarray(values, np.float64)
    for _ in range(rounds):
        out = stay * out + step @ out
    return np.asarray(out)


def edges(faces: Faces) -> Counts:
    """(E, 2) each edge once, lower index first."""
    return _numbered(_sides(faces))[0]


def borders(faces: Faces) -> Counts:
    """(B, 2) edges with a triangle on one side only, in the direction in which that triangle runs."""
    directed = _sides(faces)
    pairs, number = _numbered(directed)
    return np.asarray(directed[np.bincount(number, minlength=len(pairs))[number] == 1])


def _sides(faces: Faces) -> Counts:
    """(3 F, 2) the sides of the triangles, each in its direction."""
    return faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)


def _numbered(pairs: Counts) -> tuple[Counts, Counts]:
    """(E, 2) the different pairs, lower index first, and (P,) which of them each is."""
    low, high = pairs.min(1), pairs.max(1)
    span = int(high.max(initial=0)) + 1
    key, number = np.unique(low * span + high, return_inverse=True)
    return np.stack((key // span, key % span), axis=1), number.ravel()


def within(shell: Shell, chosen: Bool) -> Bool:
    """(F,) triangles all of whose vertices are `chosen` (V,)."""
    return np.asarray(chosen[shell.faces].all(axis=1))


def selected(shell: Shell, keep: Bool) -> Shell:
    """The triangles `keep` (F,) and the vertices that they use."""
    used = np.unique(shell.faces[keep])
    renumbered = np.full(len(shell.vertices_m), -1, np.int32)
    renumbered[used] = np.arange(len(used), dtype=np.int32)
    rows = (shell.vertices_m, shell.weights, shell.colours, shell.uv)
    vertices, weights, colours, uv = (values[used] for values in rows)
    return Shell(vertices, renumbered[shell.faces[keep]], weights, colours, uv)


def joined(shells: Sequence[Shell]) -> Shell:
    """All in one, none welded to another."""
    starts = np.cumsum([0, *(len(shell.vertices_m) for shell in shells[:-1])])
    return Shell(
        np.concatenate([shell.vertices_m for shell in shells]),
        np.concatenate([shell.faces + start for shell, start in zip(shells, starts, strict=True)]).astype(np.int32),
        np.concatenate([shell.weights for shell in shells]),
        np.concatenate([shell.colours for shell in shells]),
        np.concatenate([shell.uv for shell in shells]),
    )


def clipped(shell: Shell, field: Float) -> Shell:
    """The part where `field` (V,), linear on each triangle, is not negative; triangles are cut along its zero."""
    inside = field >= 0
    of_faces = inside[shell.faces]
    count = of_faces.sum(1)
    whole = shell.faces[count == 3]
    # The corner that is alone on its side comes first; the orientation stays.
    lone_in = _turned(shell.faces[count == 1], of_faces[count == 1])
    lone_out = _turned(shell.faces[count == 2], ~of_faces[count == 2])
    cut = np.concatenate((lone_in[:, [0, 1]], lone_in[:, [0, 2]], lone_out[:, [0, 1]], lone_out[:, [0, 2]]))
    if not len(cut):
        return selected(shell, count == 3)
    pairs, number = _numbered(cut.astype(np.int64))
    number = number + len(shell.vertices_m)
    n_in, n_out = len(lone_in), len(lone_out)
    in_b, in_c = number[:n_in], number[n_in : 2 * n_in]
    out_b, out_c = number[2 * n_in : 2 * n_in + n_out], number[2 * n_in + n_out :]
    faces = np.concatenate(
        (
            whole,
            np.stack((lone_in[:, 0], in_b, in_c), 1),
            np.stack((out_b, lone_out[:, 1], lone_out[:, 2]), 1),
            np.stack((out_b, lone_out[:, 2], out_c), 1),
        )
    ).astype(np.int32)
    low, high = field[pairs[:, 0]], field[pairs[:, 1]]
    share = (low / (low - high))[:, None]

    def with_new(values: Float) -> Float:
        return np.concatenate((values, (1 - share) * values[pairs[:, 0]] + share * values[pairs[:, 1]]))

    whole_shell = Shell(with_new(shell.vertices_m), faces, with_new(shell.weights), with_new(shell.colours), with_new(shell.uv))
    return selected(whole_shell, np.ones(len(faces), np.bool_))


def _turned(faces: Faces, marked: Bool) -> Faces:
    """Each triangle begun with the one corner that is marked."""
    first = marked.argmax(1)
    return np.asarray(np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1))


def subdivided(shell: Shell) -> Shell:
    """Each triangle in four, the new vertices bent towards the curved surface."""
    pairs, number = _numbered(_sides(shell.faces))
    ab, bc, ca = (number.reshape(-1, 3) + len(shell.vertices_m)).T
    a, b, c = shell.faces.T
    faces = np.concatenate([np.stack(corners, 1) for corners in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    p, q = shell.vertices_m[pairs[:, 0]], shell.vertices_m[pairs[:, 1]]
    middle = (p + q) / 2
    normals = shell.normals
    bend = np.zeros_like(middle)
    for end, normal in ((p, normals[pairs[:, 0]]), (q, normals[pairs[:, 1]])):
        bend -= ((middle - end) * normal).sum(1, keepdims=True) * normal / 2

    def halved(values: Float) -> Float:
        return np.concatenate((values, (values[pairs[:, 0]] + values[pairs[:, 1]]) / 2))

    vertices = np.concatenate((shell.vertices_m, middle + _ROUND * bend))
    return Shell(vertices, faces.astype(np.int32), halved(shell.weights), halved(shell.colours), halved(shell.uv))


def hemmed(shell: Shell, inwards: Float) -> Shell:
    """With a strip turned in at every border, so that cloth shows its thickness.

    Args:
        shell: open.
        inwards: (V, 3) from a vertex to where its turned-in copy lies.
    """
    rim = borders(shell.faces)
    if not len(rim):
        return shell
    used, place = np.unique(rim, return_inverse=True)
    place = place.reshape(-1, 2) + len(shell.vertices_m)
    strip = np.concatenate((np.stack((rim[:, 1], rim[:, 0], place[:, 0]), 1), np.stack((rim[:, 1], place[:, 0], place[:, 1]), 1)))

    def with_copies(values: Float) -> Float:
        return np.concatenate((values, values[used]))

    return Shell(
        np.concatenate((shell.vertices_m, shell.vertices_m[used] + inwards[used])),
        np.concatenate((shell.faces, strip.astype(np.int32))),
        with_copies(shell.weights),
        with_copies(shell.colours),
        with_copies(shell.uv),
    )
