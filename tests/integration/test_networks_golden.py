"""The converted networks compute what the original graphs do in TensorFlow.js, on real pictures.

`models/networks/build/golden` made the references. Differences are relative to the largest value of the tensor: the largest
found is 6e-6 (BlazePose's mask), 3e-6 otherwise; other processors sum in another order.
"""

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from edge.perception.detection import PersonDetector
from edge.perception.networks import load_network
from edge.perception.pose import find_peaks, load_pose_network
from models.arrays import Float, Float32, UInt8
from models.networks.build.golden.make import KEYPOINTS, SAMPLE_EVERY, read_rgb

GOLDEN = Path("tests/golden/networks")
DATA = Path("build")
PICTURES = json.loads((GOLDEN / "pictures.json").read_text())
CASES = [(network, picture) for picture, entry in PICTURES.items() for network in entry["networks"]]
MOVENET_CASES = [case for case in CASES if case[0].startswith("movenet")]
RELATIVE_MAX = 2e-5

pytestmark = pytest.mark.networks


@pytest.fixture(scope="module", autouse=True)
def installed() -> None:
    if not (DATA / "networks" / "installed.json").is_file():
        if os.environ.get("CI"):
            pytest.fail("build/networks is missing; run `make networks`")
        pytest.skip("THE NETWORKS ARE NOT TESTED: build/networks is missing; run `make networks`")


def picture(name: str) -> UInt8:
    """Exactly the pixels that TensorFlow.js was given."""
    pixels = read_rgb(GOLDEN / f"{name}.jpg")
    assert hashlib.sha256(pixels.tobytes()).hexdigest() == PICTURES[name]["pixels_sha256"], "another JPEG decoder: make them anew"
    return pixels


def references(network: str, name: str) -> Mapping[str, Float32]:
    with np.load(GOLDEN / "references.npz") as archive:
        prefix = f"{network}/{name}/"
        return {key.removeprefix(prefix): archive[key] for key in archive.files if key.startswith(prefix)}


@pytest.mark.parametrize(("network", "name"), CASES)
def test_every_output_agrees_with_the_original_graph(network: str, name: str) -> None:
    outputs = load_network(network, DATA)(picture(name)[np.newaxis])
    expected = references(network, name)
    assert set(outputs) == set(expected) - {KEYPOINTS}
    differences = {}
    for key, planes in outputs.items():
        pixels = planes.transpose(0, 2, 3, 1).ravel()[::SAMPLE_EVERY]
        assert pixels.shape == expected[key].shape
        differences[key] = float(np.abs(pixels - expected[key]).max() / np.abs(expected[key]).max())
    assert max(differences.values()) < RELATIVE_MAX, differences


@pytest.mark.parametrize(("network", "name"), MOVENET_CASES)
def test_the_chosen_cells_are_those_of_movenets_own_tail(network: str, name: str) -> None:
    outputs = load_network(network, DATA)(picture(name)[np.newaxis])
    peaks = find_peaks(outputs["centre"][0], outputs["heatmaps"][0], outputs["regressions"][0])
    joints = np.arange(17)
    cell = np.float32(np.float16(1 / outputs["centre"].shape[-1]))  # the tail's own constant, rounded as it is
    y = (peaks.rows + outputs["offsets"][0, 2 * joints, peaks.rows, peaks.columns]) * cell
    x = (peaks.columns + outputs["offsets"][0, 2 * joints + 1, peaks.rows, peaks.columns]) * cell
    scores = peaks.scores[joints, peaks.rows, peaks.columns]
    expected = references(network, name)[KEYPOINTS].reshape(17, 3)
    np.testing.assert_allclose(np.stack((y, x, scores), axis=1), expected, atol=5e-6)


@pytest.mark.parametrize(("network", "name"), MOVENET_CASES)
def test_the_vote_stays_within_a_cell_of_movenets_own_keypoints(network: str, name: str) -> None:
    pose = load_pose_network("thunder" if network.endswith("thunder") else "lightning", DATA)
    estimate = pose.estimate(picture(name))
    expected = references(network, name)[KEYPOINTS].reshape(17, 3)
    away = np.hypot(*(estimate.points - expected[:, 1::-1]).T)
    believed = expected[:, 2] > 0.3
    assert away[believed].max() < 1 / 64
    assert (estimate.sigma > 0).all()


@pytest.mark.parametrize("enlarged", [1, 2])
def test_the_detector_finds_both_people_of_the_room(enlarged: int) -> None:
    pixels = picture("room").repeat(enlarged, axis=0).repeat(enlarged, axis=1)
    if enlarged > 1:  # also a picture that is not square: a black strip to the right
        pixels = np.pad(pixels, ((0, 0), (0, 201), (0, 0)))
    boxes, scores = PersonDetector(load_network("nanodet", DATA)).detect(pixels)
    assert len(scores) >= 2
    # Pupil and bystander as drawn by hand in tests/data/footage_people.toml, at two thirds of the video's size, cut at row 300.
    drawn = np.array(((160, 213, 378, 774), (0, 190, 89, 509))) * 1.5 - (0, 300, 0, 300)
    for box in np.clip(drawn, 0, 1080) * enlarged * 416 / 1080:
        assert max(_overlap(box, found) for found in boxes[:2]) > 0.7


def _overlap(a: Float, b: Float) -> float:
    shared = np.prod(np.clip(np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2]), 0, None))
    return float(shared / (np.prod(a[2:] - a[:2]) + np.prod(b[2:] - b[:2]) - shared))
