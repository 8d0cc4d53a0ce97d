"""Data sets that users hold: files of their formats are read as what they say; missing and foreign ones are named."""

import json
import pickle
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest
import scipy.io

from models.arrays import Float
from models.errors import UserError
from models.skeleton import coco
from tests.bench.datasets import h36m, panoptic, shelf
from tests.bench.datasets.track import between_samples
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

pytestmark = pytest.mark.slow

RIG = ring_rig(4, distorted=True)
SIZE = (64, 48)
COUNT = 30
LIMBS = [coco.INDEX[name] for name in h36m.JOINTS]


def write_film(path: Path, count: int = COUNT, rate: Fraction = Fraction(50)) -> None:
    """A film whose pictures become brighter, one by one."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("mpeg4", rate=rate)
        stream.width, stream.height, stream.pix_fmt = *SIZE, "yuv420p"
        for number in range(count):
            grey = np.full((SIZE[1], SIZE[0], 3), 6 * number % 250, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(grey, format="rgb24")))
        container.mux(stream.encode())


def places(rate_hz: float, count: int = COUNT) -> Float:
    return np.stack([Person().joints(k / rate_hz) for k in range(count)])


# Human3.6M


def write_h36m(folder: Path) -> None:
    truth = places(50.0)
    positions = np.zeros((COUNT, 32, 3), np.float32)
    for name, joint in h36m.JOINTS.items():
        positions[:, joint] = truth[:, coco.INDEX[name]]
    table = {"S1": {"Eating": positions}, "S9": {"Directions 1": positions, "Photo": positions, "Eating 2": positions}}
    np.savez_compressed(folder / "data_3d_h36m.npz", positions_3d=np.array(table, dtype=object))
    names = ("54138969", "55011271", "58860488", "60457274")
    cameras = {
        "intrinsics": {
            name: {"calibration_matrix": camera.matrix_px.tolist(), "distortion": camera.distortion.tolist()}
            for name, camera in zip(names, RIG, strict=True)
        },
        "extrinsics": {
            subject: {
                name: {"R": camera.rotation.round(9).tolist(), "t": (1e3 * camera.translation_m[:, None]).tolist()}
                for name, camera in zip(names, RIG, strict=True)
            }
            for subject in ("S1", "S9")
        },
    }
    (folder / "camera-parameters.json").write_text(json.dumps(cameras))
    for name in names:
        write_film(folder / f"S9/Videos/Directions 1.{name}.mp4")
        write_film(folder / f"S9/TakingPhoto.{name}.mp4")
    write_film(folder / f"S9/Videos/Eating 2.{names[0]}.mp4")  # the other views are missing


@pytest.fixture(scope="module")
def h36m_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("h36m")
    write_h36m(folder)
    return folder


def test_human36m_is_read_with_its_cameras_films_and_twelve_joints(h36m_folder: Path) -> None:
    lessons = h36m.load(h36m_folder, 100.0)
    assert [lesson.name for lesson in lessons] == ["S9 Directions 1", "S9 Photo"]
    lesson = lessons[0]
    times = np.arange(COUNT) / 50
    np.testing.assert_allclose(lesson.truth_m(times)[:, LIMBS], places(50.0)[:, LIMBS], atol=1e-6)
    assert np.isnan(lesson.truth_m(times)[:, :5]).all()
    for ours, theirs in zip(RIG, lesson.rig, strict=True):
        point = np.array((0.3, 0.2, 1.0))
        np.testing.assert_allclose(theirs.project(point), ours.project(point), atol=1e-4)
    assert lesson.spans[0].action == "directions"
    frames = list(lesson.frames(lesson.rig.names[:2]))
    assert len(frames) == 2 * COUNT
    assert [frame.t_mid_ns for frame in frames] == sorted(frame.t_mid_ns for frame in frames)
    assert frames[20].image().mean() == pytest.approx(60, abs=4)
    assert frames[0].image(2).shape == (24, 32, 3)
    assert len(list(h36m.load(h36m_folder, 0.2)[0].frames(lesson.rig.names[:1]))) == 10


def test_truth_between_samples_is_of_the_movement_and_gaps_stay_gaps() -> None:
    samples, times = places(25.0), np.arange(COUNT) / 25
    samples[12, 3] = np.nan
    truth = between_samples(times, samples)
    instants = np.arange(20, 50) / 30 * 0.7
    exact = np.stack([Person().joints(float(t)) for t in instants])
    found = truth(instants)
    assert np.nanmax(np.linalg.norm(found - exact, axis=-1)) < 0.03
    assert np.nanmedian(np.linalg.norm(found - exact, axis=-1)) < 0.0005
    inside = (instants > times[11]) & (instants < times[13])
    assert np.isnan(found[inside, 3]).all()
    assert np.isnan(truth(np.array([-0.1, 10.0]))).all()


def without(name: str) -> Callable[[Path], None]:
    def remove(folder: Path) -> None:
        (folder / name).unlink()

    return remove


def text_in(name: str, text: str) -> Callable[[Path], None]:
    def write(folder: Path) -> None:
        (folder / name).write_text(text)

    return write


class Evil:
    """What a file from hand to hand might hold."""

    def __reduce__(self) -> tuple[Any, ...]:
        return print, ("unpickled",)


def evil_positions(folder: Path) -> None:
    np.savez(folder / "data_3d_h36m.npz", positions_3d=np.array({"S9": Evil()}, dtype=object))


def few_joints(folder: Path) -> None:
    np.savez(folder / "data_3d_h36m.npz", positions_3d=np.array({"S9": {"Eating": np.zeros((9, 17, 3))}}, dtype=object))


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        (without("data_3d_h36m.npz"), "prepare_data_h36m.py"),
        (text_in("data_3d_h36m.npz", "no archive"), "is not what VideoPose3D"),
        (evil_positions, "which is no array"),
        (few_joints, "S9 Eating has the shape (9, 17, 3)"),
        (without("camera-parameters.json"), "camera-parameters.json is missing"),
        (text_in("camera-parameters.json", "{}"), "has no extrinsics.S9"),
        (text_in("camera-parameters.json", "[]"), "is not the calibration"),
        (text_in("camera-parameters.json", "{"), "no JSON"),
        (text_in("S9/Videos/Directions 1.55011271.mp4", "no film"), "is no video"),
    ],
)
def test_a_missing_or_foreign_file_of_human36m_is_named(
    tmp_path: Path, harm: Callable[[Path], None], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    write_h36m(tmp_path)
    harm(tmp_path)
    with pytest.raises(UserError) as error:
        h36m.load(tmp_path, 1.0)
    assert words in str(error.value)
    assert "unpickled" not in capsys.readouterr().out


def test_without_films_human36m_says_which_it_wants(tmp_path: Path) -> None:
    write_h36m(tmp_path)
    for path in tmp_path.rglob("*.mp4"):
        path.unlink()
    with pytest.raises(UserError, match="four views"):
        h36m.load(tmp_path, 1.0)


def test_a_film_that_ends_early_is_named(h36m_folder: Path) -> None:
    lesson = h36m.load(h36m_folder, 100.0)[0]
    film = lesson.frames.args[0]["54138969"]  # type: ignore[attr-defined]
    longer = type(film)(film.camera, film.path, film.size_px, film.rate_hz, 0, COUNT + 5)
    with pytest.raises(UserError, match=f"has {COUNT} pictures"):
        list(longer.frames())


# Panoptic

TO_STUDIO = np.array(((1.0, 0, 0), (0, 0, -1), (0, 1, 0)))
"""Ours (z up) to the studio's (y down)."""


def write_panoptic(folder: Path) -> None:
    cameras = []
    for node, camera in zip((0, 3, 12), RIG, strict=False):
        cameras.append(
            {
                "name": f"00_{node:02d}", "type": "hd", "panel": 0, "node": node, "resolution": list(SIZE),
                "K": camera.matrix_px.tolist(), "distCoef": camera.distortion.tolist(),
                "R": (camera.rotation @ TO_STUDIO.T).tolist(), "t": (100 * camera.translation_m[:, None]).tolist(),
            }
        )  # fmt: skip
    cameras.append({"name": "01_01", "type": "vga", "panel": 1, "node": 1})
    (folder / "calibration_toy.json").write_text(json.dumps({"cameras": cameras}))
    poses = folder / "hdPose3d_stage1_coco19"
    poses.mkdir()
    for number, points in enumerate(places(panoptic.RATE_HZ)):
        bodies = [body(7, points)] if number >= 4 else []
        if 10 <= number < 14:
            bodies.insert(0, body(2, points + 1.0))
        scene = {"version": 0.7, "univTime": 0.0, "fpsType": "hd_29_97", "bodies": bodies}
        (poses / f"body3DScene_{number + 100:08d}.json").write_text(json.dumps(scene))
    for node in (0, 3, 12):
        write_film(folder / f"hdVideos/hd_00_{node:02d}.mp4", 100 + COUNT, Fraction(30000, 1001))


def body(number: int, points_m: Float) -> dict[str, Any]:
    joints = np.full((19, 4), -1.0)
    for name, joint in panoptic.JOINTS.items():
        joints[joint] = (*(100 * TO_STUDIO @ points_m[coco.INDEX[name]]), 0.9)
    joints[panoptic.JOINTS["left_wrist"], 3] = -1.0
    return {"id": number, "joints19": joints.ravel().tolist()}


def test_panoptic_is_read_with_z_up_in_metres_from_the_first_scene_with_somebody(tmp_path: Path) -> None:
    write_panoptic(tmp_path)
    (lesson,) = panoptic.load(tmp_path, 100.0)
    assert lesson.rig.names == ("00_00", "00_03", "00_12")
    for ours, theirs in zip(RIG, lesson.rig, strict=False):
        point = np.array((0.3, 0.2, 1.0))
        np.testing.assert_allclose(theirs.project(point), ours.project(point), atol=1e-6)
    joints = [coco.INDEX[name] for name in panoptic.JOINTS if name != "left_wrist"]
    times = np.arange(COUNT - 4) / panoptic.RATE_HZ
    np.testing.assert_allclose(lesson.truth_m(times)[:, joints], places(panoptic.RATE_HZ)[4:, joints], atol=1e-6)
    assert np.isnan(lesson.truth_m(times)[:, coco.INDEX["left_wrist"]]).all(), "without confidence it is not known"
    first = next(iter(lesson.frames(["00_03"])))
    assert first.image().mean() == pytest.approx((6 * 104) % 250, abs=8), "picture 104 belongs to scene 104"


def test_missing_and_foreign_files_of_panoptic_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"0 files calibration_"):
        panoptic.load(tmp_path, 1.0)
    (tmp_path / "calibration_toy.json").write_text("[]")
    with pytest.raises(UserError, match="no calibration of the Panoptic Studio"):
        panoptic.load(tmp_path, 1.0)
    (tmp_path / "calibration_toy.json").unlink()
    write_panoptic(tmp_path)
    scene = tmp_path / "hdPose3d_stage1_coco19/body3DScene_00000105.json"
    scene.write_text('{"bodies": [{"id": 1, "joints19": [1, 2, 3]}]}')
    with pytest.raises(UserError, match=r"body3DScene_00000105.json is no scene"):
        panoptic.load(tmp_path, 1.0)
    scene.write_text('{"bodies": []}')
    for node in (3, 12):
        (tmp_path / f"hdVideos/hd_00_{node:02d}.mp4").unlink()
    with pytest.raises(UserError, match="holds 1 films"):
        panoptic.load(tmp_path, 1.0)


# Shelf


def write_shelf(folder: Path, frames: range) -> None:
    truth = places(25.0)
    cells = np.empty((1, 2), dtype=object)
    for actor in range(2):
        poses = np.empty((frames.stop, 1), dtype=object)
        for frame in range(frames.stop):
            there = frame in frames and (actor == 0 or frame % 2)
            poses[frame, 0] = shelf_joints(truth[frame - frames.start]) + actor if there else np.zeros((0, 0))
        cells[0, actor] = poses
    outer = np.empty((1, 1), dtype=object)
    outer[0, 0] = cells
    scipy.io.savemat(folder / "actorsGT.mat", {"actor3D": outer})
    calibration = {}
    for number, camera in enumerate(RIG):
        calibration[str(number)] = {
            "fx": camera.matrix_px[0, 0], "fy": camera.matrix_px[1, 1], "cx": camera.matrix_px[0, 2], "cy": camera.matrix_px[1, 2],
            "k": [[camera.distortion[0]], [camera.distortion[1]], [0.0]], "p": [[camera.distortion[2]], [camera.distortion[3]]],
            "R": camera.rotation.tolist(), "T": (1e3 * camera.centre_m[:, None]).tolist(),
        }  # fmt: skip
        for frame in frames:
            path = folder / f"Camera{number}/img_{frame:06d}.png"
            path.parent.mkdir(exist_ok=True)
            cv2.imwrite(str(path), np.full((SIZE[1], SIZE[0], 3), frame, np.uint8))
    (folder / "calibration_shelf.json").write_text(json.dumps(calibration))


def shelf_joints(points_m: Float) -> Float:
    names = ("right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle", "right_wrist", "right_elbow",
             "right_shoulder", "left_shoulder", "left_elbow", "left_wrist")  # fmt: skip
    limbs = points_m[[coco.INDEX[name] for name in names]]
    return np.vstack((limbs, limbs[[8, 9]].mean(axis=0), points_m[0] + (0, 0, 0.2)))


def test_the_shelf_is_read_with_its_actors_cameras_and_pictures(tmp_path: Path) -> None:
    frames = range(5, 15)
    write_shelf(tmp_path, frames)
    film = shelf.load(tmp_path, frames)
    assert [sorted(people) for people in film.truth] == [["0", "1"] if frame % 2 else ["0"] for frame in frames]
    expected = shelf_joints(places(25.0)[3])
    np.testing.assert_allclose(film.truth[3]["0"][:14], expected)
    np.testing.assert_allclose(film.truth[3]["0"][14], expected[[2, 3]].mean(axis=0))
    for ours, theirs in zip(RIG, film.rig, strict=True):
        point = np.array((0.3, 0.2, 1.0))
        np.testing.assert_allclose(theirs.project(point), ours.project(point), atol=1e-6)
    assert shelf.picture(film.paths["2"][4]).mean() == 9


def test_missing_and_foreign_files_of_the_shelf_are_named(tmp_path: Path) -> None:
    frames = range(5, 8)
    with pytest.raises(UserError, match=r"actorsGT.mat is missing"):
        shelf.load(tmp_path, frames)
    scipy.io.savemat(tmp_path / "actorsGT.mat", {"other": np.zeros(3)})
    with pytest.raises(UserError, match="has no actor3D"):
        shelf.load(tmp_path, frames)
    (tmp_path / "actorsGT.mat").write_bytes(pickle.dumps("no matlab"))
    with pytest.raises(UserError, match="no MATLAB file"):
        shelf.load(tmp_path, frames)
    write_shelf(tmp_path, frames)
    (tmp_path / "Camera2/img_000006.png").unlink()
    with pytest.raises(UserError, match=r"img_000006.png is missing"):
        shelf.load(tmp_path, frames)


def test_a_camera_of_the_shelf_without_focal_length_is_named(tmp_path: Path) -> None:
    frames = range(5, 7)
    write_shelf(tmp_path, frames)
    calibration = json.loads((tmp_path / "calibration_shelf.json").read_text())
    del calibration["3"]["fx"]
    (tmp_path / "calibration_shelf.json").write_text(json.dumps(calibration))
    with pytest.raises(UserError, match="camera 3 has no fx"):
        shelf.load(tmp_path, frames)
