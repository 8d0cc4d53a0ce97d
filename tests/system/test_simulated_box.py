"""`make run` as it is shipped: the simulated lesson, the real networks, and a figure with the limbs that the pupil really has."""

from pathlib import Path

import numpy as np
import pytest

from edge.simulation.lesson.files import FOLDER, SHIPPED, TRUTH_NAME
from edge.simulation.truth import truth_file
from models.skeleton import coco
from tests.installed import ROOT, require_lesson
from tests.system.test_box import limb_lengths_m, running, tablet

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]


def test_the_simulated_lesson_becomes_a_figure_with_the_limbs_of_its_pupil(tmp_path: Path) -> None:
    data = require_lesson()
    with running(tmp_path, shipped=ROOT / "deploy/sites/simulated") as box, tablet(box) as client:
        frames = [client.pose() for _ in range(60)]
    truth = truth_file.read(data / FOLDER / SHIPPED / TRUTH_NAME).cameras["cam01"].coco_m[:, 0]
    true_m = np.median([[np.linalg.norm(joints[a] - joints[b]) for a, b in coco.LIMBS.values()] for joints in truth], axis=0)
    lengths_m = np.median([limb_lengths_m(frame) for frame in frames], axis=0)
    assert np.abs(lengths_m / true_m - 1).max() < 0.25
    assert np.abs(np.median([frame.positions_mm for frame in frames], axis=0)[:, :2]).max() < 3000, "in the acting area"
