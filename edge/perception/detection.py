"""NanoDet's heads decoded in numpy: from a picture to boxes around people.

Source: RangiLyu, NanoDet; Li et al., "Generalized Focal Loss", NeurIPS 2020: each side of a box is the mean of a distribution over
whole strides.
"""

from pathlib import Path

import cv2
import numpy as np

from edge.perception.networks import Network, Provider, load_network
from models.arrays import Float, Float32, UInt8

SCORE_MIN = 0.3
"""A box of a lower score is nobody. Plain side views of a person score 0.3, so a tracker may pass 0.25."""
_OVERLAP_MAX = 0.5
_STRIDES = (8, 16, 32)
_PERSON = 0
_CLASSES = 80
_BINS = 11
_GREY = 114
"""Colour around a picture that is not square: finds as much as black does, with a tenth fewer false boxes on the demo videos."""


class PersonDetector:
    """A NanoDet that takes a whole picture of any size and gives the people in it."""

    def __init__(self, network: Network, score_min: float = SCORE_MIN) -> None:
        self._network = network
        self._score_min = score_min

    def detect(self, image_rgb: UInt8) -> tuple[Float, Float]:
        """Find people in a picture (height, width, 3).

        Returns:
            Boxes (n, 4) as x0, y0, x1, y1 in pixels of the picture (pixel centres at whole numbers, clipped to the picture) and
            scores (n,) in [0, 1], best first.
        """
        height, width = image_rgb.shape[:2]
        canvas, scale = letterbox(image_rgb, self._network.size_px)
        planes = self._network(canvas[np.newaxis])
        boxes, scores = decode_people([planes[f"stride{stride}"][0] for stride in _STRIDES], self._score_min)
        # Edges of the canvas's pixels to centres of the picture's: the picture lies in the canvas's upper left corner.
        boxes = np.clip(boxes / scale, 0.0, (width, height, width, height)) - 0.5
        return boxes, scores


def load_person_detector(data: Path, provider: Provider = "cpu", score_min: float = SCORE_MIN) -> PersonDetector:
    """Load NanoDet from the data folder; UserError as `load_network`."""
    return PersonDetector(load_network("nanodet", data, provider), score_min)


def letterbox(image_rgb: UInt8, size_px: tuple[int, int]) -> tuple[UInt8, float]:
    """Fit a picture into the upper left of a canvas (height, width), proportions kept; also the scale that did it."""
    height, width = image_rgb.shape[:2]
    scale = min(size_px[0] / height, size_px[1] / width)
    rows, columns = min(size_px[0], round(height * scale)), min(size_px[1], round(width * scale))
    canvas = np.full((*size_px, 3), _GREY, np.uint8)
    interpolation = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    canvas[:rows, :columns] = cv2.resize(image_rgb, (columns, rows), interpolation=interpolation)
    return canvas, scale


def decode_people(planes: list[Float32], score_min: float) -> tuple[Float, Float]:
    """Boxes (n, 4) of people in canvas pixels and scores (n,), best first, overlapping ones removed.

    Args:
        planes: for the strides 8, 16 and 32, (124, rows, columns): 80 classes (logits), then 4 x 11 logits for the sides.
        score_min: see `SCORE_MIN`.
    """
    found = [_decode_level(level, stride, score_min) for level, stride in zip(planes, _STRIDES, strict=True)]
    boxes = np.concatenate([boxes for boxes, _ in found])
    scores = np.concatenate([scores for _, scores in found])
    kept = _suppress(boxes, scores)
    return boxes[kept], scores[kept]


def _decode_level(planes: Float32, stride: int, score_min: float) -> tuple[Float, Float]:
    logit_min = np.log(score_min / (1 - score_min))
    rows, columns = np.nonzero(planes[_PERSON] >= logit_min)
    scores = 1 / (1 + np.exp(-planes[_PERSON, rows, columns].astype(np.float64)))
    logits = planes[_CLASSES:, rows, columns].astype(np.float64).reshape(4, _BINS, -1)
    shares = np.exp(logits - logits.max(axis=1, keepdims=True))
    sides = (shares * np.arange(_BINS)[:, np.newaxis]).sum(axis=1) / shares.sum(axis=1) * stride  # (4, n)
    x, y = (columns + 0.5) * stride, (rows + 0.5) * stride
    return np.stack((x - sides[0], y - sides[1], x + sides[2], y + sides[3]), axis=1), scores


def _suppress(boxes: Float, scores: Float) -> list[int]:
    """Indices of the boxes to keep, best first: none overlaps a better one by more than `_OVERLAP_MAX` of their union."""
    order = np.argsort(-scores, kind="stable")
    areas = np.prod(boxes[:, 2:] - boxes[:, :2], axis=1)
    kept: list[int] = []
    while order.size:
        best, rest = order[0], order[1:]
        kept.append(int(best))
        low = np.maximum(boxes[best, :2], boxes[rest, :2])
        high = np.minimum(boxes[best, 2:], boxes[rest, 2:])
        shared = np.prod(np.clip(high - low, 0, None), axis=1)
        order = rest[shared <= _OVERLAP_MAX * (areas[best] + areas[rest] - shared)]
    return kept
