"""The gymnastics mat: where it lies on the floor for an action that begins at the origin and looks along x."""

from typing import Final

HEIGHT_M: Final = 0.04
LENGTH_M: Final = 2.0
WIDTH_M: Final = 1.0
FROM_M: Final = 0.22
"""x at which it begins, before the toes of whoever stands at the origin; its length is along x, its middle at y = 0."""
