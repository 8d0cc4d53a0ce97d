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


def lens(
    focal_px: object = 900.0, skew_px: object = 0.0, centre_px: tuple[object, object] = (360.0, 640.0), distortion: object = None
) -> bytes:
    """The good file with another lens of its first camera."""
    matrix = f"[[{focal_px}, {skew_px}, {centre_px[0]}], [0.0, {focal_px}, {centre_px[1]}], [0.0, 0.0, 1.0]]"
    more = "" if distortion is None else f"\ndistortion = {distortion}"
    old = "matrix_px = [[900.0, 0.0, 360.0], [0.0, 900.0, 640.0], [0.0, 0.0, 1.0]]"
    assert old in GOOD
    return GOOD.replace(old, f"matrix_px = {matrix}{more}", 1).encode()


@pytest.mark.parametrize(
    ("file", "key"),
    [
        *((lens(focal_px=focal), r"matrix_px\[0\]\[0\]") for focal in (0.0, -1.0, 1e-320, 1.0, 60.0, 130_000.0, 1e308)),
        *((lens(skew_px=skew), r"matrix_px\[0\]\[1\]") for skew in (-1e308, -100.0, 100.0, 1e308)),
        *((lens(centre_px=(x, 640.0)), r"matrix_px\[0\]\[2\]") for x in (-1e308, -800.0, 1500.0, 1e308)),
        (lens(centre_px=(360.0, 1e308)), r"matrix_px\[1\]\[2\]"),
        *(
            (lens(distortion=[value if i == place else 0.0 for i in range(5)]), "distortion")
            for place in range(5)
            for value in (-1e308, -1e3, 1e3, 1e308)
        ),
    ],
)
def test_a_lens_that_no_camera_has_is_named_with_its_key(file: bytes, key: str) -> None:
    with pytest.raises(UserError, match=rf"^calibration rig\.toml: camera 'cam01': .*{key}") as error:
        decode_rig(file, "rig.toml")
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300


@pytest.mark.parametrize("size", ["[70000, 1280]", "[720, 15]", f"[{10**18}, 1280]"])
def test_a_size_that_no_picture_has_is_named(size: str) -> None:
    with pytest.raises(UserError, match=r"^calibration rig\.toml: camera 'cam01': size_px .* is no picture"):
        decode_rig(GOOD.replace("[720, 1280]", size, 1).encode(), "rig.toml")


@pytest.mark.parametrize(
    "file",
    [
        lens(focal_px=330.0, distortion=[-0.35, 0.15, 0.001, 0.001, -0.03]),
        lens(focal_px=12_000.0, distortion=[-0.5, 90.0, 0.002, -0.003, -4000.0]),
        lens(skew_px=-2.0, centre_px=(300.0, 700.0)),
    ],
    ids=["an action camera", "a telephoto lens fitted to its noise", "pixels that are no squares"],
)
def test_a_strange_lens_is_one(file: bytes) -> None:
    decode_rig(file, "rig.toml")


def test_an_unknown_camera_is_named_with_those_that_are_known() -> None:
    with pytest.raises(UserError, match=r"'cam09' is not in the calibration.*cam01, cam02"):
        decode_rig(GOOD.encode(), "rig.toml").select(["cam01", "cam09"])
