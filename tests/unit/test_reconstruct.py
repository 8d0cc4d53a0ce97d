"""From pictures to figures: what is measured of a lesson whose every joint can be seen is how good fusion is, and nothing else."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from msgspec import structs

from edge.observe import PersonDetector
from models.arrays import Float
from models.messages.observation import Observation
from models.skeleton import coco
from tests.bench.closed_loop import Event
from tests.bench.reconstruct import observed as observed_module
from tests.bench.reconstruct.each_frame import frame_by_frame, looks_at_pupil
from tests.bench.reconstruct.figures import bound_mm, jitter_reduction_pct, judge, mean_over, noise_px, of_action
from tests.bench.reconstruct.fused import Fused, fuse
from tests.bench.reconstruct.keypoints import Seen, by_frame, interpolated, pupil_seen
from tests.bench.reconstruct.lesson import Lesson, Span
from tests.bench.reconstruct.observed import DELAY_NS, Looking, Observed, look, observed
from tests.synthetic.drawn_lesson import DotDetector, DotPose, dot_networks, drawn_lesson
from tests.synthetic.gym import ring_rig

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def lesson() -> Lesson:
    return drawn_lesson(2.0)


@pytest.fixture(scope="module")
def every_frame(lesson: Lesson) -> Observed:
    looking = Looking(lesson.rig.names, 30.0)
    return Observed(looking, look(lesson, looking, dot_networks()), "", 0.0)


@pytest.fixture(scope="module")
def seen(lesson: Lesson, every_frame: Observed) -> list[Seen]:
    return pupil_seen(lesson, lesson.rig.names, every_frame.events)


@pytest.fixture(scope="module")
def fused(lesson: Lesson, every_frame: Observed) -> Fused:
    return fuse(lesson.rig, every_frame.events, lesson.length_s)


def test_dots_are_seen_where_they_are_and_told_apart(seen: list[Seen]) -> None:
    for camera in seen:
        distance = np.linalg.norm(camera.points_px - camera.truth_px, axis=-1)[camera.used]
        assert np.median(distance) < 0.3
        assert camera.used.mean() > 0.8


def test_the_joints_of_visible_dots_are_within_millimetres_and_every_action_is_judged_by_its_own_frames(
    lesson: Lesson, fused: Fused
) -> None:
    judged = judge(lesson.spans, fused.times_s, fused.smooth_m, lesson.truth_m)
    assert [each.action for each in judged] == ["badminton_clear", "forward_roll"]
    assert judged[0].times_s[0] == pytest.approx(0.3)
    assert judged[1].times_s[-1] <= 1.95
    figures = of_action(judged[:1])
    assert figures["mpjpe_mm"] < 15
    assert figures["pampjpe_mm"] < 15
    assert figures["frames_without_pose"] == 0
    assert figures["pck50_pct"] > 95
    assert abs(figures["peak_speed_bias_pct"]) < 30


def test_the_smooth_pose_is_nearer_to_the_truth_than_the_live_one(lesson: Lesson, fused: Fused) -> None:
    smooth, live = (
        of_action(judge(lesson.spans, fused.times_s, joints, lesson.truth_m)) for joints in (fused.smooth_m, fused.live_m)
    )
    assert smooth["mpjpe_mm"] < live["mpjpe_mm"]


def test_an_answer_of_another_instant_is_charged_with_the_movement_between(lesson: Lesson) -> None:
    times_s = np.arange(60) / 30
    late = lesson.truth_m(np.maximum(times_s - 1 / 30, 0.0))
    figures = of_action(judge([Span("x", 0.5, 1.5)], times_s, late, lesson.truth_m))
    truth = lesson.truth_m(times_s)
    between = np.linalg.norm(truth[15:46] - truth[14:45], axis=-1)
    assert figures["mpjpe_mm"] == pytest.approx(1e3 * float(between.mean()))


def test_differences_are_never_taken_from_one_attempt_to_the_next() -> None:
    times_s = np.arange(60) / 30
    truth = np.zeros((60, coco.COUNT, 3))
    found = np.where(times_s[:, None, None] < 1.0, truth, truth + 1.0)
    spans = [Span("x", 0.0, 0.9), Span("x", 1.1, 1.9)]
    figures = of_action(judge(spans, times_s, found, lambda t: np.zeros((len(t), coco.COUNT, 3))))
    assert figures["max_jump_mm"] == 0.0
    assert figures["acc_error_mm"] == 0.0


def test_each_frame_alone_jitters_more_than_the_smooth_motion(lesson: Lesson, every_frame: Observed, fused: Fused) -> None:
    looks = looks_at_pupil(lesson.rig, every_frame.events, lesson.truth_m(fused.times_s))
    alone = frame_by_frame(lesson.rig, looks, len(fused.times_s))
    noisy = alone + np.random.default_rng(0).normal(scale=0.01, size=alone.shape)
    smooth, raw = (judge(lesson.spans, fused.times_s, joints, lesson.truth_m) for joints in (fused.smooth_m, noisy))
    assert jitter_reduction_pct(smooth, raw) > 50
    assert jitter_reduction_pct(raw, raw) == 0.0


def test_each_frame_alone_is_of_the_pupil_though_a_camera_is_surer_of_somebody_else(lesson: Lesson, every_frame: Observed) -> None:
    near_m = lesson.truth_m(np.arange(60) / 30)
    pupil = looks_at_pupil(lesson.rig, every_frame.events, near_m)
    others: list[Event] = []
    for one in pupil:
        (own,) = one.persons
        false = structs.replace(own, keypoints_px=own.keypoints_px + np.float32(150), score=np.ones(coco.COUNT, np.float32))
        others.append(structs.replace(one, persons=(false, own)) if one.camera in lesson.rig.names[:2] else one)
    alone = frame_by_frame(lesson.rig, pupil, 60)
    assert np.isfinite(alone).all(axis=2).mean() > 0.8
    assert float(np.nanmedian(np.linalg.norm(alone - near_m, axis=-1))) < 0.02
    np.testing.assert_array_equal(frame_by_frame(lesson.rig, looks_at_pupil(lesson.rig, others, near_m), 60), alone)


def test_the_bound_follows_from_the_noise_that_was_measured(lesson: Lesson, seen: list[Seen], fused: Fused) -> None:
    assert float(np.median(noise_px(lesson.rig.cameras[0], seen[0]))) < 0.2
    generator = np.random.default_rng(4)
    noisy = [
        Seen(
            one.camera,
            one.numbers,
            one.times_s,
            one.truth_px + generator.normal(scale=3.0, size=one.truth_px.shape) + (5.0, 0.0),
            np.ones_like(one.scores),
            one.truth_px,
            one.truth_m,
            one.visible,
        )
        for one in seen
    ]
    assert float(noise_px(lesson.rig.cameras[0], noisy[0]).mean()) == pytest.approx(3.0, rel=0.1), "a constant offset is no noise"
    bound = bound_mm(lesson.rig, noisy, fused.times_s, lesson.truth_m(fused.times_s))
    pixel_mm = 6.3 / 900 * 1e3
    assert float(np.nanmean(bound)) == pytest.approx(3.0 * pixel_mm * np.sqrt(3 / 8 * 3), rel=0.35)
    assert np.isfinite(bound).all()


def test_noise_is_told_in_the_pixels_of_the_bound_which_knows_no_lens() -> None:
    camera = replace(ring_rig(4).cameras[0], distortion=np.array((-0.25, 0.0, 0.0, 0.0, 0.0)))
    generator, count = np.random.default_rng(4), 200
    truth = np.array(camera.size_px) - (180.0, 80.0) + generator.uniform(-20, 20, (count, coco.COUNT, 2))

    def through_the_lens(flat_px: Float) -> Float:
        rays = np.concatenate(((flat_px - camera.matrix_px[:2, 2]) / camera.matrix_px[[0, 1], [0, 1]], np.ones((count, 17, 1))), -1)
        return camera.project((4.0 * rays - camera.translation_m) @ camera.rotation)

    noisy = truth + generator.normal(scale=3.0, size=truth.shape)
    points, truth_px = through_the_lens(noisy), through_the_lens(truth)
    assert float((points - truth_px).std()) < 2.5, "in a corner, a barrel makes all smaller"
    ones, numbers = np.ones((count, coco.COUNT)), np.arange(float(count))
    look = Seen(0, numbers, numbers / 30, points, ones, truth_px, np.zeros((count, coco.COUNT, 3)), ones.astype(np.bool_))
    assert float(noise_px(camera, look).mean()) == pytest.approx(3.0, rel=0.1)


def test_cameras_in_turns_are_interpolated_each_by_itself(lesson: Lesson) -> None:
    looking = Looking(lesson.rig.names, 15.0)
    seen = pupil_seen(lesson, looking.cameras, look(lesson, looking, dot_networks()))
    points, scores = interpolated(seen, 60)
    truth = np.stack([camera.project(lesson.truth_m(np.arange(60) / 30)) for camera in lesson.rig], axis=1)
    distance = np.linalg.norm(points - truth, axis=-1)[10:50]
    assert float(np.median(distance[scores[10:50] > 0.5])) < 1.5
    assert np.isfinite(points[10:50]).all()


def test_cameras_that_run_freely_count_at_their_own_times() -> None:
    lesson = drawn_lesson(1.2, phases_s=(0.0, 0.011, 0.019, 0.027))
    looking = Looking(lesson.rig.names, 30.0)
    events = look(lesson, looking, dot_networks())
    times = {event.camera: event.t_mid_ns % 1_000_000_000 for event in events if isinstance(event, Observation)}
    assert len(set(times.values())) == 4
    fused = fuse(lesson.rig, events, lesson.length_s)
    assert of_action(judge(lesson.spans, fused.times_s, fused.smooth_m, lesson.truth_m))["mpjpe_mm"] < 15


def test_a_mean_over_actions_needs_every_one_of_them() -> None:
    names = ("mpjpe_mm", "max_jump_mm", "frames_without_pose")
    figures = {"a": dict(zip(names, (1.0, 5.0, 1.0), strict=True)), "b": dict(zip(names, (3.0, 2.0, 2.0), strict=True))}
    assert mean_over(("a", "b"), figures) == {"mpjpe_mm": 2.0, "max_jump_mm": 5.0, "frames_without_pose": 3.0}
    assert mean_over(("a", "b", "c"), figures) == {}
    figures["b"]["max_jump_mm"] = np.nan
    assert np.isnan(mean_over(("a", "b"), figures)["max_jump_mm"]), "what is not known of one is not known of all"


def test_by_frame_keeps_what_each_camera_saw_of_each_picture(seen: list[Seen]) -> None:
    points, scores = by_frame(seen, 60)
    assert points[7, 2] == pytest.approx(seen[2].points_px[7], nan_ok=True)
    assert scores.shape == (60, 4, coco.COUNT)


def test_keypoints_are_made_once_for_the_same_pictures_and_anew_for_others(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def pose(name: str, data: Path) -> DotPose:
        made.append((name, data))
        return DotPose()

    def detector(*_: object) -> PersonDetector:
        return DotDetector()

    monkeypatch.setattr(observed_module, "load_pose_network", pose)
    monkeypatch.setattr(observed_module, "load_person_detector", detector)
    monkeypatch.setattr(observed_module, "read_network_file", lambda name, _: name.encode())
    short = drawn_lesson(0.5)
    looking = Looking(short.rig.names)
    first, second = observed(short, looking, tmp_path), observed(short, looking, tmp_path)
    assert len(made) == 1
    assert [repr(event) for event in first.events] == [repr(event) for event in second.events]
    observed(drawn_lesson(0.5, seed=1), looking, tmp_path)
    observed(short, Looking(short.rig.names[:3]), tmp_path)
    observed(short, looking, tmp_path, fresh=True)
    assert len(made) == 4
    for path in (tmp_path / "keypoints").iterdir():
        path.write_bytes(path.read_bytes()[:100])
    observed(short, looking, tmp_path)
    assert len(made) == 5, "a damaged file is as none"
    arrivals = [event for event in first.events if isinstance(event, Observation)]
    assert min(event.t_mid_ns for event in arrivals) + DELAY_NS < max(getattr(event, "t_ns", 0) for event in first.events)
