"""Projection, its Jacobian and undistortion, held against one another and against OpenCV's independent implementation."""

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arrays import Float
from models.camera.pinhole import Camera
from models.messages.observation import Crop

finite = st.floats(-1, 1)


def camera(angles: tuple[float, float, float] = (0.1, -0.2, 0.3), shift: tuple[float, float] = (0.0, 0.0)) -> Camera:
    rotation, _ = cv2.Rodrigues(np.array(angles, np.float64))
    return Camera(
        name="cam",
        size_px=(720, 1280),
        matrix_px=np.array(((900.0, 0.0, 355.0), (0.0, 905.0, 650.0), (0.0, 0.0, 1.0))),
        distortion=np.array((-0.09, 0.05, 1e-3, -5e-4, -0.01)),
        rotation=np.asarray(rotation, np.float64),
        translation_m=np.array((0.1, -0.2, 4.0)),
        shift_px=np.array(shift),
    )


points = st.tuples(finite, finite, finite).map(lambda p: np.array(p, np.float64))


@given(points, st.tuples(finite, finite, finite))
def test_projection_agrees_with_opencv(point: Float, angles: tuple[float, float, float]) -> None:
    ours = camera(angles)
    theirs, _ = cv2.projectPoints(
        point.reshape(1, 1, 3), cv2.Rodrigues(ours.rotation)[0], ours.translation_m, ours.matrix_px, ours.distortion
    )
    assert np.allclose(ours.project(point), theirs.ravel(), atol=1e-6)


@given(points, st.tuples(finite, finite))
def test_undistort_inverts_the_lens(point: Float, shift: tuple[float, float]) -> None:
    ours = camera(shift=(30 * shift[0], 30 * shift[1]))
    assert np.allclose(ours.undistort(ours.project(point)), ours.project_undistorted(point), atol=1e-4)


@given(points, st.tuples(finite, finite, finite))
def test_jacobian_is_the_derivative_of_the_undistorted_projection(point: Float, angles: tuple[float, float, float]) -> None:
    ours = camera(angles)
    step = 1e-6
    numeric = np.stack(
        [(ours.project_undistorted(point + step * e) - ours.project_undistorted(point - step * e)) / (2 * step) for e in np.eye(3)],
        axis=-1,
    )
    assert np.allclose(ours.projection_jacobian(point), numeric, rtol=1e-5, atol=1e-3)


@given(points)
def test_the_projection_matrix_says_the_same_as_the_projection(point: Float) -> None:
    ours = camera(shift=(12.0, -7.0))
    homogeneous = ours.projection @ np.append(point, 1.0)
    assert np.allclose(homogeneous[:2] / homogeneous[2], ours.project_undistorted(point))


def test_a_point_behind_the_camera_has_no_picture() -> None:
    assert np.isnan(camera((0.0, 0.0, 0.0)).project(np.array((0.0, 0.0, -5.0)))).all()


def test_the_centre_of_the_camera_projects_from_zero_depth() -> None:
    assert np.allclose(camera().to_camera(camera().centre_m), 0)


@given(
    st.tuples(st.floats(-500, 2000), st.floats(-500, 2000), st.floats(10, 2000), st.floats(-4, 4)),
    st.tuples(st.floats(-1, 2), st.floats(-1, 2)),
)
def test_crop_coordinates_come_back_from_the_image(region: tuple[float, float, float, float], point: tuple[float, float]) -> None:
    crop = Crop(*region)
    assert np.allclose(crop.to_crop(crop.to_image(np.array(point))), point, atol=1e-6)


def test_a_positive_crop_angle_turns_up_to_the_right() -> None:
    top = Crop(100.0, 100.0, 10.0, np.pi / 2).to_image(np.array((0.5, 0.0)))
    assert top == pytest.approx((105.0, 100.0))
