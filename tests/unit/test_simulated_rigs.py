import json
from pathlib import Path

import numpy as np
import pytest

from edge.simulation.rigs.arrangements import ACTING_RADIUS_M, NAMES, TALLEST_M, make_rig
from edge.simulation.split import SPLITS, Split
from models.camera.rig import decode_rig, encode_rig
from models.errors import UserError

FIGURES = Path(__file__).parents[3] / "shared/data/rigs/h36m_subject9.json"
SEEDS = range(5)
COUNTS = {"corners": 4, "row": 4, "three": 3, "two": 2, "long_room": 8, "h36m_s9": 4}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("split", SPLITS)
def test_a_pupil_anywhere_in_the_acting_area_is_wholly_seen_by_every_camera(name: str, split: Split) -> None:
    radius, angle, height = np.meshgrid((0, 0.5, 1), np.linspace(0, 2 * np.pi, 16), np.linspace(0, TALLEST_M, 5))
    places = np.stack((ACTING_RADIUS_M * radius * np.cos(angle), ACTING_RADIUS_M * radius * np.sin(angle), height), axis=-1)
    for seed in SEEDS:
        rig = make_rig(name, split, seed)
        assert len(rig) == COUNTS[name]
        for camera in rig:
            pixels = camera.project(places)
            assert (pixels >= 0).all()
            assert (pixels <= np.array(camera.size_px) - 1).all()


@pytest.mark.parametrize("name", [name for name in NAMES if name != "h36m_s9"])
def test_cameras_are_those_of_a_gym_and_no_lens_belongs_to_both_splits(name: str) -> None:
    degrees: dict[Split, set[int]] = {split: set() for split in SPLITS}
    for split in SPLITS:
        for camera in (camera for seed in SEEDS for camera in make_rig(name, split, seed)):
            assert camera.size_px == (1280, 720)
            assert 2.2 <= camera.centre_m[2] <= 3.0
            assert 5.0 <= np.linalg.norm(camera.centre_m[:2]) <= 9.0
            middle = camera.matrix_px[:2, 2]
            edge = camera.undistort(middle + np.array((640.0, 0.0))) - middle
            field = 2 * np.degrees(np.arctan(edge[0] / camera.matrix_px[0, 0]))
            assert 70 < field < 90
            degrees[split].add(int(field))
    assert not degrees["development"] & degrees["test"]


@pytest.mark.parametrize("name", NAMES)
def test_lenses_can_be_undone_all_over_the_picture(name: str) -> None:
    for camera in make_rig(name, "test", 3):
        width, height = camera.size_px
        pixels = np.stack(np.meshgrid(np.linspace(0, width - 1, 9), np.linspace(0, height - 1, 7)), axis=-1).reshape(-1, 2)
        flat = camera.matrix_px[:2, :2]
        rays = np.column_stack(((camera.undistort(pixels) - camera.matrix_px[:2, 2]) @ np.linalg.inv(flat).T, np.ones(len(pixels))))
        world = (4 * rays - camera.translation_m) @ camera.rotation
        assert camera.project(world) == pytest.approx(pixels, abs=0.1)


def test_a_seed_gives_the_same_rig_twice_and_another_seed_another() -> None:
    same, again, other = make_rig("corners", "test", 1), make_rig("corners", "test", 1), make_rig("corners", "test", 2)
    assert encode_rig(same, "") == encode_rig(again, "")
    assert encode_rig(same, "") != encode_rig(other, "")
    assert encode_rig(decode_rig(encode_rig(same, ""), "rig"), "") == encode_rig(same, "")


def test_unknown_rig_is_refused_by_name() -> None:
    with pytest.raises(UserError, match="no rig 'circle'; there are corners"):
        make_rig("circle")


@pytest.mark.shared_data
@pytest.mark.skipif(not FIGURES.exists(), reason="the calibration of Human3.6M is not there")
def test_h36m_figures_are_those_of_its_calibration() -> None:
    original = json.loads(FIGURES.read_text())
    points = np.random.default_rng(0).uniform((-1.5, -1.5, 0), (1.5, 1.5, 1.9), (50, 3))
    for camera, own in zip(make_rig("h36m_s9"), sorted(original), strict=True):
        entry = {key: np.array(original[own][key]) for key in "RTcfkp"}
        local = (points - entry["T"].ravel()) @ entry["R"]  # stored column by column
        x, y = (local[:, :2] / local[:, 2:]).T
        (k1, k2, k3), (p1, p2), r2 = entry["k"].ravel(), entry["p"].ravel(), x * x + y * y
        radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
        seen = np.stack(
            (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y), 1
        )
        assert camera.project(points) == pytest.approx(seen * entry["f"].ravel() + entry["c"].ravel(), abs=0.01)
        assert camera.size_px == (original[own]["w"], original[own]["h"])
