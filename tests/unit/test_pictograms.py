"""The little figures of the actions on the page."""

import json

from models.motions.actions.library import ACTIONS
from services.tablet import pictograms

DRAWN = json.loads(pictograms.FILE.read_text(encoding="utf-8"))


def test_every_action_has_one() -> None:
    assert set(DRAWN) == set(ACTIONS)


def test_all_lie_on_their_grid() -> None:
    for drawing in DRAWN.values():
        for x, y in (point for stroke in (*drawing["far"], *drawing["near"], drawing["trunk"]) for point in stroke):
            assert 0 < x < pictograms.GRID
            assert 0 < y < pictograms.GRID
        for x, y, radius in (drawing["head"], *drawing["balls"]):
            assert radius < min(x, y, pictograms.GRID - x, pictograms.GRID - y)


def test_they_are_what_the_program_draws() -> None:
    assert pictograms.pictogram("squat") == DRAWN["squat"], "run 'python -m services.tablet.pictograms'"
