"""A machine under the governor, simulated: cameras that get what its CPU allows, and the governor's states, second by second."""

from dataclasses import dataclass

from models.messages.health import CameraHealth
from services.fusion import governor
from services.fusion.governor import GovernorState, Level, Load

POSE_MS = {"thunder": 24.0, "lightning": 7.0}
DECODE_MS = 4.0
CPU_TARGET = 0.85


@dataclass
class Box:
    """A machine whose cameras get what the CPU allows: demand above capacity lowers every camera's rate alike.

    `base_cores` is what all else takes. `contention` is how much dearer everything becomes when all cores are busy.
    """

    cores: float
    base_cores: float = 0.25
    slowness: float = 1.0
    cameras: int = 4
    contention: float = 0.0
    used_cores: float = 0.0

    def stages_ms(self, level: Level) -> dict[str, float]:
        """What one inference costs now."""
        slowness = self.slowness * (1 + self.contention * self.used_cores / self.cores)
        return {"pose": POSE_MS[level.network] * slowness, "decode": DECODE_MS * slowness}

    def wanted_cores(self, level: Level) -> float:
        """What the cameras would need to get what that level asks of them."""
        return self.cameras * level.rate_hz * sum(self.stages_ms(level).values()) / 1e3

    def second(self, state: GovernorState) -> Load:
        """What is measured over a second at the state's level."""
        level = state.current
        stages_ms, wanted = self.stages_ms(level), self.wanted_cores(level)
        share = min(1.0, max(self.cores - self.base_cores, 0.0) / wanted)
        self.used_cores = min(self.cores, self.base_cores + wanted * share)
        health = CameraHealth("cam", 30.0, level.rate_hz * share, level.rate_hz, 0, 5.0, level.network, stages_ms)
        return Load(self.cores, self.used_cores, [health] * self.cameras)


def run(box: Box, seconds: int, state: GovernorState | None = None, start_s: int = 0, **limits: float) -> list[GovernorState]:
    """The state it begins with, and that after each of so many seconds."""
    limits = {"max_rate_hz": 30.0, "cpu_target": CPU_TARGET} | limits
    states = [state or GovernorState()]
    for second in range(start_s + 1, start_s + seconds + 1):
        states.append(governor.step(states[-1], box.second(states[-1]), second * 10**9, **limits))
    return states
