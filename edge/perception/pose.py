"""MoveNet's heads decoded in numpy: from one crop to 17 keypoints with score and standard deviation.

Source: the decoding tail of MoveNet SinglePose (Google, TensorFlow Hub), in which the person is the peak of the centre heatmap,
weighted towards the crop's centre, and a joint is the peak of its heatmap, weighted towards where the person's centre expects it.
The tail takes one cell's word for the place. Here the cells around the peak vote (`vote`): on the demo footage that takes 15 % off
the jitter (second difference) and leaves the agreement between the cameras as it is.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from edge.perception.networks import Network, Provider, load_network
from models.arrays import Float32, UInt8
from models.errors import UserError
from models.make_command import make_command
from models.messages.control import PoseNetwork as PoseNetworkName
from models.skeleton import coco

_NEAR = np.float32(1.7998046875)
"""Cells added to a distance before dividing by it: the constant of MoveNet's tail."""
_VOTE_RADIUS = 2
_TOP_LEFT = np.float32(0.0016)
"""How far MoveNet places everything to the left and above, over the crop's side: half a pixel of its training pictures, whose
annotations count pixels and not their edges. Measured: mirrored crops disagree by twice this, with both networks."""


@dataclass(frozen=True)
class Spread:
    """How the standard deviation of a joint, in cells of the heads, follows from its score and from how its votes agree.

    sigma^2 = exp(2 (log_best + per_doubt (1 - score)))  +  (per_dissent max(0, dissent - 0.4))^2

    The numbers come from the built-in footage (`tests/bench/pose_sigma.py`): each camera's keypoint against the point that the
    three others triangulate, whose own uncertainty is taken off. On frames not used for the fit, 0.39 (Thunder) and 0.37
    (Lightning) of the errors lie within one sigma, as of a normal distribution (0.39); the tails are heavier (three sigma hold
    92 and 95 %, not 99 %), so whoever uses sigma must be robust. The error of that footage's calibration is contained in it.
    """

    log_best: float
    per_doubt: float
    per_dissent: float


_SPREADS: dict[PoseNetworkName, Spread] = {
    "thunder": Spread(log_best=-1.04, per_doubt=1.99, per_dissent=3.4),
    "lightning": Spread(log_best=-1.09, per_doubt=1.66, per_dissent=2.9),
}
_DISSENT_MIN = np.float32(0.4)


@dataclass(frozen=True, eq=False)
class PoseEstimate:
    """Keypoints of the person nearest to a crop's centre.

    Attributes:
        points: (17, 2) x, y in crop coordinates: 0 and 1 are the outer edges of the crop, so the centre of pixel i of n lies at
            (i + 0.5) / n.
        score: (17,) the network's confidence in [0, 1].
        sigma: (17,) one standard deviation per axis in crop coordinates.
    """

    points: Float32
    score: Float32
    sigma: Float32


@dataclass(frozen=True, eq=False)
class Peaks:
    """The cell that MoveNet's own tail chooses for each joint.

    Attributes:
        rows: (17,) of the cell.
        columns: (17,) of the cell.
        scores: (17, cells, cells) every cell's confidence.
        expected: (17, 2) row, column where the person's centre expects the joint, in cells.
    """

    rows: np.ndarray[tuple[int], np.dtype[np.intp]]
    columns: np.ndarray[tuple[int], np.dtype[np.intp]]
    scores: Float32
    expected: Float32


class PoseNetwork:
    """A MoveNet that takes a crop and gives a pose."""

    def __init__(self, name: PoseNetworkName, network: Network) -> None:
        self._name: PoseNetworkName = name
        self._network = network

    @property
    def name(self) -> PoseNetworkName:
        """As fusion's view control calls it."""
        return self._name

    @property
    def size_px(self) -> int:
        """Side of the square crop that it takes."""
        return self._network.size_px[0]

    def estimate(self, crop_rgb: UInt8) -> PoseEstimate:
        """Keypoints of the person nearest to the centre of a crop (size_px, size_px, 3).

        Somebody is always found: without a person in the crop the scores are low.
        """
        heads = self._network(crop_rgb[np.newaxis])
        maps = (heads["centre"][0], heads["heatmaps"][0], heads["regressions"][0], heads["offsets"][0])
        return decode_pose(*maps, _SPREADS[self._name])


def load_pose_network(name: PoseNetworkName, data: Path, provider: Provider = "cpu") -> PoseNetwork:
    """Load Thunder or Lightning from the data folder; UserError as `load_network`."""
    network = load_network(f"movenet-{name}", data, provider)
    if network.size_px[0] != network.size_px[1]:
        raise UserError(
            f"network movenet-{name}: takes {network.size_px} pixels, not a square; run {make_command('networks', data)}"
        )
    return PoseNetwork(name, network)


def decode_pose(centre: Float32, heatmaps: Float32, regressions: Float32, offsets: Float32, spread: Spread) -> PoseEstimate:
    """Decode the heads of one crop.

    Args:
        centre: (1, n, n) logits of a person's centre.
        heatmaps: (17, n, n) logits of the joints.
        regressions: (34, n, n) from a cell, taken as a person's centre, to the joints: row, column of each, in cells.
        offsets: (34, n, n) from a cell to the exact place of the joint that is near it: row, column of each, in cells.
        spread: the calibration of this network.
    """
    peaks = find_peaks(centre, heatmaps, regressions)
    points, dissent = vote(peaks, offsets)
    score = peaks.scores[np.arange(coco.COUNT), peaks.rows, peaks.columns]
    cells = np.float32(heatmaps.shape[-1])
    return PoseEstimate(points / cells + _TOP_LEFT, score, _sigma(score, dissent, spread) / cells)


def find_peaks(centre: Float32, heatmaps: Float32, regressions: Float32) -> Peaks:
    """Choose the person nearest to the crop's centre and a cell for each joint, as MoveNet's own tail does."""
    cells = heatmaps.shape[-1]
    middle = np.array(((cells // 2, cells // 2),), np.float32)
    person = int(np.argmax(_sigmoid(centre) / (_distances(middle, cells) + _NEAR)))
    row, column = divmod(person, cells)
    expected = regressions[:, row, column].reshape(-1, 2) + np.array((row, column), np.float32)
    scores = _sigmoid(heatmaps)
    near = _distances(expected, cells)
    near += _NEAR
    best = np.argmax(np.divide(scores, near, out=near).reshape(coco.COUNT, -1), axis=1)
    rows, columns = np.divmod(best, cells)
    return Peaks(rows, columns, scores, expected)


def _sigmoid(logits: Float32) -> Float32:
    # By the hyperbolic tangent, which cannot overflow.
    result: Float32 = np.tanh(logits * np.float32(0.5))
    result *= np.float32(0.5)
    result += np.float32(0.5)
    return result


def _distances(places: Float32, cells: int) -> Float32:
    """Distance (k, cells, cells) of every cell to each of the places (k, 2), row and column."""
    axis = np.arange(cells, dtype=np.float32)
    away = np.square(axis - places[:, :, np.newaxis])  # (k, 2, cells)
    squared: Float32 = away[:, 0, :, np.newaxis] + away[:, 1, np.newaxis, :]
    return np.sqrt(squared, out=squared)


_WINDOW = np.mgrid[-_VOTE_RADIUS : _VOTE_RADIUS + 1, -_VOTE_RADIUS : _VOTE_RADIUS + 1].reshape(2, -1)
_JOINTS = np.arange(coco.COUNT)[:, np.newaxis]


def vote(peaks: Peaks, offsets: Float32) -> tuple[Float32, Float32]:
    """Where the cells around each peak see the joint: their mean (17, 2) as x, y and their dissent (17,), in cells.

    Every cell near a joint was trained to point at it, so the cells of the window are so many measurements of one place; each
    counts by its score.
    """
    cells = offsets.shape[-1]
    rows = np.clip(peaks.rows[:, np.newaxis] + _WINDOW[0], 0, cells - 1)
    columns = np.clip(peaks.columns[:, np.newaxis] + _WINDOW[1], 0, cells - 1)
    # Where nobody is, every score may be zero to the last bit; then all cells count alike.
    weights = peaks.scores[_JOINTS, rows, columns] + np.finfo(np.float32).tiny
    weights /= weights.sum(axis=1, keepdims=True)
    y = rows + offsets[2 * _JOINTS, rows, columns]
    x = columns + offsets[2 * _JOINTS + 1, rows, columns]
    votes = np.stack((x, y), axis=-1).astype(np.float32)  # (17, votes, 2)
    mean: Float32 = (weights[..., np.newaxis] * votes).sum(axis=1)
    variance = (weights[..., np.newaxis] * np.square(votes - mean[:, np.newaxis])).sum(axis=(1, 2)) / 2
    dissent: Float32 = np.sqrt(variance)
    return mean, dissent


def _sigma(score: Float32, dissent: Float32, spread: Spread) -> Float32:
    """Standard deviation (17,) per axis in cells; see `Spread`."""
    by_score = np.exp(np.float32(spread.log_best) + np.float32(spread.per_doubt) * (1 - score))
    by_dissent = np.float32(spread.per_dissent) * np.maximum(dissent - _DISSENT_MIN, 0)
    sigma: Float32 = np.hypot(by_score, by_dissent)
    return sigma
