"""Boxes of pixels."""

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Box:
    """Pixels from (left, top) to before (right, bottom)."""

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Columns."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Rows."""
        return self.bottom - self.top

    @property
    def empty(self) -> bool:
        """Whether there is no pixel in it."""
        return self.width <= 0 or self.height <= 0

    @property
    def as_viewport(self) -> tuple[int, int, int, int]:
        """First column, first row, columns, rows."""
        return self.left, self.top, self.width, self.height

    def touches(self, other: "Box") -> bool:
        """Whether they share a pixel."""
        return self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom


def union(boxes: Iterable[Box]) -> Box:
    """The smallest box around them."""
    some = list(boxes)
    return Box(min(b.left for b in some), min(b.top for b in some), max(b.right for b in some), max(b.bottom for b in some))


def joined(boxes: Iterable[Box]) -> list[Box]:
    """Boxes that cover the same pixels and share none; empty ones are left out."""
    apart: list[Box] = []
    for box in boxes:
        grown = box
        while touched := [other for other in apart if other.touches(grown)]:
            apart = [other for other in apart if other not in touched]
            grown = union((grown, *touched))
        if not grown.empty:
            apart.append(grown)
    return apart
