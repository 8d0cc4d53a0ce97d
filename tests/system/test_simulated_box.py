"""`make run` as it is shipped: the simulated lesson, the real networks, and a figure with the limbs that the pupil really has."""

from pathlib import Path

import numpy as np
import pytest

from edge.simulation.lesson.files import FOLDER, SHIPPED, TRUTH_NAME
from edge.simulation.truth import truth_file
from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from tests.installed import require_lesson
from tests.system.test_box import SITES, Tablet, limb_lengths_m, running, tablet

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]


LIMBS = np.array(list(coco.LIMBS.values()))
SAMPLES = 12


def seen_figures(client: Tablet) -> tuple[Float, Float]:
    """(T, limbs) metres and (T, 17, 2) millimetres on the floor, NaN where a joint was not seen, until every limb was
    seen often enough: on a busy machine, which looks seldom, hardly a figure of a fast movement is whole.
    """
    lengths_m: list[Float] = []
    floor_mm: list[Float] = []
    while not lengths_m or (np.isfinite(lengths_m).sum(axis=0) < SAMPLES).any():
        frame = client.motion()
        seen = frame.states == JointState.SEEN
        lengths_m.append(np.where(seen[LIMBS].all(axis=1), limb_lengths_m(frame), np.nan))
        floor_mm.append(np.where(seen[:, None], frame.positions_mm[:, :2], np.nan))
    return np.array(lengths_m), np.array(floor_mm)


def test_the_simulated_lesson_becomes_a_figure_with_the_limbs_of_its_pupil(tmp_path: Path) -> None:
    data = require_lesson()
    with running(tmp_path, SITES / "simulated") as box, tablet(box) as client:
        lengths_m, floor_mm = seen_figures(client)
    truth = truth_file.read(data / FOLDER / SHIPPED / TRUTH_NAME).cameras["cam01"].coco_m[:, 0]
    true_m = np.median([[np.linalg.norm(joints[a] - joints[b]) for a, b in coco.LIMBS.values()] for joints in truth], axis=0)
    assert np.abs(np.nanmedian(lengths_m, axis=0) / true_m - 1).max() < 0.25
    assert np.nanmax(np.abs(np.nanmedian(floor_mm, axis=0))) < 3000, "in the acting area"
