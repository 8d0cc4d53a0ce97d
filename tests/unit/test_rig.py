"""A calibration file is believed only when it can be true; otherwise the camera at fault is named."""

import pytest

from models.camera.rig import decode_rig
from models.errors import UserError

GOOD = """
version = 1
[[camera]]
name = "cam01"
size_px = [720, 1280]
matrix_px = [[900.0, 0.0, 360.0], [0.0, 900.0, 640.0], [0.0, 0.0, 1.0]]
rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]
translation_m = [0.0, 1.0, 4.0]
[[camera]]
name = "cam02"
size_px = [720, 1280]
matrix_px = [[900.0, 0.0, 360.0], [0.0, 900.0, 640.0], [0.0, 0.0, 1.0]]
rotation = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]
translation_m = [0.0, 1.0, 4.0]
"""


def test_a_good_file_is_read_in_its_own_order() -> None:
    rig = decode_rig(GOOD.encode(), "rig.toml")
    assert rig.names == ("cam01", "cam02")
    assert rig.select(["cam02", "cam01"]).names == ("cam02", "cam01")


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]", "[[1.1, 0.0, 0.0], [0.0, 0.0, -1.0]", "cam01.*not a rotation"),
        ("[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]", "[[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]", r"cam01.*det -1\.000"),
        ('name = "cam02"', 'name = "cam01"', "cam01.*twice"),
        ("translation_m = [0.0, 1.0, 4.0]", "translation_m = [0.0, 1.0]", "cam01.*translation_m"),
        ("translation_m = [0.0, 1.0, 4.0]", "translation_m = [0.0, 1.0, nan]", "cam01.*not a finite"),
        ("size_px = [720, 1280]", "size_px = [0, 1280]", "cam01.*size_px"),
        ("[[900.0, 0.0, 360.0]", "[[900.0, 360.0]", "cam01.*matrix_px"),
        ("[[900.0, 0.0, 360.0]", "[[-900.0, 0.0, 360.0]", "cam01.*focal"),
        ("[0.0, 0.0, 1.0]]", "[0.0, 0.0, 2.0]]", "cam01.*matrix_px must be"),
        ("translation_m = [0.0, 1.0, 4.0]", "translation_m = [0.0, 1.0, 4000.0]", "cam01.*metres"),
        ("translation_m = [0.0, 1.0, 4.0]", "translation_m = [0.0, 1.0, 4.0]\nshift_px = [1e9, 0.0]", "cam01.*shift_px"),
        ("[[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0,", "[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]] # [", "same place"),
        ("version = 1", "version = 2", "version 2"),
        ("version = 1", "version = 1\nspeed = 3", "speed"),
        ("version = 1", "version =", "rig.toml"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_true_is_refused_and_names_the_fault(old: str, new: str, named: str) -> None:
    assert old in GOOD
    with pytest.raises(UserError, match=f"(?s)rig.toml.*{named}|{named}"):
        decode_rig(GOOD.replace(old, new, 1).encode(), "rig.toml")


def test_an_unknown_camera_is_named_with_those_that_are_known() -> None:
    with pytest.raises(UserError, match=r"'cam09' is not in the calibration.*cam01, cam02"):
        decode_rig(GOOD.encode(), "rig.toml").select(["cam01", "cam09"])
