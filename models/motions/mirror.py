"""A motion seen in a mirror that stands in the plane y = 0: left does what right did."""

from dataclasses import replace
from typing import Final

from models.motions.motion import CONTACTS, Motion
from models.skeleton import smpl

_SWAPPED: Final = [
    CONTACTS.index(name.replace("left", "other").replace("right", "left").replace("other", "right")) for name in CONTACTS
]


def mirrored(motion: Motion) -> Motion:
    """The mirror image of a motion without things; its attempts stay as they are."""
    return replace(
        motion,
        translations_m=motion.translations_m * (1.0, -1.0, 1.0),
        rotations_rad=motion.rotations_rad[:, list(smpl.MIRROR)] * (-1.0, 1.0, -1.0),
        contacts=motion.contacts[:, _SWAPPED],
    )
