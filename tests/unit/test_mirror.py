"""A mirror image is another person: whose legs differ cannot do the mirror image of what he does with the other hand."""

import numpy as np
import pytest

from edge.simulation.lesson.presets import acceptance
from edge.simulation.lesson.stage import member_of
from edge.simulation.people.casting import cast
from models.body.pose import from_vector, mirrored
from models.motions.mirror import mirror_image
from models.motions.motion import Handed
from models.motions.perform import perform
from models.motions.performance import Performance
from models.skeleton import coco_feet, smpl
from tests.motion_laws import measured

FLIP = np.array((1.0, -1.0, 1.0))


def test_the_mirror_image_in_the_mirrored_pose_is_what_a_mirror_shows() -> None:
    subject = cast("test", 1).subject
    image = mirror_image(subject)
    for seed in range(3):
        pose = from_vector(np.random.default_rng(seed).normal(0, 0.4, 75))
        other = mirrored(pose)
        assert image.body.joints_m(other) == pytest.approx(subject.body.joints_m(pose)[list(smpl.MIRROR)] * FLIP, abs=1e-9)
        assert image.body.coco_m(other) == pytest.approx(subject.body.coco_m(pose)[list(coco_feet.MIRROR)] * FLIP, abs=1e-9)
        assert image.body.vertices_m(other) == pytest.approx(subject.body.vertices_m(pose) * FLIP, abs=1e-9)
    assert image.body.volume_m3 == pytest.approx(subject.body.volume_m3)
    assert image.body.stature_m == pytest.approx(subject.body.stature_m)


@pytest.mark.slow
@pytest.mark.parametrize("handed", ["left", "right"])
@pytest.mark.parametrize("action", ["forward_roll", "cartwheel"])
def test_pupils_whose_legs_differ_stand_on_both_feet_before_and_after(action: str, handed: Handed) -> None:
    for seed in (101, 102):  # of whom one has legs that differ by 2 mm
        subject = member_of(acceptance(seed), 0).subject
        motion = perform(Performance(action, handed=handed), subject)
        found = measured(motion, subject, every=1000)
        assert max(found.from_stand_deg, found.to_stand_deg) <= 0.1, found
        assert found.slide_mm <= 2.0, found
        assert motion.attempts[0].handed == handed
