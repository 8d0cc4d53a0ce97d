"""Fewer vertices, each of them one of the original ones, both sides alike.

Quadric error metrics (Garland and Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997) with half-edge
collapses: a vertex is moved onto a neighbour, so that shape directions, skinning weights and labels are chosen and not
made up. The error is summed over several bodies, so that a mesh that suits a child suits an adult, too. Every collapse is done on
both sides of the body.
"""

import heapq

import numpy as np

from models.arrays import Float

_FLATTEST_TURN = 0.2
"""Cosine beyond which a collapse counts as a fold of the surface."""
_MOST_NEIGHBOURS = 12


class _Mesh:
    def __init__(self, bodies: Float, faces: np.ndarray, mirror: np.ndarray, importance: Float) -> None:
        self.bodies = bodies
        self.mirror = [int(other) for other in mirror]
        self.faces: dict[int, tuple[int, int, int]] = {index: (int(a), int(b), int(c)) for index, (a, b, c) in enumerate(faces)}
        self.faces_at: dict[int, set[int]] = {vertex: set() for vertex in range(len(mirror))}
        for index, face in self.faces.items():
            for vertex in face:
                self.faces_at[vertex].add(index)
        self.quadrics = _quadrics(bodies, faces, importance)

    def neighbours(self, vertex: int) -> set[int]:
        return {other for face in self.faces_at[vertex] for other in self.faces[face]} - {vertex}

    def cost(self, moved: int, onto: int) -> float:
        place = np.column_stack((self.bodies[:, onto], np.ones(len(self.bodies))))
        quadric = self.quadrics[:, moved] + self.quadrics[:, onto]
        return float(np.einsum("si,sij,sj->", place, quadric, place)) + 1e-9 * float(
            np.sum((self.bodies[:, moved] - self.bodies[:, onto]) ** 2)
        )

    def allows(self, moved: int, onto: int) -> bool:
        around, target, twin = self.neighbours(moved), self.neighbours(onto), self.mirror[moved]
        if len(around & target) != 2 or len(around | target) - 2 > _MOST_NEIGHBOURS:
            return False
        if twin != moved:
            if twin in around:
                return False
            shared = around & self.neighbours(twin)
            onto_middle = self.mirror[onto] == onto
            if (onto_middle and not shared <= target | {onto}) or (not onto_middle and self.mirror[onto] in around):
                return False
        return not self._folds(moved, onto)

    def _folds(self, moved: int, onto: int) -> bool:
        kept = [self.faces[face] for face in self.faces_at[moved] if onto not in self.faces[face]]
        before = np.array(kept)
        after = np.where(before == moved, onto, before)
        old, new = (_normals(self.bodies, corners) for corners in (before, after))
        return bool((np.sum(old * new, axis=-1) < _FLATTEST_TURN).any())

    def collapse(self, moved: int, onto: int) -> None:
        for face in list(self.faces_at[moved]):
            corners = self.faces[face]
            if onto in corners:
                for vertex in corners:
                    self.faces_at[vertex].discard(face)
                del self.faces[face]
            else:
                a, b, c = (onto if vertex == moved else vertex for vertex in corners)
                self.faces[face] = (a, b, c)
                self.faces_at[onto].add(face)
        self.quadrics[:, onto] += self.quadrics[:, moved]
        del self.faces_at[moved]


def decimate(bodies: Float, faces: np.ndarray, mirror: np.ndarray, importance: Float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Choose about `count` vertices.

    Args:
        bodies: (S, V, 3) the same closed, symmetric mesh in several shapes, metres, y to the left.
        faces: (F, 3) its triangles.
        mirror: (V,) each vertex' counterpart on the other side.
        importance: (V,) factor on the error at each vertex.
        count: of vertices to keep.

    Returns:
        (count,) indices of the vertices kept, ascending, and (G, 3) triangles in terms of their places in that list.
    """
    mesh = _Mesh(bodies, faces, mirror, importance)
    left = [vertex for vertex in range(len(mirror)) if bodies[0, vertex, 1] > 0 or mesh.mirror[vertex] == vertex]
    on_our_side = set(left)
    version = dict.fromkeys(left, 0)
    heap: list[tuple[float, int, int, int]] = []

    def offer(vertex: int) -> None:
        middle = mesh.mirror[vertex] == vertex
        version[vertex] += 1
        candidates = [other for other in mesh.neighbours(vertex) & on_our_side if not middle or mesh.mirror[other] == other]
        for cost, other in sorted((mesh.cost(vertex, other), other) for other in candidates):
            if mesh.allows(vertex, other):
                heapq.heappush(heap, (cost, vertex, other, version[vertex]))
                return

    for vertex in left:
        offer(vertex)
    while len(mesh.faces_at) > count and heap:
        _, moved, onto, asked = heapq.heappop(heap)
        if moved not in mesh.faces_at or version[moved] != asked:
            continue
        if onto not in mesh.faces_at or not mesh.allows(moved, onto):
            offer(moved)
            continue
        changed = mesh.neighbours(moved)
        twin, twins_target = mesh.mirror[moved], mesh.mirror[onto]
        mesh.collapse(moved, onto)
        if twin != moved:
            mesh.collapse(twin, twins_target)
        for vertex in sorted((changed | mesh.neighbours(onto)) & on_our_side):
            offer(vertex)
    kept = np.array(sorted(mesh.faces_at))
    place = {int(vertex): index for index, vertex in enumerate(kept)}
    return kept, np.array([[place[vertex] for vertex in mesh.faces[face]] for face in sorted(mesh.faces)])


def _normals(bodies: Float, corners: np.ndarray) -> Float:
    a, b, c = (bodies[:, corners[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    return np.asarray(normals / (np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-15))


def _quadrics(bodies: Float, faces: np.ndarray, importance: Float) -> Float:
    """(S, V, 4, 4) sum of the squared distances to the planes of each vertex' triangles, weighted by area and importance."""
    out = np.zeros((*bodies.shape[:2], 4, 4))
    for body, quadrics in zip(bodies, out, strict=True):
        a, b, c = (body[faces[:, corner]] for corner in range(3))
        normals = np.cross(b - a, c - a)
        twice_area = np.linalg.norm(normals, axis=1)
        normals /= twice_area[:, None] + 1e-15
        planes = np.column_stack((normals, -np.sum(normals * a, axis=1)))
        squares = planes[:, :, None] * planes[:, None, :] * (twice_area / 6)[:, None, None]
        for corner in range(3):
            np.add.at(quadrics, faces[:, corner], squares)
    return out * importance[:, None, None]
