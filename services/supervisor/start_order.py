"""Who starts first. A figure takes fusion, the page and two cameras; on two cores the others would only keep it waiting. Pure."""

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations

from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.process import EDGE, EVALUATION, RECORDER, REPLAY
from services.supervisor.child import ChildSpec

HEAD_START_S = 1.5
"""So long the first have been at work before the others start: they find the pupil, and the page draws."""
LATEST_S = 5.0
"""After this long nobody is waited for any more: the first may be slow, broken, or compiling for a minute."""


def first(specs: Collection[ChildSpec], rig: Rig) -> set[str]:
    """The names of the processes that a figure takes: all but the evaluation, the recorder and the cameras beyond two.

    Args:
        specs: the processes of the box.
        rig: its cameras. The two whose views are nearest to a right angle are chosen, since they know a joint best. A replay, which
            runs none, starts whole.
    """
    pair = {camera.name for camera in min(combinations(rig, 2), key=_cosine, default=tuple(rig))}
    entries = {spec.entry for spec in specs}
    later = {EVALUATION, RECORDER} if REPLAY not in entries else set()
    return {spec.name for spec in specs if spec.entry not in later and (spec.entry != EDGE or spec.camera in pair)}


@dataclass
class HeadStart:
    """Of the first before the others. `awaited`: their names; `began_s`: when they were started, on CLOCK_MONOTONIC."""

    awaited: Collection[str]
    began_s: float
    _complete_s: float | None = None

    def is_over(self, present: Collection[str], now_s: float) -> bool:
        """Whether the others may start: all who are awaited have been at work for long enough, or have had their time."""
        if self._complete_s is None and set(self.awaited) <= set(present):
            self._complete_s = now_s
        return now_s - self.began_s >= LATEST_S or (self._complete_s is not None and now_s - self._complete_s >= HEAD_START_S)


def _cosine(pair: tuple[Camera, Camera]) -> float:
    """Of the angle between two optical axes, without its sign: 0 is a right angle."""
    one, other = pair
    return abs(float(one.rotation[2] @ other.rotation[2]))
