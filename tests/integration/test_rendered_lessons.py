"""A lesson that `kinebox simulate` rendered, as the benchmarks read it."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from edge.simulation.lesson.plan import PerformancePlan, Plan, PupilPlan, ShutterPlan
from edge.simulation.lesson.presets import tiny
from edge.simulation.lesson.stage import set_stage
from models.errors import UserError
from models.skeleton import coco
from tests.bench.reconstruct.lesson import START_NS
from tests.bench.reconstruct.rendered import render_all, rendered_lesson

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]


def plan() -> Plan:
    """Two small cameras, not synchronised; the pupil throws."""
    performs = [PerformancePlan(action="basketball_shot", wait_s=0.1)]
    return msgspec.structs.replace(
        tiny(2, 1.5), rate_hz=20.0, shutter=ShutterPlan(phases="free_running"), pupils=[PupilPlan(name="pupil", performs=performs)]
    )


def test_a_rendered_lesson_has_its_pictures_in_the_order_of_time_and_its_truth_at_every_instant(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no rendered lesson"):
        rendered_lesson(plan(), tmp_path)
    render_all([plan()], tmp_path)
    lesson = rendered_lesson(plan(), tmp_path)
    stage = set_stage(plan())
    pupil = stage.scene.pupils[0]
    assert lesson.stature_m == pytest.approx(pupil.body.stature_m)
    assert [span.action for span in lesson.spans] == ["basketball_shot"]
    assert lesson.length_s == pytest.approx(1.5)
    frames = list(lesson.frames(lesson.rig.names))
    assert len(frames) == 2 * 30
    times = [frame.t_mid_ns for frame in frames]
    assert times == sorted(times)
    for frame in frames[:6]:
        expected = lesson.pictures[frame.camera].times_s[frame.index]
        assert (frame.t_mid_ns - START_NS) * 1e-9 == pytest.approx(expected, abs=2e-9)
    instants = np.linspace(0.1, 1.3, 40)
    exact = np.stack([pupil.coco_m(float(t))[: coco.COUNT] for t in instants])
    assert np.linalg.norm(lesson.truth_m(instants) - exact, axis=-1).max() < 0.003
    for camera in lesson.rig:
        truth = lesson.pictures[camera.name]
        at_middle = camera.project(lesson.truth_m(truth.times_s[3:-3]))
        assert np.abs(at_middle - truth.points_px[3:-3]).max() < 6, (
            "as exposed, and at the picture's time: rows are read out in turn"
        )
        assert truth.visible.any()
        assert not truth.visible.all()
