"""Laws of the crop: what the network sees, and where it is in the picture, agree to a fraction of a pixel."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from edge.perception.crop import blended, crop_from_box, crop_from_pose, cut, reduction_for
from models.arrays import Float, UInt8
from models.messages.observation import Crop
from models.skeleton import coco
from tests.small_video import spot_picture, video_of

angles = st.floats(-3.1, 3.1)
crops = st.builds(Crop, st.floats(250, 390), st.floats(190, 290), st.floats(150, 500), angles)
unit_points = st.tuples(st.floats(0.2, 0.8), st.floats(0.2, 0.8)).map(np.array)


def centroid(picture: UInt8) -> Float:
    weight = picture[..., 0].astype(np.float64)
    weight[weight < 20] = 0
    y, x = np.mgrid[: weight.shape[0], : weight.shape[1]]
    middle: Float = np.array(((weight * x).sum(), (weight * y).sum())) / weight.sum()
    return middle


@given(crop=crops, point=unit_points)
def test_to_the_picture_and_back(crop: Crop, point: Float) -> None:
    assert crop.to_crop(crop.to_image(point)) == pytest.approx(point, abs=1e-9)


@pytest.mark.slow
@settings(deadline=None, max_examples=40)
@given(crop=crops, point=unit_points, network_px=st.sampled_from([192, 256]))
def test_a_spot_is_seen_where_it_is_at_every_reduction(crop: Crop, point: Float, network_px: int) -> None:
    at_px = crop.to_image(point)
    assume(bool((at_px > 30).all() and (at_px < (610, 450)).all()))  # the whole spot is in the picture
    frame = video_of([spot_picture(at_px, 6.0, (640, 480))]).frame(0, 0, 0)
    for reduction in (1, 2, 4):
        seen = cut(frame.image(reduction), reduction, crop, network_px)
        assert seen.shape == (network_px, network_px, 3)
        found = (centroid(seen) + 0.5) / network_px
        assert crop.to_image(found) == pytest.approx(at_px, abs=0.35)


@given(side=st.floats(1, 5000), network_px=st.sampled_from([192, 256]))
def test_a_reduction_never_costs_resolution(side: float, network_px: int) -> None:
    reduction = reduction_for(side, network_px)
    assert reduction in (1, 2, 4)
    assert reduction == 1 or side / reduction >= network_px
    assert reduction == 4 or side / (2 * reduction) < network_px


keypoints = st.lists(st.tuples(st.floats(0, 720), st.floats(0, 1270)), min_size=17, max_size=17).map(
    lambda p: np.array(p, np.float64)
)


@given(points=keypoints, previous=crops)
def test_the_next_crop_holds_every_confident_keypoint_with_room(points: Float, previous: Crop) -> None:
    crop = crop_from_pose(points, np.ones(coco.COUNT, np.bool_), previous)
    inside = crop.to_crop(points)
    assert (inside > 0.05).all()
    assert (inside < 0.95).all()


@given(angle=angles, previous=crops)
def test_the_trunk_points_up_in_the_next_crop(angle: float, previous: Crop) -> None:
    person = np.zeros((coco.COUNT, 2))
    person[[5, 6]] = (-20, -60), (20, -60)
    person[[11, 12]] = (-15, 40), (15, 40)
    points = Crop(360, 640, 1, angle).to_image(person + 0.5)
    crop = crop_from_pose(points, np.ones(coco.COUNT, np.bool_), previous)
    local = crop.to_crop(points)
    up = local[[5, 6]].mean(axis=0) - local[[11, 12]].mean(axis=0)
    assert up[1] < 0
    assert up[0] == pytest.approx(0, abs=1e-9)


@given(points=keypoints, previous=crops, hidden=st.sampled_from(coco.TRUNK))
def test_without_the_whole_trunk_the_angle_stays(points: Float, previous: Crop, hidden: int) -> None:
    confident = np.ones(coco.COUNT, np.bool_)
    confident[hidden] = False
    assert crop_from_pose(points, confident, previous).angle_rad == previous.angle_rad


def test_a_trunk_that_points_at_the_camera_keeps_the_angle() -> None:
    points = np.tile((300.0, 300.0), (coco.COUNT, 1))
    assert crop_from_pose(points, np.ones(coco.COUNT, np.bool_), Crop(0, 0, 100, 0.7)).angle_rad == 0.7


@given(old=crops, new=crops)
def test_a_blend_goes_from_the_old_to_the_new_the_short_way_round(old: Crop, new: Crop) -> None:
    for share, end in ((0.0, old), (1.0, new)):
        blend = blended(old, new, share)
        assert (blend.centre_x_px, blend.centre_y_px, blend.side_px) == pytest.approx(
            (end.centre_x_px, end.centre_y_px, end.side_px)
        )
        assert np.cos(blend.angle_rad - end.angle_rad) == pytest.approx(1)
    half = blended(old, new, 0.5)
    assert np.cos(half.angle_rad - old.angle_rad) >= -1e-9


def test_a_box_gives_an_upright_square_around_its_middle() -> None:
    assert crop_from_box(np.array((100.0, 200.0, 200.0, 600.0))) == Crop(150, 400, 500, 0.0)
