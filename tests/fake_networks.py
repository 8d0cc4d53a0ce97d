"""Networks for tests that need none: the detector finds bright spots, the pose is a fixed figure around the brightest place."""

from dataclasses import dataclass, field

import numpy as np

from edge.observe import Networks
from models.arrays import Float, Float32, UInt8
from models.messages.control import PoseNetwork as PoseNetworkName

FIGURE = np.column_stack((np.tile((-0.1, 0.1), 9)[:17], np.linspace(-0.25, 0.25, 17)))
"""(17, 2) offsets of the keypoints from the spot, in crop coordinates."""


@dataclass(frozen=True, eq=False)
class FakeEstimate:
    points: Float32
    score: Float32
    sigma: Float32


@dataclass
class FakePose:
    """Finds the centre of brightness of its crop; its score is low where all is dark."""

    name: PoseNetworkName = "thunder"
    size_px: int = 64
    calls: int = 0

    def estimate(self, crop_rgb: UInt8) -> FakeEstimate:
        self.calls += 1
        assert crop_rgb.shape == (self.size_px, self.size_px, 3)
        weight = crop_rgb[..., 0].astype(np.float64)
        weight[weight < 60] = 0
        there = weight.sum() > 0
        y, x = np.mgrid[: self.size_px, : self.size_px] + 0.5
        centre = np.array(((weight * x).sum(), (weight * y).sum())) / weight.sum() / self.size_px if there else np.full(2, 0.5)
        score = np.full(17, 0.8 if there else 0.05, np.float32)
        return FakeEstimate((FIGURE + centre).astype(np.float32), score, np.full(17, 0.01, np.float32))


@dataclass
class FakeDetector:
    """One box around everything bright."""

    half_px: float = 40.0
    calls: int = 0
    shapes: list[tuple[int, ...]] = field(default_factory=list)

    def detect(self, image_rgb: UInt8) -> tuple[Float, Float]:
        self.calls += 1
        self.shapes.append(image_rgb.shape)
        y, x = np.nonzero(image_rgb[..., 0] > 60)
        if not len(x):
            return np.empty((0, 4)), np.empty(0)
        middle = np.array((x.mean(), y.mean()))
        return np.concatenate((middle - self.half_px, middle + self.half_px))[None], np.ones(1)


def fake_networks() -> tuple[Networks, FakePose, FakeDetector]:
    """Networks, with hands on the two fakes in them."""
    pose, detector = FakePose(), FakeDetector()
    return Networks(pose, lambda: detector), pose, detector
