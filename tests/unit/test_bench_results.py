"""Figures by their fixed names, margins over others, and what a user of a data set is told."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.arrays import Float
from models.errors import UserError
from models.skeleton import coco
from tests.bench.networks.judge import errors, within5_pct
from tests.bench.networks.looks import Looked, blazepose_points, crop_of
from tests.bench.peers.score import Score
from tests.bench.reconstruct import on_shelf
from tests.bench.reconstruct.__main__ import main
from tests.bench.reconstruct.against_peers import OURS, Standing, margin_figures, mean_mpjpe_mm, table_rows
from tests.bench.reconstruct.lesson import UPRIGHT, Lesson
from tests.bench.reconstruct.measure import UPRIGHT_MEAN, Measured, Way, judged
from tests.bench.reconstruct.observed import Looking, Observed, look
from tests.bench.reconstruct.results import by_action_table, change_pct, dataset_figures, figures_of, rows_of
from tests.synthetic.drawn_lesson import dot_networks, drawn_lesson

pytestmark = pytest.mark.slow

ACTIONS = ("badminton_clear", "forward_roll")


@pytest.fixture(scope="module")
def lesson() -> Lesson:
    return drawn_lesson(2.0)


@pytest.fixture(scope="module")
def every_frame(lesson: Lesson) -> Measured:
    way = Way("every_frame", 30.0)
    return judged(
        lesson, way, ACTIONS, Observed(way.looking(lesson), look(lesson, way.looking(lesson), dot_networks()), "abc", 1.0)
    )


def test_every_action_has_its_figures_and_every_frame_its_bound(every_frame: Measured) -> None:
    assert set(every_frame.smooth) == {*ACTIONS, UPRIGHT_MEAN}
    assert every_frame.further["crb_mm"] > 0
    assert every_frame.further["each_frame_mpjpe_mm"] > 0
    assert np.isfinite(every_frame.further["jitter_reduction_pct"])
    assert every_frame.further["reprojection_rmse_px"] < 15
    assert every_frame.clip.actions.count("badminton_clear") == 22
    assert np.isfinite(every_frame.clip.points_px[20]).all()


def test_fewer_cameras_are_the_first_ones_of_the_rig(lesson: Lesson) -> None:
    assert Way("cams3", 15.0, 3).looking(lesson) == Looking(lesson.rig.names[:3], 15.0)


def test_the_headline_is_the_mean_of_the_five_upright_actions_and_nothing_without_one_of_them(every_frame: Measured) -> None:
    assert "mpjpe_mm.mean" not in figures_of(every_frame, "")
    figures = figures_of(every_frame, "")
    assert figures["mpjpe_mm.forward_roll"] == every_frame.smooth["forward_roll"]["mpjpe_mm"]
    one = every_frame.smooth["badminton_clear"]
    smooth = {action: one | {"mpjpe_mm": 10.0 * (number + 1)} for number, action in enumerate(UPRIGHT)} | {"forward_roll": one}
    whole = Measured("x", 0, "p", "w", smooth | {UPRIGHT_MEAN: one}, smooth, {}, {}, "abc", every_frame.clip)
    named = figures_of(whole, "")
    assert named["mpjpe_mm.mean"] == pytest.approx(30.0)
    for name in ("mpjpe_mm.p95", "pampjpe_mm.mean", "pck50_pct", "acc_error_mm", "max_jump_mm", "peak_speed_bias_pct"):
        assert name in named
    assert figures_of(whole, ".cams2") == {"mpjpe_mm.cams2": pytest.approx(30.0)}
    assert "mpjpe_mm.every_frame" in figures_of(whole, ".every_frame")


def test_a_data_sets_figures_have_the_names_of_the_rendered_lessons(every_frame: Measured) -> None:
    """Its actions are other ones, so that a mean is over films."""
    one = every_frame.smooth["badminton_clear"]
    smooth = dict.fromkeys(UPRIGHT, one) | {UPRIGHT_MEAN: one}
    whole = Measured("x", 0, "p", "w", smooth, smooth, {}, {}, "abc", every_frame.clip)
    for suffix in ("", ".every_frame"):
        found, known = dataset_figures([whole, whole], suffix), figures_of(whole, suffix)
        assert {name: found[name] for name in found if name in known} == pytest.approx({n: known[n] for n in known if n in found})
        assert set(found) - set(known) == {f"frames_without_pose{suffix}"}


def test_a_variant_on_fewer_lessons_is_compared_with_the_same_lessons(every_frame: Measured) -> None:
    def lesson_of(seed: int, mpjpe_mm: float) -> Measured:
        smooth = dict.fromkeys(UPRIGHT, every_frame.smooth["badminton_clear"] | {"mpjpe_mm": mpjpe_mm})
        return replace(every_frame, seed=seed, smooth=smooth)

    live = [lesson_of(seed, 10.0 * (seed + 1)) for seed in range(5)]
    assert change_pct([lesson_of(1, 30.0), lesson_of(0, 15.0)], live) == pytest.approx(50.0)
    assert np.isnan(change_pct([lesson_of(7, 30.0)], live))
    assert np.isnan(change_pct([every_frame], live)), "an action is missing"


def test_rows_name_the_instants_without_a_pose_and_the_commit_that_predicted_the_crops(every_frame: Measured) -> None:
    rows = rows_of(every_frame)
    assert [row["action"] for row in rows] == list(ACTIONS)
    assert all(row["without_pose_s"] == [] and row["crops_of_commit"] == "abc" for row in rows)
    table = by_action_table([every_frame], "every frame")
    assert [row[0] for row in table.rows] == list(ACTIONS)


def standing(seed: int, ours: float, theirs: float) -> Standing:
    def score(value: float) -> Score:
        return Score(value, 2 * value, 1.0, 0.0, 0)

    methods = {
        OURS: score(ours),
        "pose2sim.raw": score(2 * theirs),
        "pose2sim.butterworth": score(theirs),
        "aniposelib.plain": score(theirs),
    }
    return Standing(seed, dict.fromkeys(("run", "squat"), methods))


def test_a_margin_is_over_the_setting_that_came_out_best_on_the_mean() -> None:
    standings = [standing(0, 10.0, 20.0), standing(1, 20.0, 40.0)]
    figures = margin_figures(standings, ("run", "squat"), ("run",), ".live_rate")
    assert figures["margin_pct.pose2sim.live_rate"] == pytest.approx(50.0)
    assert figures["margin_pct.aniposelib.run.live_rate"] == pytest.approx(50.0)
    assert list(table_rows(standings, ("run", "squat"))) == [OURS, "pose2sim.butterworth", "aniposelib.plain"]


def test_without_an_action_there_is_no_mean_and_no_margin() -> None:
    assert mean_mpjpe_mm([standing(0, 1.0, 2.0)], ("run", "cartwheel")) == {}
    assert margin_figures([standing(0, 1.0, 2.0)], ("cartwheel",), (), "") == {}
    assert mean_mpjpe_mm([], ("run",)) == {}


def said(lesson: Lesson, off_m: float) -> dict[str, Looked]:
    """A network that sees every point so far beside the truth, across the line of sight."""
    found = {}
    for camera in lesson.rig:
        truth = lesson.pictures[camera.name]
        sideways = truth.points_m + off_m * camera.rotation[0]
        found[camera.name] = Looked(camera.project(sideways), np.ones(truth.points_px.shape[:2]))
    return found


def test_within_five_percent_of_height_is_at_the_bodys_distance_whatever_the_camera(lesson: Lesson) -> None:
    for share, expected in ((0.049, 100.0), (0.051, 0.0)):
        found = errors(lesson, said(lesson, share * lesson.stature_m), "thunder", "upright")
        assert [each.camera for each in found] == list(lesson.rig.names)
        assert within5_pct(found, ACTIONS) == expected


def test_hidden_joints_do_not_count_and_a_pupil_who_was_not_looked_at_does(lesson: Lesson) -> None:
    found = errors(lesson, said(lesson, 0.0), "thunder", "upright")
    half = np.arange(coco.COUNT) % 2 == 0
    for each in found:
        each.of_height[:, half] = 1.0
        each.visible[:, half] = False
    assert within5_pct(found, ACTIONS) == 100.0
    found[0].of_height[:] = np.nan
    assert within5_pct(found, ACTIONS) == pytest.approx(75.0)
    assert np.isnan(within5_pct(found, ("nothing",)))


def crop_points(seed: int = 0) -> Float:
    points: Float = drawn_lesson(0.1, seed=seed).pictures["cam0"].points_px[0]
    return points


def test_rotated_crops_turn_with_the_trunk_and_upright_ones_never() -> None:
    points = crop_points()
    middle = points.mean(axis=0)
    lying = (points - middle) @ np.array(((0.0, 1.0), (-1.0, 0.0))) + middle
    upright, rotated = (crop_of(lying, (1280, 720), "thunder", turn) for turn in ("upright", "rotated"))
    assert upright is not None
    assert rotated is not None
    assert upright.angle_rad == 0.0
    assert abs(rotated.angle_rad) == pytest.approx(np.pi / 2, abs=0.5)
    inside = rotated.to_crop(lying)
    assert (np.abs(inside - 0.5) < 0.5).all()


def test_a_pupil_who_is_out_of_the_picture_is_not_looked_at() -> None:
    assert crop_of(crop_points() + 5000.0, (1280, 720), "thunder", "upright") is None
    assert crop_of(np.full((17, 2), np.nan), (1280, 720), "thunder", "upright") is None


def test_blazeposes_landmarks_are_cocos_by_name() -> None:
    landmarks = np.zeros((39, 5))
    landmarks[:, 0], landmarks[:, 1] = np.arange(39), 100
    landmarks[:, 3:] = 4.0
    points, score = blazepose_points(landmarks.ravel(), 256)
    by_name = dict(zip(coco.NAMES, (points[:, 0] * 256).round().astype(int).tolist(), strict=True))
    expected = {"nose": 0, "left_eye": 2, "right_ear": 8, "left_shoulder": 11, "right_wrist": 16, "left_hip": 23, "right_ankle": 28}
    assert expected.items() <= by_name.items()
    assert (score > 0.9).all()


def test_a_folder_without_the_shelf_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"actorsGT\.mat"):
        on_shelf.run(tmp_path, tmp_path)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--dataset", "h36m"], "None is no folder"),
        (["--dataset", "h36m", "--path", "/nowhere"], "/nowhere is no folder"),
        (["--dataset", "h36m", "--path", "."], "camera-parameters.json is missing"),
        (["--dataset", "panoptic", "--path", "."], "calibration_*.json"),
        (["--dataset", "shelf", "--path", "."], "actorsGT.mat is missing"),
    ],
)
def test_a_data_set_that_is_not_there_is_one_line_and_exit_code_two(
    arguments: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    if "h36m" in arguments:
        np.savez(tmp_path / "data_3d_h36m.npz", positions_3d=np.array({}, dtype=object))
    monkeypatch.setattr("sys.argv", ["bench-reconstruct", "--data", str(tmp_path), *arguments])
    assert main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
