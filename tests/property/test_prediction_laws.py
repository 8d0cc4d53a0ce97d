"""Where the camera stands must never matter to whether a crop can be predicted: at worst there is none."""

from typing import Any, cast

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.camera.pinhole import Camera
from models.skeleton import coco
from services.fusion.person_estimates import PersonEstimates
from services.fusion.prediction import predict_crop

metres = st.floats(-1.5, 1.5)
turns = st.floats(-3.2, 3.2)


class Standing:
    """A pupil whose joints are scattered over a body's volume."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.joints_m = rng.normal(0.0, (0.2, 0.1, 0.5), (coco.COUNT, 3))
        self.body = self

    def skeleton(self, _t_s: float) -> tuple[Any, Any]:
        return self.joints_m, np.ones(coco.COUNT, np.bool_)

    def at(self, t_s: float) -> Any:
        return np.array((4.0 * t_s, 0.0, 0.0, 4.0, 0.0, 0.0))


@given(st.tuples(metres, metres, metres), st.tuples(turns, turns, turns), st.integers(0, 99))
def test_a_pupil_who_stands_in_the_camera_s_plane_stops_nothing(
    place: tuple[float, float, float], angles: tuple[float, float, float], seed: int
) -> None:
    rotation = Rotation.from_euler("xyz", angles).as_matrix()
    matrix = np.array(((900.0, 0.0, 640.0), (0.0, 900.0, 360.0), (0.0, 0.0, 1.0)))
    camera = Camera("near", (1280, 720), matrix, np.zeros(5), rotation, -rotation @ np.array(place), np.zeros(2))
    prediction = predict_crop(cast(PersonEstimates, Standing(seed)), camera, 0)
    if prediction is not None:
        assert 32.0 <= prediction.at(100_000_000).side_px < 20 * 1280
