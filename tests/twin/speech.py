"""What was said of pictures, as the messages that an edge process publishes."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.messages.observation import MAX_PX, Crop, Observation, Person
from tests.twin.context import Frame
from tests.twin.truth import Said, Truth

_PICTURES_HZ: Final = 30.0
_LEAST_SIGMA_PX: Final = 1e-3


@dataclass
class Speaker:
    """One camera's edge process.

    Attributes:
        start_ns: CLOCK_MONOTONIC of the lesson's beginning.
        network: name of the pose network.
        sequence: observations so far.
        track: number of the pupil's.
    """

    start_ns: int
    network: str
    sequence: int = 0
    track: int = 0

    def say(self, truth: Truth, frame: Frame, said: Said) -> list[tuple[float, Observation]]:
        """Times of arrival, in seconds from the lesson's beginning, and observations, in the order of the pictures."""
        return [
            (float(t_s + said.delay_s[n]), self._observation(truth.camera.name, float(t_s), frame, said, n))
            for n, t_s in enumerate(truth.t_s)
        ]

    def _observation(self, camera: str, t_s: float, frame: Frame, said: Said, n: int) -> Observation:
        sequence, self.sequence = self.sequence, self.sequence + 1
        t_ns = self.start_ns + round(t_s * 1e9)
        self.track += int(said.renewed[n])
        return Observation(
            camera=camera,
            epoch=0,
            sequence=sequence,
            frame=round(t_s * _PICTURES_HZ),
            t_mid_ns=t_ns,
            t_published_ns=t_ns + round(float(said.delay_s[n]) * 1e9),
            network=self.network,
            persons=(self._person(frame, said, n),) if said.found[n] else (),
        )

    def _person(self, frame: Frame, said: Said, n: int) -> Person:
        around = Crop.around(frame.points_px[n], float(frame.lean_rad[n]), 1.0)
        crop = Crop(around.centre_x_px, around.centre_y_px, float(said.side_px[n]), around.angle_rad)
        return Person(
            track=self.track,
            crop=crop,
            keypoints_px=np.clip(said.keypoints_px[n], -MAX_PX, MAX_PX).astype(np.float32),
            sigma_px=np.maximum(said.sigma_px[n], _LEAST_SIGMA_PX).astype(np.float32),
            score=np.clip(said.score[n], 0.0, 1.0).astype(np.float32),
        )
