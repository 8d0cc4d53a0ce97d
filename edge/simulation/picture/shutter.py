"""When each row of a picture is exposed."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float


@dataclass(frozen=True)
class Shutter:
    """A camera's shutter. Time of a picture is mid-exposure of its middle row.

    Attributes:
        exposure_s: how long each row gathers light: motion blur.
        readout_s: from the first row's exposure to the last row's; 0 is a global shutter. A USB camera of today has 10 to 30 ms.
    """

    exposure_s: float = 1 / 250
    readout_s: float = 0.016

    def row_delay_s(self, rows: Float, height_px: int) -> Float:
        """Mid-exposure of pixel rows (pixel centres at whole numbers) against the picture's time."""
        return np.asarray((rows / (height_px - 1) - 0.5) * self.readout_s)
