"""Surfaces as the graphics library takes them: normals, linear colours, which corners lie on one another."""

import cv2
import numpy as np
from scipy.spatial import cKDTree

from edge.simulation.surface import Faces, Surface, Texture
from models.arrays import Bool, Float, Float32, UInt8
from models.compiled import Counts, compiled

_SAME_PLACE_DECIMALS = 6


def linear(srgb: Float) -> Float:
    """sRGB from 0 to 1 to linear light (IEC 61966-2-1)."""
    return np.asarray(np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4))


def welded(vertices_m: Float) -> Counts:
    """(V,) for each vertex the first that lies at the same place: one skin, though a texture's seam runs through it."""
    _, first, group = np.unique(np.round(vertices_m, _SAME_PLACE_DECIMALS), axis=0, return_index=True, return_inverse=True)
    return np.asarray(first[group.ravel()], np.int64)


@compiled
def normals(vertices: Float, faces: Faces, welds: Counts) -> Float:
    """(V, 3) unit normals: means of the triangles' around each place, weighted with their areas.

    Args:
        vertices: (V, 3).
        faces: (F, 3), counter-clockwise seen from outside.
        welds: (V,) as `welded` gives them.
    """
    out = np.zeros_like(vertices)
    for face in range(faces.shape[0]):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
        vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for corner in range(3):
            vertex = welds[faces[face, corner]]
            out[vertex, 0] += x
            out[vertex, 1] += y
            out[vertex, 2] += z
    for vertex in range(out.shape[0]):
        if welds[vertex] == vertex:
            length = np.sqrt(out[vertex, 0] ** 2 + out[vertex, 1] ** 2 + out[vertex, 2] ** 2)
            if length > 0:
                out[vertex] /= length
    for vertex in range(out.shape[0]):
        out[vertex] = out[welds[vertex]]
    return out


def corners_of(surface: Surface) -> Float:
    """(F, 3, 11) corners of a surface that stands still: place, normal, linear colour, place in the texture."""
    count = len(surface.vertices_m)
    faces = np.ascontiguousarray(surface.faces, np.int32)
    facing = normals(np.asarray(surface.vertices_m, np.float64), faces, np.arange(count))
    uv = np.zeros((count, 2)) if surface.texture is None else surface.texture.uv
    corners: Float = np.hstack((surface.vertices_m, facing, linear(surface.colours), uv))[faces]
    return corners


def texture_places(surface: Surface) -> Float32:
    """(V, 2) place in the texture; anything without one."""
    uv = np.zeros((len(surface.vertices_m), 2)) if surface.texture is None else surface.texture.uv
    return np.asarray(uv, np.float32)


def texels(texture: Texture) -> UInt8:
    """(H, W, 4) sRGB for the graphics library."""
    return np.ascontiguousarray(cv2.cvtColor(np.ascontiguousarray(texture.picture), cv2.COLOR_RGB2RGBA))


def near_rim(vertices_m: Float, faces: Counts, within_m: float) -> Bool:
    """(F,) whether a triangle is near an edge that has no triangle on its other side.

    Only there may the inner side of a surface be seen: in a sleeve's end, not in the middle of a body.

    Args:
        vertices_m: (V, 3).
        faces: (F, 3) of welded vertices.
        within_m: how near.
    """
    count = len(vertices_m)
    ends = np.concatenate((faces[:, :2], faces[:, 1:], faces[:, ::2][:, ::-1])).astype(np.int64)
    ways, back = ends[:, 0] * count + ends[:, 1], ends[:, 1] * count + ends[:, 0]
    rim = np.unique(ends[(ends[:, 0] != ends[:, 1]) & ~np.isin(ways, back)])
    if not len(rim):
        return np.zeros(len(faces), np.bool_)
    near = cKDTree(vertices_m[rim]).query(vertices_m)[0] <= within_m
    return np.asarray(near[faces].any(1))
