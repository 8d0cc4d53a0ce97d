"""Dots and stripes on a shape, each drawn by itself.

An SVG pattern would be shorter, but Chromium prints every shape that is filled with one as a picture of 100 KB.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np

from models.arrays import Float
from services.evaluation.report import svg
from services.evaluation.report.svg import Point

DOTS: Final = 0.78
STRIPES: Final = 1.1
LINES: Final = 1.6
_PITCH: Final = {"dots": DOTS, "stripes": STRIPES, "lines": LINES}
"""Millimetres from one to the next, by class of the style sheet."""
_MARGIN: Final = 0.3
"""Millimetres that they stay away from the edge, which is drawn over otherwise."""
_ALONG: Final = np.array((math.sqrt(0.5), -math.sqrt(0.5)))
_ACROSS: Final = np.array((math.sqrt(0.5), math.sqrt(0.5)))


def hatched(corners: Sequence[Point], class_: str) -> str:
    """A path over a convex shape; empty if there is no room in it. Those of neighbours go on in one another."""
    pitch = _PITCH[class_]
    ends = _chords(np.array(corners), pitch)
    return svg.strokes(_from_the_grid(ends, pitch) if class_ == "dots" else ends, class_)


def around(centre: Point, radius: float) -> list[Point]:
    """A circle as corners."""
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    return [(centre[0] + radius * math.cos(turn), centre[1] + radius * math.sin(turn)) for turn in turns]


def _chords(corners: Float, pitch: float) -> Iterator[tuple[Float, Float]]:
    """Where diagonal lines, `pitch` apart all over the paper, run within the shape."""
    across = corners @ _ACROSS
    along = corners @ _ALONG
    for count in range(math.ceil(across.min() / pitch), math.floor(across.max() / pitch) + 1):
        offset = count * pitch
        crossed = []
        for first, second in zip(range(len(corners)), [*range(1, len(corners)), 0], strict=True):
            if (across[first] <= offset) != (across[second] <= offset):
                share = (offset - across[first]) / (across[second] - across[first])
                crossed.append(along[first] + share * (along[second] - along[first]))
        if crossed and max(crossed) - min(crossed) > 2 * _MARGIN:
            yield tuple(offset * _ACROSS + place * _ALONG for place in (min(crossed) + _MARGIN, max(crossed) - _MARGIN))


def _from_the_grid(ends: Iterable[tuple[Float, Float]], pitch: float) -> Iterator[tuple[Float, Float]]:
    """Begun at whole multiples of the pitch, so that dots on neighbouring lines and shapes lie in rows."""
    for begin, end in ends:
        late = -(float(begin @ _ALONG)) % pitch
        if late < float((end - begin) @ _ALONG):
            yield begin + late * _ALONG, end
