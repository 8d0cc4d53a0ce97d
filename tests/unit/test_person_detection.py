"""Heads of NanoDet made by hand: the boxes that were put in come out, in the picture's pixels."""

import numpy as np
import pytest

from edge.perception.detection import PersonDetector, decode_people, letterbox
from models.arrays import Float32, UInt8

STRIDES = (8, 16, 32)


def planes(people: list[tuple[int, int, int, tuple[float, float, float, float], float]]) -> list[Float32]:
    """Levels with people at (level, row, column), sides (left, top, right, bottom) in strides, and a logit."""
    levels = [np.full((124, 416 // stride, 416 // stride), -9.0, np.float32) for stride in STRIDES]
    for level, row, column, sides, logit in people:
        levels[level][0, row, column] = logit
        for side, length in enumerate(sides):
            # The mean of a distribution over two neighbouring bins is any length between them.
            low, share = int(length), length - int(length)
            bins = levels[level][80 + 11 * side : 91 + 11 * side, row, column]
            bins[:] = -30.0
            bins[low] = np.log(max(1 - share, 1e-12))
            bins[min(low + 1, 10)] += 30.0 + np.log(max(share, 1e-12)) if share else 0.0
    return levels


def test_a_box_is_the_mean_of_its_sides_distributions() -> None:
    boxes, scores = decode_people(planes([(1, 10, 12, (2.0, 3.5, 2.25, 4.0), 2.0)]), 0.3)
    x, y = 12.5 * 16, 10.5 * 16
    np.testing.assert_allclose(boxes, [[x - 32, y - 56, x + 36, y + 64]], atol=1e-3)
    np.testing.assert_allclose(scores, [1 / (1 + np.exp(-2.0))])


def test_of_boxes_on_one_person_the_best_is_kept_and_others_are_sorted() -> None:
    sides = (3.0, 5.0, 3.0, 5.0)
    crowd = [(1, 10, 10, sides, 1.0), (1, 10, 11, sides, 2.0), (1, 11, 10, sides, 0.5), (2, 10, 3, sides, 1.5)]
    boxes, scores = decode_people(planes(crowd), 0.3)
    np.testing.assert_allclose(scores, 1 / (1 + np.exp([-2.0, -1.5])))
    np.testing.assert_allclose(boxes[0], [11.5 * 16 - 48, 10.5 * 16 - 80, 11.5 * 16 + 48, 10.5 * 16 + 80], atol=1e-3)


def test_a_score_below_the_limit_is_nobody() -> None:
    below = planes([(0, 1, 1, (1.0, 1.0, 1.0, 1.0), -1.0)])
    for limit, found in ((0.3, 0), (0.25, 1)):
        boxes, scores = decode_people(below, limit)
        assert boxes.shape == (found, 4)
        assert scores.shape == (found,)


@pytest.mark.parametrize("size", [(1280, 720), (720, 1280), (416, 416), (200, 100), (1, 1), (3000, 17)])
def test_a_picture_of_any_size_fits_the_canvas_with_its_proportions(size: tuple[int, int]) -> None:
    canvas, scale = letterbox(np.full((*size, 3), 200, np.uint8), (416, 416))
    assert canvas.shape == (416, 416, 3)
    rows, columns = (canvas[:, :, 0] == 200).any(axis=1).sum(), (canvas[:, :, 0] == 200).any(axis=0).sum()
    assert max(rows, columns) == 416
    assert abs(rows - size[0] * scale) <= 1
    assert abs(columns - size[1] * scale) <= 1


def test_boxes_come_back_in_the_pictures_pixels_and_end_at_its_edges() -> None:
    sides = (5.0, 5.0, 5.0, 5.0)

    class Fake:
        size_px = (416, 416)

        def __call__(self, pictures: UInt8) -> dict[str, Float32]:
            assert pictures.shape == (1, 416, 416, 3)
            levels = planes([(1, 10, 10, sides, 2.0), (1, 2, 1, sides, 1.0)])
            return {f"stride{stride}": level[np.newaxis] for stride, level in zip(STRIDES, levels, strict=True)}

    boxes, _ = PersonDetector(Fake()).detect(np.zeros((832, 600, 3), np.uint8))
    centre, half = 10.5 * 16 * 2, 5 * 16 * 2
    np.testing.assert_allclose(boxes[0], np.array([centre - half, centre - half, centre + half, centre + half]) - 0.5, atol=1e-3)
    np.testing.assert_allclose(boxes[1][:2], [-0.5, -0.5])
