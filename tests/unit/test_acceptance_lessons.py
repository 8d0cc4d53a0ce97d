"""The lessons that figures are measured on: whatever is done in them, every camera of the corners could see all of it."""

import pytest

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.presets import SIX_ACTIONS, acceptance
from edge.simulation.lesson.programme import programme_of
from edge.simulation.lesson.stage import member_of
from tests.bench.seeds import seeds_of


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds_of("test"))
def test_every_attempt_is_in_the_picture_of_every_corner_camera(seed: int) -> None:
    plan = acceptance(seed)
    subject = member_of(plan, 0).subject
    motion, rig = programme_of(plan, 0, subject).motion, rig_of(plan)
    assert len(rig) == 4
    assert tuple(attempt.action for attempt in motion.attempts) == SIX_ACTIONS
    for attempt in motion.attempts:
        for t_s in (attempt.start_s, attempt.exertion_s, attempt.peak_s, attempt.end_s):
            points_m = subject.body.coco_m(motion.pose_at(t_s))
            for camera in rig:
                points_px = camera.project(points_m)
                inside = (points_px >= 0) & (points_px < camera.size_px)
                assert inside.all(), (attempt.action, t_s, camera.name, points_px[~inside.all(axis=1)])
