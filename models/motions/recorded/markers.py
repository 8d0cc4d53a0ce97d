"""Recorded markers: their places over time, as a motion capture system wrote them."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.splines import hermite

LONGEST_GAP_S: Final = 0.2


@dataclass(frozen=True, eq=False)
class Markers:
    """Places of markers on a person.

    Attributes:
        names: (M,) as the file has them, all different.
        rate_hz: frames a second; the first frame is at time zero.
        positions_m: (T, M, 3) in a world whose z is up; NaN where a marker was not seen.
    """

    names: tuple[str, ...]
    rate_hz: float
    positions_m: Float

    def __post_init__(self) -> None:
        if self.positions_m.ndim != 3 or self.positions_m.shape[1:] != (len(self.names), 3):
            raise ValueError(f"places of {len(self.names)} markers have the shape {self.positions_m.shape}")

    @property
    def times_s(self) -> Float:
        """(T,) of the frames."""
        return np.arange(len(self.positions_m)) / self.rate_hz

    def of(self, name: str) -> Float:
        """(T, 3) places of one marker; ValueError if there is none of that name."""
        return self.positions_m[:, self.names.index(name)]

    def filled(self) -> Float:
        """(T, M, 3) places, every gap no longer than `LONGEST_GAP_S` bridged by a cubic; longer ones and those at the ends stay."""
        out, times = self.positions_m.copy(), self.times_s
        for marker in range(len(self.names)):
            seen = np.flatnonzero(~np.isnan(self.positions_m[:, marker]).any(axis=1))
            if len(seen) < 2 or len(seen) == len(out):
                continue
            known = out[seen, marker]
            bridged = hermite(times[seen], known, np.gradient(known, times[seen], axis=0), times)
            after = np.searchsorted(seen, np.arange(len(out)))
            inside = (after > 0) & (after < len(seen))
            length = times[seen[np.minimum(after, len(seen) - 1)]] - times[seen[np.maximum(after - 1, 0)]]
            short = inside & (length <= LONGEST_GAP_S)
            out[short, marker] = bridged[short]
        return out
