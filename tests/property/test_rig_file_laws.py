"""A rig that is written is read back to the last digit."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import MIN_BASELINE_M, Rig, decode_rig, encode_rig


def rotation(vector: Float) -> Float:
    """The rotation of a quaternion with real part 1 (Cayley)."""
    x, y, z = vector
    cross = np.array(((0, -z, y), (z, 0, -x), (-y, x, 0)))
    turned: Float = np.linalg.solve(np.eye(3) - cross, np.eye(3) + cross)
    return turned


cameras = st.builds(
    lambda name, size, focal, centre, distortion, vector, translation, shift: Camera(
        name,
        size,
        np.array(((focal * max(size), 0, centre[0] * size[0]), (0, focal * max(size), centre[1] * size[1]), (0, 0, 1))),
        distortion,
        rotation(vector),
        translation,
        shift,
    ),
    st.text(min_size=1, max_size=12).filter(lambda name: name.isprintable()),
    st.tuples(st.integers(16, 8000), st.integers(16, 8000)),
    st.floats(1.5, 50),
    arrays(np.float64, 2, elements=st.floats(-0.5, 1.5)),
    arrays(np.float64, 5, elements=st.floats(-1, 1)),
    arrays(np.float64, 3, elements=st.floats(-2, 2)),
    arrays(np.float64, 3, elements=st.floats(-900, 900)),
    arrays(np.float64, 2, elements=st.floats(-15, 15)),
)


@pytest.mark.slow
@given(st.lists(cameras, min_size=1, max_size=4, unique_by=lambda camera: camera.name), st.text())
def test_round_trip(written: list[Camera], source: str) -> None:
    assume(all(np.linalg.norm(a.centre_m - b.centre_m) > 2 * MIN_BASELINE_M for a, b in combinations(written, 2)))
    read = decode_rig(encode_rig(Rig(tuple(written)), source), "rig.toml")
    assert read.names == tuple(camera.name for camera in written)
    for a, b in zip(written, read, strict=True):
        assert a.size_px == b.size_px
        for field in ("matrix_px", "distortion", "rotation", "translation_m", "shift_px"):
            assert np.array_equal(getattr(a, field), getattr(b, field))
