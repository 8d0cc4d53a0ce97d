"""How the body is divided: each part's errors are drawn from one neighbour, given those of the parts before it.

Errors of a whole body come out jointly if they are drawn at once, but then no neighbour is near in everything; in parts, neighbours
are nearer, and what holds the parts together must be asked for: the shoulders' errors of the arms, the left arm's mistakes of the
right one.
"""

from dataclasses import dataclass
from typing import Final

from models.skeleton import coco


@dataclass(frozen=True)
class Part:
    """Some joints.

    Attributes:
        name: for tables.
        joints: whose errors are drawn.
        beside: other joints, whose place in the picture counts, too: what the part may be mistaken for.
        given: joints of earlier parts, whose errors in the same picture count.
    """

    name: str
    joints: tuple[int, ...]
    beside: tuple[int, ...] = ()
    given: tuple[int, ...] = ()


Partition = tuple[Part, ...]


def _joints(*names: str) -> tuple[int, ...]:
    """Both sides' joints of these names."""
    return tuple(index for index, name in enumerate(coco.NAMES) if name.split("_")[-1] in names)


def _one_side(side: str, *names: str) -> tuple[int, ...]:
    return tuple(coco.INDEX[f"{side}_{name}"] for name in names)


_TRUNK: Final = Part("head and trunk", _joints("nose", "eye", "ear", "shoulder", "hip"))
_ARM, _LEG = ("elbow", "wrist"), ("knee", "ankle")

WHOLE: Final[Partition] = (Part("whole body", tuple(range(coco.COUNT))),)
THIRDS: Final[Partition] = (
    _TRUNK,
    Part("arms", _joints(*_ARM), given=_joints("shoulder")),
    Part("legs", _joints(*_LEG), given=_joints("hip")),
)
FIFTHS: Final[Partition] = (
    _TRUNK,
    Part("left arm", _one_side("left", *_ARM), beside=_one_side("right", *_ARM), given=_joints("shoulder")),
    Part(
        "right arm",
        _one_side("right", *_ARM),
        beside=_one_side("left", *_ARM),
        given=(*_joints("shoulder"), *_one_side("left", *_ARM)),
    ),
    Part("left leg", _one_side("left", *_LEG), beside=_one_side("right", *_LEG), given=_joints("hip")),
    Part(
        "right leg", _one_side("right", *_LEG), beside=_one_side("left", *_LEG), given=(*_joints("hip"), *_one_side("left", *_LEG))
    ),
)
PARTITIONS: Final = {"whole": WHOLE, "thirds": THIRDS, "fifths": FIFTHS}
