"""Whether the cameras agree: a camera whose view is rejected again and again was moved, or its calibration is wrong. Pure.

A joint that fusion is sure of (`SEEN`) names the views that agreed on it. A view can be left out for good reasons, as when somebody
stands in between, but a camera that sees a person and is left out of most joints does not stand where the calibration has it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from services.doctor.finding import Finding

MIN_JOINTS = 300
"""Half a second of a whole person; fewer say nothing."""
MIN_OBSERVATIONS = 8
MIN_PERSON_SHARE = 0.5
MIN_AGREEMENT = 0.6
"""In simulation a camera that is turned by one degree agrees in 88 % of the joints, by two degrees in 48 %, a good one in 99 %; the
four of the built-in footage agree in 97 to 99 %."""
FRESH_MS = 200.0
_PERSON_JOINTS = 9
_PERSON_SCORE = 0.3


@dataclass
class Agreement:
    """What was counted of one camera.

    Attributes:
        observations, persons: how many came, and in how many somebody was seen.
        joints: joints that fusion was sure of while the camera's view was fresh.
        agreed: in how many of these the camera's view took part.
    """

    observations: int = 0
    persons: int = 0
    joints: int = 0
    agreed: int = 0

    @property
    def doubtful(self) -> bool:
        """Whether the camera sees somebody and is rejected most of the time."""
        sees = self.observations >= MIN_OBSERVATIONS and self.persons >= MIN_PERSON_SHARE * self.observations
        return sees and self.joints >= MIN_JOINTS and self.agreed < MIN_AGREEMENT * self.joints


@dataclass
class Agreements:
    """Counts of all cameras, by name."""

    cameras: dict[str, Agreement] = field(default_factory=dict)

    def add_observation(self, observation: Observation) -> None:
        """Count what a camera saw."""
        camera = self.cameras.setdefault(observation.camera, Agreement())
        camera.observations += 1
        camera.persons += any((person.score > _PERSON_SCORE).sum() >= _PERSON_JOINTS for person in observation.persons)

    def add_motion(self, motion: Motion) -> None:
        """Count which views agreed on a figure."""
        seen = motion.states == JointState.SEEN
        for index, use in enumerate(motion.cameras):
            if not use.age_ms <= FRESH_MS:  # NaN is none, too
                continue
            camera = self.cameras.setdefault(use.camera, Agreement())
            camera.joints += int(seen.sum())
            camera.agreed += int(np.count_nonzero((motion.views[seen] >> np.uint32(index)) & np.uint32(1)))


def judge_agreement(agreements: Agreements, cameras: Iterable[str], calibration: str) -> list[Finding]:
    """What to say of cameras that do not agree with the others."""
    doubtful = [name for name in cameras if name in agreements.cameras and agreements.cameras[name].doubtful]
    findings = []
    for name in doubtful:
        counted = agreements.cameras[name]
        share = 1 - counted.agreed / counted.joints
        words = (
            f"the calibration of camera '{name}' is doubtful: {share:.0%} of its view is rejected, since the other cameras disagree"
        )
        known_by = f"which views agreed on {counted.joints} joints of the live figure"
        remedy = (
            f"put the camera back where it was or calibrate it again ({calibration}); with two persons in view, ask again with one"
        )
        findings.append(Finding("warning", f"camera '{name}'", words, known_by, remedy))
    return findings
