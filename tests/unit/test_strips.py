"""Filmed strips of the actions: their page tells of every action and fault, their pictures are there and small."""

import cv2
import numpy as np
import pytest

from edge.simulation.picture.indexed_png import encode_indexed
from edge.simulation.rendering.strip import FOLDER, PAGE, moments_s, page, performances
from models.arrays import UInt8
from models.motions.actions.library import ACTIONS
from models.motions.motion import Attempt
from tests.installed import ROOT

MOST_BYTES = 350_000


def decoded(data: bytes) -> UInt8:
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    return picture.astype(np.uint8)


def test_a_picture_of_few_colours_is_written_as_it_is() -> None:
    picture = np.random.default_rng(1).integers(0, 5, (40, 33, 3)).astype(np.uint8) * 60
    np.testing.assert_array_equal(decoded(encode_indexed(picture, 200)), picture)


def test_a_picture_of_many_colours_is_near_and_the_same_each_time() -> None:
    rows, columns = np.mgrid[0:64, 0:96]
    picture = np.stack((2 * columns, 255 - 3 * rows, (rows + columns) // 2), axis=-1).astype(np.uint8)
    data = encode_indexed(picture, 64)
    assert data == encode_indexed(picture, 64)
    assert np.abs(decoded(data).astype(int) - picture).mean() < 12


def test_a_palette_that_png_cannot_hold_is_refused() -> None:
    with pytest.raises(ValueError, match="palette of 257 colours"):
        encode_indexed(np.zeros((4, 4, 3), np.uint8), 257)


def test_the_columns_hold_the_four_keyframes_in_their_order() -> None:
    moments = moments_s(Attempt("squat", "right", 0.3, 0.7, 1.5, 2.5))
    assert len(moments) == 8
    assert moments == sorted(moments)
    assert {0.3, 0.7, 1.5, 2.5} <= set(moments)


@pytest.mark.parametrize("name", ACTIONS)
def test_every_fault_has_a_row_and_a_line(name: str) -> None:
    faults = [fault.name for fault in ACTIONS[name].faults]
    assert [tuple(one.faults) for one in performances(ACTIONS[name])] == [(), *((fault,) for fault in faults)]
    for fault in ACTIONS[name].faults:
        assert f"| `{fault.name}` | {fault.what} |" in page()


@pytest.mark.slow
def test_the_page_is_as_the_actions_are_now() -> None:
    assert (ROOT / FOLDER / PAGE).read_text() == page(), "run `python -m edge.simulation.rendering.strip --page`, or `make strips`"


@pytest.mark.slow
@pytest.mark.parametrize("name", ACTIONS)
def test_every_action_has_its_picture(name: str) -> None:
    data = (ROOT / FOLDER / f"{name}.png").read_bytes()
    assert len(data) <= MOST_BYTES
    height, width = decoded(data).shape[:2]
    rows = len(ACTIONS[name].faults) + 1
    assert height > 100 * rows
    assert width > 800
