"""Reads a Qualisys Track Manager calibration (`*.qca.txt`, XML) into a rig.

Qualisys writes lengths in millimetres and image quantities in 64ths of a pixel, and looks along its camera's -z with y up.
Its `transform` holds the camera's place in the world (x, y, z) and, row by row, the world-to-camera rotation; turned by 180
degrees about x that becomes OpenCV's camera (y down, z forward). Its distortion is Brown's, on normalised coordinates, so it
is not in subpixels.

Source: the Qualisys Track Manager user manual, "Calibration file"; proven against an independent conversion in
`tests/unit/test_qualisys.py`.
"""

import xml.etree.ElementTree as ET

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError

SUBPIXELS = 64.0
_TO_OPENCV = np.diag((1.0, -1.0, -1.0))
_DISTORTION = ("radialDistortion1", "radialDistortion2", "tangentalDistortion1", "tangentalDistortion2", "radialDistortion3")


def decode_qualisys(data: bytes, origin: str) -> Rig:
    """Read the cameras of a Qualisys calibration, in its order, named by their serial.

    Args:
        data: the file's bytes.
        origin: its name, for error messages.

    Raises:
        UserError: not such a file, a value missing or not a number, or a rotated view, which we do not read.
    """
    try:
        root = ET.fromstring(data)  # noqa: S314 - expat bounds entity expansion, and no entity of this format is external
    except ET.ParseError as error:
        raise UserError(f"calibration {origin}: not a Qualisys calibration ({error}); export it again") from error
    cameras = tuple(_camera(element, origin) for element in root.iter("camera"))
    if not cameras:
        raise UserError(f"calibration {origin}: contains no camera; export it again")
    return Rig(cameras)


def _camera(element: ET.Element, origin: str) -> Camera:
    name = element.get("serial", "?")
    where = f"calibration {origin}: camera '{name}'"
    if element.get("viewrotation", "0") != "0":
        raise UserError(f"{where}: its view is rotated by {element.get('viewrotation')} degrees; export it unrotated")
    transform, intrinsic, view = (_child(element, tag, where) for tag in ("transform", "intrinsic", "fov_video"))
    left, top, right, bottom = (_number(view, key, where) for key in ("left", "top", "right", "bottom"))
    rotation = _TO_OPENCV @ np.array([[_number(transform, f"r{i}{j}", where) for j in (1, 2, 3)] for i in (1, 2, 3)])
    centre_m = np.array([_number(transform, key, where) for key in "xyz"]) / 1000
    return Camera(
        name=name,
        size_px=(round(right - left) + 1, round(bottom - top) + 1),
        matrix_px=_matrix(intrinsic, where) - np.array(((0, 0, left), (0, 0, top), (0, 0, 0))),
        distortion=np.array([_number(intrinsic, key, where) for key in _DISTORTION]),
        rotation=rotation,
        translation_m=-rotation @ centre_m,
        shift_px=np.zeros(2),
    )


def _matrix(intrinsic: ET.Element, where: str) -> Float:
    f_u, f_v, skew, c_u, c_v = (
        _number(intrinsic, key, where) / SUBPIXELS
        for key in ("focalLengthU", "focalLengthV", "skew", "centerPointU", "centerPointV")
    )
    return np.array(((f_u, skew, c_u), (0.0, f_v, c_v), (0.0, 0.0, 1.0)))


def _child(element: ET.Element, tag: str, where: str) -> ET.Element:
    child = element.find(tag)
    if child is None:
        raise UserError(f"{where}: has no <{tag}>; export the calibration again")
    return child


def _number(element: ET.Element, key: str, where: str) -> float:
    text = element.get(key)
    try:
        return float(text if text is not None else "missing")
    except ValueError as error:
        raise UserError(f"{where}: {element.tag} {key} is {text or 'missing'}, not a number; export it again") from error
