"""What no camera's intrinsics are, however strange its lens: with such a calibration nothing could be reconstructed.

The bounds are generous, so that they refuse a slip of the pen or a damaged file and no lens: cameras of gyms see 40 to 120 degrees,
their principal points are within a tenth of the picture from its middle, and their distortion moves a corner by less than half.
"""

from typing import Final

import numpy as np

from models.camera.pinhole import Camera
from models.errors import UserError

MOST_SIDE_PX: Final = 65_535
"""Of a JPEG picture, and of any sensor."""
FOCAL_SIDES: Final = (0.05, 100.0)
"""Focal lengths in the picture's longer side: it sees 169 degrees, or half of one."""
MOST_SKEW: Final = 0.1
"""Of the focal length; pixels are squares or nearly."""
MOST_DISTORTION: Final = 10.0
"""By which a term moves the picture's farthest corner, in its distance from the principal point."""
_ORDERS: Final = (2, 4, 1, 1, 6)
"""Power of the distance with which each coefficient's term grows, relative to it."""


def require_plausible(camera: Camera) -> None:
    """Raise UserError, which names the camera and the key, if there is no such camera."""
    where = f"camera '{camera.name}'"
    if max(camera.size_px) > MOST_SIDE_PX:
        raise UserError(f"{where}: size_px {list(camera.size_px)} is no picture; give [width, height] in pixels")
    (fx, skew, cx), (_, fy, cy), _ = camera.matrix_px.tolist()
    least_px, most_px = (sides * max(camera.size_px) for sides in FOCAL_SIDES)
    if not (least_px <= fx <= most_px and least_px <= fy <= most_px):
        raise UserError(
            f"{where}: focal lengths {fx:g} and {fy:g} px are of no camera with this size_px, which has {least_px:g} to "
            f"{most_px:g}; check matrix_px[0][0] and matrix_px[1][1], or calibrate it again"
        )
    if abs(skew) > MOST_SKEW * fx:
        raise UserError(f"{where}: a skew of {skew:g} px is no camera's; check matrix_px[0][1], which is 0 as a rule")
    for row, (centre, side) in enumerate(zip((cx, cy), camera.size_px, strict=True)):
        if not -side <= centre <= 2 * side:
            raise UserError(
                f"{where}: the principal point is at {centre:g} px, farther outside of the picture than that is large; "
                f"check matrix_px[{row}][2], or calibrate it again"
            )
    reach = float(np.hypot(max(cx, camera.size_px[0] - cx) / fx, max(cy, camera.size_px[1] - cy) / fy))
    moved = max(abs(term) * reach**order for term, order in zip(camera.distortion.tolist(), _ORDERS, strict=True))
    if moved > MOST_DISTORTION:
        raise UserError(
            f"{where}: distortion would move a corner of the picture by {moved:.2g} times its distance from the middle, and no "
            f"lens by {MOST_DISTORTION:g}; check distortion (k1, k2, p1, p2, k3), or calibrate it again"
        )
