"""The built-in sites: their files can be read, and every camera of them is calibrated and in the footage."""

import pytest

from edge.footage.sets import CAMERAS, FOOTAGES
from edge.footage.transcode import SIZE_PX
from models.camera.rig import decode_rig
from models.config.site import decode_site
from tests.installed import ROOT


@pytest.mark.parametrize("name", FOOTAGES)
def test_the_site_names_the_cameras_of_the_footage_and_its_calibration(name: str) -> None:
    folder = ROOT / "deploy/sites" / name
    site = decode_site((folder / "site.toml").read_bytes(), "site.toml")
    rig = decode_rig((folder / site.calibration).read_bytes(), site.calibration).select(camera.name for camera in site.cameras)
    assert rig.names == CAMERAS
    assert [camera.path for camera in site.cameras] == [f"{name}/{camera}.avi" for camera in CAMERAS]
    assert {camera.rate_hz for camera in site.cameras} == {30.0}
    assert {camera.size_px for camera in rig} == {SIZE_PX}
