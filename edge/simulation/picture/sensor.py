"""From light to the numbers that a camera sends: exposure, vignetting, shot and read noise, white balance, sRGB, eight bits."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from models.arrays import Float32, UInt8
from models.compiled import compiled

_NORMALS = 1 << 16
_LEVELS = 1 << 12
_WHITE_BITS = 255.0


@dataclass(frozen=True)
class Sensor:
    """A sensor with its amplifier and the camera's picture processing.

    Attributes:
        exposure: gain on light and noise alike, as an amplifier's; 1 shows a white wall in full light as white.
        full_well_e: electrons of a pixel that is just white: shot noise is its root.
        read_noise_e: standard deviation in electrons.
        vignetting: share of the light that the corners lose.
        white_balance: factors on red, green, blue that the camera sets not quite as the lamps want them.
        seed: of the noise, with the number of the frame; cameras of one lesson have different seeds.
    """

    exposure: float = 1.0
    full_well_e: float = 6000.0
    read_noise_e: float = 8.0
    vignetting: float = 0.25
    white_balance: tuple[float, float, float] = (1.0, 1.0, 1.0)
    seed: int = 0

    def develop(self, light: Float32, frame: int) -> UInt8:
        """The picture.

        Args:
            light: (H, W, 3) linear red, green, blue.
            frame: its number, for its noise.

        Returns:
            (H, W, 3) blue, green, red, as OpenCV has it. The same to the last bit whenever it is asked for.
        """
        gains = np.array(self.white_balance, np.float32) * np.float32(self.exposure)
        first = np.random.SeedSequence((self.seed, frame)).generate_state(1, np.uint64)[0]
        shading, normals, curve = _shading(light.shape[0], light.shape[1], self.vignetting), _normals(), _curve()
        noise = np.array((1 / self.full_well_e, (self.read_noise_e / self.full_well_e) ** 2), np.float32)
        return _develop(np.ascontiguousarray(light), gains, shading, noise, normals, curve, first)


@cache
def _normals() -> Float32:
    """Values of the normal distribution, each equally likely; cheaper to draw one of than to compute."""
    from scipy.special import ndtri  # noqa: PLC0415 - half a second that only rendering is to pay

    return np.asarray(ndtri((np.arange(_NORMALS) + 0.5) / _NORMALS), np.float32)


@cache
def _curve() -> UInt8:
    """sRGB (IEC 61966-2-1) of roots of linear light from 0 to 1: the root spreads the dark."""
    light = np.linspace(0, 1, _LEVELS) ** 2
    curve = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.asarray(np.round(curve * _WHITE_BITS), np.uint8)


@cache
def _shading(height: int, width: int, vignetting: float) -> Float32:
    """(H, W) share of the light that arrives: falls with the square of the distance from the middle."""
    rows, columns = np.ogrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    across, down = columns * width, rows * height
    return np.asarray(1 - vignetting * (across**2 + down**2) / (width**2 + height**2), np.float32)


@compiled
def _develop(
    light: Float32, gains: Float32, shading: Float32, noise: Float32, normals: Float32, curve: UInt8, first: np.uint64
) -> UInt8:
    height, width = light.shape[0], light.shape[1]
    out = np.empty((height, width, 3), np.uint8)
    top = np.float32(curve.shape[0] - 1)
    for row in range(height):
        # SplitMix64 (Steele et al., 2014): each row's numbers begin at a place of their own.
        state = first + np.uint64(row) * np.uint64(0xD1342543DE82EF95)
        for column in range(width):
            state += np.uint64(0x9E3779B97F4A7C15)
            drawn = state
            drawn = (drawn ^ (drawn >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            drawn = (drawn ^ (drawn >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            drawn ^= drawn >> np.uint64(31)
            for channel in range(3):
                value = max(light[row, column, channel] * shading[row, column], np.float32(0))
                spread = np.sqrt(value * noise[0] + noise[1])
                value += spread * normals[(drawn >> np.uint64(16 * channel)) & np.uint64(0xFFFF)]
                value = min(max(value * gains[channel], np.float32(0)), np.float32(1))
                out[row, column, 2 - channel] = curve[np.int64(np.sqrt(value) * top + np.float32(0.5))]
    return out
