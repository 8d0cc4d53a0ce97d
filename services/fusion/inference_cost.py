"""What an inference costs, learnt from what the cameras report, also for the network that does not run just now.

A network's cost on a machine is not a constant: two busy cores share caches and memory, others use the processor, and an inference
has cost 25 ms in one minute and 40 in the next. So what runs is averaged over some seconds, and what was measured of the
other network fades, over a minute, into what the running one lets expect.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from models.messages.health import CameraHealth

RELATIVE_POSE_COST: Final = {"thunder": 1.0, "lightning": 0.28}
"""The networks alone; decoding and cropping are the same for both (measured: 24-35 and 7-10 ms)."""
_FOLLOWS: Final = 0.2
"""Weight of the newest second for what runs."""
_FADES: Final = 0.02
"""Share of the distance, each second, by which what does not run nears what is expected."""


_MOST: Final = 1e6
"""No rate in Hz and no time in ms is larger."""


def believable(camera: CameraHealth) -> bool:
    """Whether a camera can have measured that. One figure that is none would stay in every average for ever."""
    figures = (camera.source_hz, camera.fresh_hz, camera.target_hz, *camera.stage_ms.values())
    return camera.network in RELATIVE_POSE_COST and all(0 <= figure <= _MOST for figure in figures)


@dataclass(frozen=True)
class InferenceCost:
    """CPU milliseconds of one inference.

    Attributes:
        pose_ms: of each network that has run, the network alone.
        other_ms: decoding, cropping, detecting, encoding; None before anything was measured.
    """

    pose_ms: dict[str, float] = field(default_factory=dict)
    other_ms: float | None = None

    def learn(self, cameras: Sequence[CameraHealth]) -> "InferenceCost":
        """What is known after another second."""
        measured = [camera for camera in cameras if camera.fresh_hz > 0 and "pose" in camera.stage_ms]
        if not measured:
            return self
        known = dict(self.pose_ms)
        for network in {camera.network for camera in measured}:
            newest = [camera.stage_ms["pose"] for camera in measured if camera.network == network]
            known[network] = _towards(known.get(network), sum(newest) / len(newest), _FOLLOWS)
        running = {camera.network for camera in measured}
        for network in known.keys() - running:
            known[network] = _towards(known[network], _expected(known, running, network), _FADES)
        others = [sum(camera.stage_ms.values()) - camera.stage_ms["pose"] for camera in measured]
        return InferenceCost(known, _towards(self.other_ms, sum(others) / len(others), _FOLLOWS))

    def of(self, network: str) -> float:
        """Cost of a whole inference; 0 while nothing is known."""
        if not self.pose_ms:
            return 0.0
        pose = self.pose_ms[network] if network in self.pose_ms else _expected(self.pose_ms, set(self.pose_ms), network)
        return pose + (self.other_ms or 0.0)


def _expected(known: dict[str, float], running: set[str], network: str) -> float:
    """What `network` would cost where those that run cost what they do."""
    guesses = [known[other] * RELATIVE_POSE_COST[network] / RELATIVE_POSE_COST[other] for other in running]
    return sum(guesses) / len(guesses)


def _towards(before: float | None, newest: float, weight: float) -> float:
    return newest if before is None else before + weight * (newest - before)
