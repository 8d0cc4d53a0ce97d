"""The formats by their names; apart, so that the command line's help need not wait for the writers."""

from enum import StrEnum

from models.errors import UserError


class Format(StrEnum):
    """What a motion can be exported as."""

    TRC = "trc"
    C3D = "c3d"
    BVH = "bvh"
    GLB = "glb"
    MOT = "mot"


def format_of(name: str) -> Format:
    """The format of that name; UserError if there is none."""
    try:
        return Format(name)
    except ValueError as error:
        raise UserError(f"there is no format '{name}'; choose one of {', '.join(Format)}") from error
