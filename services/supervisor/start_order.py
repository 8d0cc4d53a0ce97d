"""Who starts first. A figure takes fusion, the page and two cameras; on two cores the others would only keep it waiting. Pure."""

from collections.abc import Collection, Iterable
from itertools import combinations

from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.process import EDGE, RECORDER
from services.supervisor.child import ChildSpec

LATEST_S = 5.0
"""After this long nobody is waited for any more: the first may be slow, broken, or compiling for a minute."""


def first(specs: Iterable[ChildSpec], rig: Rig) -> set[str]:
    """The names of the processes that a figure takes: all but the recorder and the cameras beyond two.

    Args:
        specs: the processes of the box.
        rig: its cameras. The two whose views are nearest to a right angle are chosen, since they know a joint best.
    """
    pair = {camera.name for camera in min(combinations(rig, 2), key=_cosine, default=tuple(rig))}
    return {spec.name for spec in specs if spec.entry != RECORDER and (spec.entry != EDGE or spec.camera in pair)}


def others_may_start(awaited: Collection[str], present: Collection[str], since_start_s: float) -> bool:
    """Whether those that are not `first` may start: all who are awaited are at work, or have had their time."""
    return since_start_s >= LATEST_S or set(awaited) <= set(present)


def _cosine(pair: tuple[Camera, Camera]) -> float:
    """Of the angle between two optical axes, without its sign: 0 is a right angle."""
    one, other = pair
    return abs(float(one.rotation[2] @ other.rotation[2]))
