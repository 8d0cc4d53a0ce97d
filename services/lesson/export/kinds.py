"""The formats by their names; apart, so that the command line's help need not wait for the writers."""

from enum import StrEnum


class Format(StrEnum):
    """What a motion can be exported as."""

    TRC = "trc"
    C3D = "c3d"
    BVH = "bvh"
    GLB = "glb"
    MOT = "mot"
