"""Pictures of a scene: the same to the bit, blurred as far as things move, hidden where truth says, standing on their shadows."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from edge.simulation.picture.renderer import Renderer, View
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.sensor import Sensor
from edge.simulation.picture.shadows import NO_GROUND
from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.dense import DensePainter
from models.arrays import Bool
from models.camera.pinhole import Camera
from tests.installed import require_graphics
from tests.synthetic.moving_scene import Flying, look_at, moving_scene, room, sphere

ROLLING = Shutter(exposure_s=0.004, readout_s=0.016)
CAMERA = look_at((-3.6, -2.0, 1.9))
T_S = 0.43


@cache
def the_view() -> View:
    require_graphics()
    return Renderer(moving_scene()).view(CAMERA, ROLLING)


def flying_ball(velocity_m_s: tuple[float, float, float], start_m: tuple[float, float, float] = (0.0, 0.0, 1.2)) -> Scene:
    """A white ball in a dark room."""
    dark = tuple(replace(surface, colours=np.zeros((4, 3)), texture=None, gloss=0.0) for surface in room()[:5])
    ball = Flying(sphere("ball", 0.06, (1.0, 1.0, 1.0)), np.array(start_m), np.array(velocity_m_s))
    return Scene(dark, (), (ball,), (), ambient=(1.0, 1.0, 1.0))


def well_inside(mask: Bool) -> Bool:
    """Pixels of a mask that are two pixels away from its edge."""
    for _ in range(2):
        mask = mask & np.roll(mask, 1, 0) & np.roll(mask, -1, 0) & np.roll(mask, 1, 1) & np.roll(mask, -1, 1)
    return mask


@pytest.mark.slow
def test_a_picture_is_the_same_to_the_bit_whenever_and_after_whatever_it_is_taken() -> None:
    require_graphics()
    sensor = Sensor(seed=3)
    other = look_at((3.0, -2.5, 2.0))
    first = Renderer(moving_scene()).view(CAMERA, ROLLING)
    in_order = [sensor.develop(first.picture(T_S + number / 30), number) for number in range(3)]
    again = Renderer(moving_scene())
    disturbing = again.view(other, ROLLING)
    second = again.view(CAMERA, ROLLING)
    for number in (2, 0, 1):
        disturbing.picture(T_S + number / 30)
        assert np.array_equal(sensor.develop(second.picture(T_S + number / 30), number), in_order[number])


@pytest.mark.slow
def test_a_closed_room_has_no_holes() -> None:
    view = the_view()
    floor_and_walls = view.room.light[200:]
    assert (floor_and_walls.sum(-1) > 0.02).all()
    assert np.isfinite(view.room.light).all()


@pytest.mark.slow
def test_a_ball_is_blurred_as_far_as_it_flies_while_the_shutter_is_open() -> None:
    require_graphics()
    camera = look_at((0.0, -4.0, 1.2), target_m=(0.0, 0.0, 1.2), distortion=(0.0, 0.0, 0.0, 0.0, 0.0))
    widths = {}
    for speed in (0.0, 12.0):
        view = Renderer(flying_ball((speed, 0.0, 0.0))).view(camera, Shutter(exposure_s=0.02, readout_s=0.0))
        light = view.picture(0.0)[..., 1]
        # The share of light in each column; a ball of 12 m/s spreads it over 0.24 m.
        columns = light.sum(0)
        place = np.arange(len(columns))
        middle = (columns * place).sum() / columns.sum()
        widths[speed] = 12 * (columns * (place - middle) ** 2).sum() / columns.sum()
        assert middle == pytest.approx(camera.project(np.array((0.0, 0.0, 1.2)))[0], abs=0.3)
    # Variance of a box of width w is w^2 / 12, and variances add.
    blur_px = np.sqrt(widths[12.0] - widths[0.0])
    assert blur_px == pytest.approx(0.24 * camera.matrix_px[0, 0] / 4.0, rel=0.03)


@pytest.mark.slow
def test_blur_neither_loses_nor_gains_light() -> None:
    require_graphics()
    camera = look_at((0.0, -4.0, 1.2), target_m=(0.0, 0.0, 1.2))
    sums = [
        float(Renderer(flying_ball((speed, 0.0, 0.0))).view(camera, ROLLING).picture(0.0)[..., 1].sum())
        for speed in (0.0, 3.0, 9.0, 30.0)
    ]
    assert sums == pytest.approx([sums[0]] * 4, rel=0.04)


@pytest.mark.slow
def test_pupils_are_seen_where_the_mask_has_them_and_nowhere_else() -> None:
    view = the_view()
    sharp = view.renderer.view(CAMERA, Shutter(exposure_s=1e-5, readout_s=0.016))
    picture = sharp.picture(T_S)
    shown = DensePainter(sharp).draw(T_S).shown
    changed = np.abs(picture - sharp.room.light).max(-1) / (sharp.room.light.max(-1) + 0.05)
    inner = (shown >= 0) & (shown < 4)
    outer = ~inner
    for _ in range(2):
        inner, outer = (
            mask & np.roll(mask, 1, 0) & np.roll(mask, -1, 0) & np.roll(mask, 1, 1) & np.roll(mask, -1, 1)
            for mask in (inner, outer)
        )
    assert inner.sum() > 3000
    assert np.mean(changed[inner] > 0.05) > 0.97
    # Off the ground, where no shadow is.
    walls = outer & (sharp.room.ground[..., 0] == NO_GROUND)
    assert walls.sum() > 30000
    assert changed[walls].max() < 1e-6
    # One pupil's legs are behind the screen, of which something is seen.
    assert (shown == len(moving_scene().pupils) + 1 + 5).any()


@pytest.mark.slow
def test_a_ball_on_the_floor_stands_on_its_shadow_and_one_in_the_air_hardly_casts_one() -> None:
    require_graphics()
    camera = look_at((0.0, -3.0, 2.0), target_m=(0.0, 0.0, 0.0))
    lamps = moving_scene().lamps
    darkest = {}
    for height in (0.12, 1.2):
        ball = Flying(sphere("ball", 0.12, (1.0, 1.0, 1.0)), np.array((0.0, 0.0, height)), np.zeros(3))
        view = Renderer(Scene(room()[:5], (), (ball,), lamps)).view(camera, ROLLING)
        picture, shown = view.picture(0.0), DensePainter(view).draw(0.0).shown
        floor = well_inside(shown == 1)
        share = np.where(floor, picture.sum(-1) / view.room.light.sum(-1), 1.0)
        darkest[height] = float(share.min())
        assert share.max() < 1 + 1e-5
        ground = view.room.ground / 1e3
        far = (np.hypot(ground[..., 0], ground[..., 1]) > 1.5) & floor
        assert far.sum() > 5000
        assert share[far].min() > 0.995
    assert darkest[0.12] < 0.6
    assert darkest[0.12] + 0.2 < darkest[1.2]


@pytest.mark.slow
def test_a_pupil_close_to_the_camera_or_beside_it_does_not_break_the_picture() -> None:
    require_graphics()
    scene = moving_scene()
    for eye in ((0.0, -0.55, 1.2), (0.3, 0.0, 1.2), (0.05, 0.0, 1.0)):
        camera: Camera = look_at(eye, target_m=(3.0, 0.5, 1.1))
        picture = Renderer(scene).view(camera, ROLLING).picture(T_S)
        assert np.isfinite(picture).all()
        assert picture.max() < 4
