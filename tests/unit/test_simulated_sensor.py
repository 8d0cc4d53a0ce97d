"""The sensor: the same numbers twice, noise as its figures say, sRGB, and light that falls off towards the corners."""

import numpy as np
import pytest

from edge.simulation.picture.sensor import Sensor
from models.arrays import Float, Float32

SHAPE = (120, 160, 3)


def even(level: float) -> Float32:
    return np.full(SHAPE, level, np.float32)


def linear(srgb: Float) -> Float:
    share = srgb / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def test_a_seed_and_a_frame_give_the_same_bytes_and_others_do_not() -> None:
    light = even(0.2)
    first = Sensor(seed=4).develop(light, 7)
    assert np.array_equal(first, Sensor(seed=4).develop(light.copy(), 7))
    assert not np.array_equal(first, Sensor(seed=5).develop(light, 7))
    assert not np.array_equal(first, Sensor(seed=4).develop(light, 8))


def test_neighbours_and_channels_have_noise_of_their_own() -> None:
    noise = Sensor(vignetting=0).develop(even(0.3), 0).astype(float)
    noise -= noise.mean((0, 1))
    spread = noise.var()
    for other in (np.roll(noise, 1, 0), np.roll(noise, 1, 1), np.roll(noise, 1, 2)):
        assert abs((noise * other).mean()) < 0.04 * spread


@pytest.mark.parametrize("level", [0.02, 0.2, 0.7])
def test_noise_is_shot_and_read_noise(level: float) -> None:
    sensor = Sensor(vignetting=0, full_well_e=900.0, read_noise_e=6.0)
    found = linear(sensor.develop(even(level), 3).astype(float))
    expected = np.sqrt(level / 900 + (6 / 900) ** 2)
    assert found.mean() == pytest.approx(level, abs=0.002)
    # Eight bits add a little.
    assert found.std() == pytest.approx(expected, rel=0.06)


def test_without_noise_it_is_srgb() -> None:
    sensor = Sensor(vignetting=0, full_well_e=np.inf, read_noise_e=0)
    levels = np.linspace(0, 1, 50)
    for level in levels:
        shown = sensor.develop(even(level), 0)[0, 0, 0]
        curve = 12.92 * level if level <= 0.0031308 else 1.055 * level ** (1 / 2.4) - 0.055
        assert abs(int(shown) - 255 * curve) < 0.75


def test_corners_lose_light_and_colours_are_blue_green_red() -> None:
    sensor = Sensor(vignetting=0.4, full_well_e=np.inf, read_noise_e=0, white_balance=(1.2, 1.0, 0.8))
    shown = linear(sensor.develop(even(0.5), 0).astype(float))
    assert shown[0, 0] / shown[60, 80] == pytest.approx(0.6, abs=0.02)
    assert shown[60, 80] == pytest.approx((0.4, 0.5, 0.6), abs=0.01)


def test_exposure_scales_light_and_white_is_the_end() -> None:
    sensor = Sensor(exposure=2.0, vignetting=0, full_well_e=np.inf, read_noise_e=0)
    assert linear(sensor.develop(even(0.2), 0).astype(float)).mean() == pytest.approx(0.4, abs=0.01)
    assert (sensor.develop(even(0.9), 0) == 255).all()
    assert (sensor.develop(even(-0.5), 0) == 0).all()
