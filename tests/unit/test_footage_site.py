"""The built-in site: its file can be read, and every camera of it is calibrated and in the footage."""

from edge.footage.prepare import CAMERAS
from edge.footage.transcode import SIZE_PX
from models.camera.rig import decode_rig
from models.config.site import decode_site
from tests.installed import ROOT

FOLDER = ROOT / "deploy/sites/footage"


def test_the_site_names_the_cameras_of_the_footage_and_its_calibration() -> None:
    site = decode_site((FOLDER / "site.toml").read_bytes(), "site.toml")
    rig = decode_rig((FOLDER / site.calibration).read_bytes(), site.calibration).select(camera.name for camera in site.cameras)
    assert rig.names == CAMERAS
    assert [camera.path for camera in site.cameras] == [f"footage/{name}.avi" for name in CAMERAS]
    assert {camera.rate_hz for camera in site.cameras} == {30.0}
    assert {camera.size_px for camera in rig} == {SIZE_PX}
