"""What is taken down as true in a picture: where points land on rolling rows, and what hides them, against independent means."""

from functools import cache

import numpy as np
import pytest

from edge.simulation.picture.lens import lens_of
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.truth import Truth
from edge.simulation.truth.visibility import Seen, first_surfaces, judge, reach_m
from edge.simulation.truth.witness import Witness
from models.arrays import Float
from tests.synthetic.moving_scene import Flinger, look_at, moving_scene
from tests.synthetic.ray_cast import RayCaster

ROLLING = Shutter(exposure_s=0.004, readout_s=0.03)
CAMERA = look_at((-3.6, -2.0, 1.9))
T_S = 0.43


@cache
def the_scene() -> Scene:
    return moving_scene()


@cache
def taken_down(t_s: float = T_S) -> Truth:
    return Witness(the_scene(), lens_of(CAMERA), ROLLING).take_down(t_s)


def landing(pupil: Flinger, point: int, t_s: float) -> Float:
    """Where a COCO point lands when its row is exposed, by bisection on the time."""
    rows = CAMERA.size_px[1]
    early, late = (t_s + side * 0.02 for side in (-1, 1))
    for _ in range(60):
        middle = (early + late) / 2
        row = CAMERA.project(pupil.coco_m(middle)[point])[1]
        if (middle - t_s) < float(ROLLING.row_delay_s(row, rows)):
            early = middle
        else:
            late = middle
    return CAMERA.project(pupil.coco_m((early + late) / 2)[point])


def test_points_land_where_they_are_when_their_row_is_exposed() -> None:
    truth = taken_down()
    errors, moved = [], []
    for number, pupil in enumerate(the_scene().pupils):
        assert isinstance(pupil, Flinger)
        for point in range(23):
            errors.append(np.linalg.norm(truth.coco_px[0, number, point] - landing(pupil, point, T_S)))
            moved.append(np.linalg.norm(truth.coco_px[0, number, point] - CAMERA.project(pupil.coco_m(T_S)[point])))
    assert np.max(errors) < 0.05
    assert np.max(moved) > 3  # The shutter matters here.


def test_points_in_the_world_as_exposed_project_to_where_they_land() -> None:
    truth = taken_down()
    assert np.allclose(CAMERA.project(truth.coco_exposed_m.astype(float)), truth.coco_px, atol=0.01)
    assert np.allclose(truth.coco_m[0, 0], the_scene().pupils[0].coco_m(T_S), atol=1e-5)
    assert np.allclose(truth.joints_m[0, 2], the_scene().pupils[2].joints_m(T_S), atol=1e-5)


def test_pose_and_camera_are_read_back() -> None:
    truth = taken_down()
    pose = truth.pose(0, 1)
    assert pose is not None
    assert np.allclose(pose.vector, the_scene().pupils[1].pose(T_S).vector, atol=1e-6)
    camera = truth.camera(0, "cam", CAMERA.size_px)
    assert np.allclose(camera.project(truth.coco_m[0, 0].astype(float)), CAMERA.project(truth.coco_m[0, 0].astype(float)))


def test_boxes_hold_all_points() -> None:
    truth = taken_down()
    for number in range(3):
        left, top, right, bottom = truth.boxes_px[0, number]
        x, y = truth.coco_px[0, number].T
        assert left - 4 < x.min() < left + 60
        assert right - 60 < x.max() < right + 4
        assert top - 4 < y.min() < top + 80
        assert bottom - 60 < y.max() < bottom + 4


@pytest.mark.slow
def test_what_hides_a_point_is_the_first_surface_on_the_ray() -> None:
    scene, camera = the_scene(), CAMERA
    pupils, actors = len(scene.pupils), len(scene.pupils) + len(scene.things)
    agreed, found = [], set()
    for t_s in (T_S, 0.07):
        truth = taken_down(t_s)
        for number, pupil in enumerate(scene.pupils):
            reach = reach_m(pupil.body)[24:]
            for point, said in enumerate(truth.coco_seen[0, number]):
                x, y = truth.coco_px[0, number, point].astype(float)
                if not (0 <= x <= camera.size_px[0] - 1 and 0 <= y <= camera.size_px[1] - 1):
                    assert said == Seen.OUTSIDE
                    continue
                place = truth.coco_exposed_m[0, number, point].astype(float)
                depth = float(camera.to_camera(place)[2])
                hit = RayCaster(scene, camera, ROLLING, t_s, float(y)).cast(float(x))
                if hit is None:
                    expected = Seen.VISIBLE
                elif hit.shown == number:
                    expected = Seen.BEHIND_ITSELF if hit.depth_m < depth - reach[point] else Seen.VISIBLE
                elif hit.depth_m > depth - 0.01:
                    expected = Seen.VISIBLE
                elif hit.shown < pupils:
                    expected = Seen.BEHIND_PUPIL
                else:
                    expected = Seen.BEHIND_THING if hit.shown < actors else Seen.BEHIND_ROOM
                agreed.append(said == expected)
                found.add(Seen(said))
    assert found >= {Seen.VISIBLE, Seen.BEHIND_ITSELF, Seen.BEHIND_PUPIL, Seen.BEHIND_ROOM}
    assert np.mean(agreed) > 0.98


def test_a_pupil_behind_the_camera_is_outside() -> None:
    away = Witness(the_scene(), lens_of(look_at((3.0, 3.0, 1.5), target_m=(9.0, 9.0, 1.0))), ROLLING).take_down(T_S)
    assert (away.coco_seen == Seen.OUTSIDE).all()
    assert (away.joints_seen == Seen.OUTSIDE).all()
    assert np.isnan(away.boxes_px).all()
    assert np.isfinite(away.coco_m).all()


def test_what_is_just_before_the_skin_hides_and_the_own_skin_does_not() -> None:
    # A point 4 m away, 5 cm below the skin of pupil 1 of 2; then one thing, then the room.
    cases = [
        (1, 3.95, Seen.VISIBLE),  # his own skin
        (1, 3.70, Seen.BEHIND_ITSELF),  # his own arm
        (0, 3.93, Seen.BEHIND_PUPIL),  # another's hand on him
        (2, 3.93, Seen.BEHIND_THING),
        (3, 3.0, Seen.BEHIND_ROOM),
        (3, 3.995, Seen.VISIBLE),  # the floor that his sole touches
        (0, 4.5, Seen.VISIBLE),  # somebody behind him, where clothes leave the point bare
        (-1, np.inf, Seen.VISIBLE),
    ]
    owners, first = np.array([owner for owner, _, _ in cases]), np.array([depth for _, depth, _ in cases])
    count = len(cases)
    found = judge(1, np.full(count, 4.0), np.full(count, 0.1), first, owners, 2, 1)
    assert found.tolist() == [seen for _, _, seen in cases]


def test_the_first_surface_is_the_nearest_that_covers_the_pixel() -> None:
    generator = np.random.default_rng(2)
    corners = generator.uniform(-40, 240, (300, 2))
    depths = generator.uniform(1, 9, 300)
    faces = generator.permutation(300).reshape(-1, 3)
    queries = generator.uniform(0, 199, (400, 2))
    first, found = np.full(400, np.inf), np.full(400, -1)
    first_surfaces(corners, depths, faces, 7, queries, first, found, 200, 200)
    expected = np.full(400, np.inf)
    for a, b, c in faces:
        shares = np.linalg.solve(np.vstack((corners[[a, b, c]].T, np.ones(3))), np.vstack((queries.T, np.ones(400))))
        depth = 1 / (shares.T @ (1 / depths[[a, b, c]]))
        expected = np.where((shares >= 0).all(0), np.minimum(expected, depth), expected)
    assert np.isfinite(expected).sum() > 200
    assert np.allclose(first, expected)
    assert np.array_equal(found, np.where(np.isfinite(expected), 7, -1))
