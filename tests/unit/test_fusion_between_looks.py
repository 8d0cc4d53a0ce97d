"""What happened between two looks is unsure: the more, the faster a joint moves and the seldomer it is looked at."""

import numpy as np
import pytest

from models.skeleton import coco
from services.fusion.between_looks import gaps_s, unsure_m2
from services.fusion.timing import Tracks
from services.fusion.views import Sighting

WRIST = coco.INDEX["left_wrist"]


def looked_at(rate_hz: float, cameras: int = 4, hidden_from: int = 99) -> Tracks:
    """Cameras that look in turn for 0.6 s; those from a number on do not see the left wrist."""
    tracks = Tracks(4, 24)
    for camera in range(cameras):
        usable = np.ones(coco.COUNT, np.bool_)
        usable[WRIST] = camera < hidden_from
        for t_s in np.arange(camera / (4 * rate_hz), 0.6 - 1e-9, 1 / rate_hz):
            tracks.add(camera, Sighting(camera, 0, float(t_s), np.zeros((coco.COUNT, 2)), np.ones(coco.COUNT), usable))
    return tracks


@pytest.mark.parametrize("rate_hz", [5.0, 10.0, 15.0])
def test_the_gap_is_from_one_look_to_the_next_of_all_cameras_together(rate_hz: float) -> None:
    assert gaps_s(looked_at(rate_hz), 0.0, 0.6) == pytest.approx(1 / (4 * rate_hz))


def test_a_joint_that_half_of_the_cameras_see_is_looked_at_half_as_often() -> None:
    gaps = gaps_s(looked_at(10.0, hidden_from=2), 0.0, 0.6)
    assert gaps[WRIST] == pytest.approx(2 * gaps[WRIST + 1])


def test_before_the_first_look_and_where_nobody_looks_there_is_no_division_by_nothing() -> None:
    nobody = Tracks(4, 24)
    assert (gaps_s(nobody, 0.0, -np.inf) == 0).all()
    assert gaps_s(nobody, 0.0, 0.6) == pytest.approx(0.6)


def test_a_joint_is_unsure_along_its_way_and_not_across_it() -> None:
    velocity = np.zeros((2, coco.COUNT, 3))
    velocity[1, WRIST] = (3.0, 0.0, 4.0)
    unsure = unsure_m2(velocity, np.full(coco.COUNT, 0.01))
    assert unsure[0] == pytest.approx(0.0)
    spread, along = np.linalg.eigh(unsure[1, WRIST])
    assert np.sqrt(np.maximum(spread, 0)) == pytest.approx([0.0, 0.0, 0.05], abs=1e-6)
    assert abs(along[:, 2] @ (0.6, 0.0, 0.8)) == pytest.approx(1.0)
