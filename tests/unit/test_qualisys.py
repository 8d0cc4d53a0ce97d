"""Qualisys's conventions, checked on a made-up camera, on an independent conversion and on the committed calibration."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from edge.footage.sets import CALIBRATION
from edge.footage.transcode import SIZE_PX
from models.arrays import Float
from models.camera.rig import Rig, decode_rig, encode_rig
from models.errors import UserError
from services.calibration.qualisys import decode_qualisys
from services.calibration.resolution import resized
from tests.installed import ROOT, require_footage

SHARED = ROOT.parent / "shared/data/pose2sim_single"
RIG_FILE = ROOT / "deploy/sites/footage/rig.toml"

# A camera two metres up at y = -5 m that looks along +y: to Qualisys (y up, looking along -z), right is +x and up is +z.
GOOD = """<?xml version='1.0'?>
<calibration><cameras>
<camera serial="north" viewrotation="0">
  <fov_video bottom="479" left="0" right="639" top="0"/>
  <transform r11="1" r12="0" r13="0" r21="0" r22="0" r23="1" r31="0" r32="-1" r33="0" x="0" y="-5000" z="2000"/>
  <intrinsic centerPointU="20480" centerPointV="15360" focalLengthU="32000" focalLengthV="32000"
   skew="0" radialDistortion1="-0.1" radialDistortion2="0.2" radialDistortion3="0.3"
   tangentalDistortion1="0.01" tangentalDistortion2="0.02"/>
</camera>
</cameras></calibration>
"""


def test_a_camera_sees_the_world_as_it_stands() -> None:
    (camera,) = decode_qualisys(GOOD.encode(), "a.qca.txt")
    assert camera.name == "north"
    assert camera.size_px == (640, 480)
    assert camera.centre_m == pytest.approx((0, -5, 2))
    ahead, right, above = (camera.project_undistorted(np.array(point)) for point in ((0, 0, 2.0), (1, 0, 2.0), (0, 0, 3.0)))
    assert ahead == pytest.approx((320, 240))
    assert right == pytest.approx((420, 240))
    assert above == pytest.approx((320, 140))
    assert camera.distortion == pytest.approx((-0.1, 0.2, 0.01, 0.02, 0.3))


def test_a_cropped_sensor_moves_the_principal_point() -> None:
    (camera,) = decode_qualisys(GOOD.replace('left="0"', 'left="40"').replace('top="0"', 'top="30"').encode(), "a")
    assert camera.size_px == (600, 450)
    assert camera.matrix_px[:2, 2] == pytest.approx((280, 210))


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("</cameras></calibration>", "", "a.qca.txt: not a Qualisys calibration"),
        ("camera ", "kamera ", "not a Qualisys calibration"),
        ('focalLengthU="32000"', "", "camera 'north': intrinsic focalLengthU is missing"),
        ('focalLengthU="32000"', 'focalLengthU="wide"', "camera 'north': intrinsic focalLengthU is wide"),
        ('viewrotation="0"', 'viewrotation="90"', "camera 'north': its view is rotated by 90"),
        ('<fov_video bottom="479" left="0" right="639" top="0"/>', "", "camera 'north': has no <fov_video>"),
        ('r11="1"', 'r11="0.9"', "camera 'north': rotation is not a rotation"),
    ],
)
def test_a_fault_is_named(old: str, new: str, named: str) -> None:
    with pytest.raises(UserError, match=named):
        decode_qualisys(GOOD.replace(old, new).encode(), "a.qca.txt")


def test_a_file_without_cameras_is_refused() -> None:
    with pytest.raises(UserError, match="contains no camera"):
        decode_qualisys(b"<calibration/>", "a.qca.txt")


def test_another_resolution_puts_every_point_at_the_same_place_of_the_picture() -> None:
    (camera,) = decode_qualisys(GOOD.encode(), "a.qca.txt")
    small = resized(camera, (320, 160))
    points = np.random.default_rng(1).uniform((-1, -1, 1), (1, 1, 3), (20, 3))
    assert (small.project(points) + 0.5) * (2, 3) - 0.5 == pytest.approx(camera.project(points))


def converted() -> Rig:
    rig = decode_qualisys((require_footage() / "footage" / CALIBRATION).read_bytes(), CALIBRATION)
    return Rig(tuple(resized(camera, SIZE_PX) for camera in rig))


@pytest.mark.footage
def test_the_committed_calibration_is_the_conversion_with_its_shifts() -> None:
    committed = decode_rig(RIG_FILE.read_bytes(), "rig.toml")
    shifts = np.array([camera.shift_px for camera in committed])
    source = tomllib.loads(RIG_FILE.read_text())["source"]
    assert encode_rig(converted().with_shifts(shifts), source) == RIG_FILE.read_bytes()


@pytest.mark.footage
def test_the_cameras_stand_on_the_floor_of_a_room_and_look_down_at_its_middle() -> None:
    for camera in converted():
        assert 1.5 < camera.centre_m[2] < 2.3
        x, y = camera.project(np.array((-0.8, 0.1, 0.9)))
        assert 0 < x < SIZE_PX[0]
        assert 0 < y < SIZE_PX[1]


@pytest.mark.footage
@pytest.mark.shared_data
@pytest.mark.skipif(not SHARED.is_dir(), reason="the measurement data is not there")
def test_an_independent_conversion_agrees_but_for_its_distortion() -> None:
    theirs = tomllib.loads((SHARED / "Calib_qualisys.toml").read_text())
    for camera in decode_qualisys((Path(require_footage()) / "footage" / CALIBRATION).read_bytes(), CALIBRATION):
        other = theirs[camera.name]
        assert camera.size_px == tuple(int(side) for side in other["size"])
        assert camera.matrix_px == pytest.approx(np.array(other["matrix"]), abs=1e-6)
        assert camera.translation_m == pytest.approx(np.array(other["translation"]), abs=1e-9)
        assert camera.rotation == pytest.approx(rodrigues(np.array(other["rotation"])), abs=1e-9)
        assert camera.distortion[:4] / 64 == pytest.approx(np.array(other["distortions"]), abs=1e-9)


def rodrigues(vector: Float) -> Float:
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    rotation: Float = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return rotation
