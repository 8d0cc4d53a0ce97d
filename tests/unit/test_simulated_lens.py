"""The lens of renderer and truth: the camera's own inside the picture, never folding outside, and rooms cut finely enough."""

import numpy as np
import pytest

from edge.simulation.picture.lens import NEAR_M, lens_of
from edge.simulation.picture.meshes import corners_of, near_rim, normals, welded
from edge.simulation.picture.tessellation import TOLERANCE_PX, tessellate
from models.errors import UserError
from tests.synthetic.moving_scene import BARREL, look_at, quad, room, sphere

LENSES = {
    "none": (0.0, 0.0, 0.0, 0.0, 0.0),
    "barrel": BARREL,
    "pincushion": (0.15, 0.05, -0.003, 0.002, 0.02),
    "moustache": (-0.25, 0.3, 0.0, 0.0, -0.05),
}


@pytest.mark.parametrize("name", LENSES)
def test_inside_the_picture_it_is_the_camera(name: str) -> None:
    camera = look_at((-3.6, -2.0, 1.9), distortion=LENSES[name])
    lens = lens_of(camera)
    width, height = camera.size_px
    points = np.random.default_rng(0).uniform((-6, -5, 0), (6, 5, 3), (4000, 3))
    found = lens.project(points)
    local = camera.to_camera(points)
    near = np.hypot(local[:, 0], local[:, 1]) <= lens.limit * local[:, 2]
    seen = ((found >= -0.5) & (found < (width - 0.5, height - 0.5))).all(1)
    assert seen.sum() > 300
    assert near[seen].all()
    assert np.allclose(found[seen], camera.project(points[seen]), atol=1e-9)


@pytest.mark.parametrize("name", LENSES)
def test_what_is_outside_the_field_stays_outside_the_picture(name: str) -> None:
    camera = look_at((0.0, 0.0, 1.0), target_m=(1.0, 0.0, 1.0), distortion=LENSES[name])
    lens = lens_of(camera)
    for angle in np.linspace(0, 2 * np.pi, 24, endpoint=False):
        away = np.linspace(0, 40, 4000)
        points = (
            np.column_stack((away * np.cos(angle), away * np.sin(angle), np.ones_like(away))) - camera.translation_m
        ) @ camera.rotation
        pixels = lens.project(points)
        inside = np.asarray(((pixels >= 0) & (pixels < camera.size_px)).all(1))
        left = np.nonzero(~inside)[0][0]
        assert not inside[left:].any()


def test_a_camera_whose_lens_folds_its_picture_is_refused() -> None:
    camera = look_at((0.0, 0.0, 1.0), target_m=(1.0, 0.0, 1.0), distortion=(-0.9, 0.0, 0.0, 0.0, 0.0))
    with pytest.raises(UserError, match=r"camera 'cam': its distortion .* turns back inside the picture; calibrate"):
        lens_of(camera)


def test_what_is_behind_is_not_seen() -> None:
    camera = look_at((-3.6, -2.0, 1.9))
    behind = camera.centre_m - 2 * camera.rotation[2]
    just_before = camera.centre_m + 1.01 * NEAR_M * camera.rotation[2]
    found = lens_of(camera).project(np.stack((behind, just_before)))
    assert np.isnan(found[0]).all()
    assert np.isfinite(found[1]).all()


@pytest.mark.parametrize("name", ["barrel", "pincushion", "moustache"])
def test_pieces_of_a_room_are_straight_enough(name: str) -> None:
    camera = look_at((-6.5, -4.8, 2.4), distortion=LENSES[name])
    lens = lens_of(camera)
    generator = np.random.default_rng(1)
    drawn_count = 0
    for surface in room():
        pieces = tessellate(corners_of(surface)[..., :3], lens)
        if not len(pieces):
            continue
        pixels = lens.project(pieces)
        # A random place within a piece, where the rasteriser puts it and where the lens does.
        shares = generator.dirichlet((1, 1, 1), len(pieces))
        weights = shares / camera.to_camera(pieces)[..., 2]
        weights /= weights.sum(1, keepdims=True)
        drawn = (shares[..., None] * pixels).sum(1)
        true = lens.project((weights[..., None] * pieces).sum(1))
        inside = ((true > 0) & (true < camera.size_px)).all(1)
        if inside.any():
            assert np.abs(drawn - true)[inside].max() < 2.5 * TOLERANCE_PX
            drawn_count += int(inside.sum())
    assert drawn_count > 300


def test_both_triangles_of_an_edge_split_it_alike() -> None:
    camera = look_at((-3.6, -2.0, 1.9), distortion=BARREL)
    floor = tessellate(
        corners_of(quad("floor", (-2.0, -2.0, 0.0), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 0.5))[..., :3], lens_of(camera)
    )
    # All of it is in the field: only its own rim has triangles on one side only.
    edges = np.sort(floor[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2, 3).view("f8,f8,f8"), axis=1).view("f8").reshape(-1, 6)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    on_rim = np.isclose(np.abs(unique), 2.0)
    along_rim = (on_rim[:, 0] & on_rim[:, 3]) | (on_rim[:, 1] & on_rim[:, 4])
    assert len(counts) > 500
    assert (counts[~along_rim] == 2).all()
    assert (counts <= 2).all()


def test_normals_point_outwards_and_seams_do_not_show() -> None:
    ball = sphere("ball", 0.5, (1, 1, 1))
    found = normals(ball.vertices_m, ball.faces, welded(ball.vertices_m))
    assert np.allclose((found * ball.vertices_m).sum(1), 0.5, atol=0.02)


def test_only_the_rim_of_an_open_surface_shows_its_inside() -> None:
    ball = sphere("ball", 0.5, (1, 1, 1), rings=20)
    welds = welded(ball.vertices_m)
    assert not near_rim(ball.vertices_m, welds[ball.faces], 0.2).any()
    cup = ball.faces[ball.vertices_m[ball.faces][..., 2].max(1) < 0.01]
    rim = near_rim(ball.vertices_m, welds[cup], 0.2)
    heights = ball.vertices_m[cup][..., 2].max(1)
    assert rim[heights > -0.15].all()
    assert not rim[heights < -0.25].any()
