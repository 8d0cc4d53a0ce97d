"""A body's file is read strictly: every refusal names the key; the shipped files are those that the exporter recorded."""

import io
import json
from collections.abc import Callable
from importlib.resources import files
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import models.body
from models.body.build.archive import encode, hashes
from models.body.build.smpl import convert
from models.body.file import decode
from models.errors import UserError
from models.skeleton import smpl
from tests.bodies import LARGE, SMALL, body_bytes, body_model
from tests.synthetic.toy_smpl import official_content

Arrays = dict[str, npt.NDArray[Any]]


def toy_arrays() -> Arrays:
    return arrays_of(convert(official_content(), "toy.pkl"))


def arrays_of(data: bytes) -> Arrays:

    with np.load(io.BytesIO(data)) as content:
        return dict(content)


def with_prior(arrays: Arrays) -> Arrays:
    size = arrays["shapedirs"].shape[2]
    return arrays | {
        "prior_ages": np.array((5.0, 65.0)),
        "prior_mean": np.zeros((2, 2, size)),
        "prior_cov": np.tile(np.eye(size), (2, 2, 1, 1)),
    }


@pytest.mark.parametrize("name", [SMALL, LARGE])
def test_shipped_files_are_the_exporters(name: str) -> None:
    record = json.loads(files(models.body).joinpath("data/figures.json").read_text())["files"][name]
    data = body_bytes(name)
    assert hashes(arrays_of(data)) == record["sha256"]
    assert len(data) == record["bytes"]
    model = body_model(name)
    assert (len(model.skin.vertices), len(model.faces)) == (record["vertices"], record["faces"])


def test_the_same_content_gives_the_same_bytes() -> None:
    arrays = toy_arrays()
    assert encode(arrays) == encode(dict(reversed(arrays.items())))
    assert decode(encode(with_prior(arrays)), "toy").prior is not None


REQUIRED = (
    "source", "v_template", "shapedirs", "posedirs", "weights", "f", "kintree_table", "J_template", "J_shapedirs", "J_regressor",
)  # fmt: skip


@pytest.mark.parametrize("key", REQUIRED)
def test_a_missing_key_is_named(key: str) -> None:
    arrays = toy_arrays()
    del arrays[key]
    with pytest.raises(UserError, match=rf"^toy\.npz: {key} is missing"):
        decode(encode(arrays), "toy.npz")


def _set(key: str, change: Callable[[npt.NDArray[Any]], npt.NDArray[Any]]) -> tuple[str, Callable[[Arrays], Arrays]]:
    return key, lambda arrays: arrays | {key: change(arrays[key])}


def _spoilt(place: tuple[int, ...], value: float) -> Callable[[npt.NDArray[Any]], npt.NDArray[Any]]:
    def change(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
        array = array.copy()
        array[place] = value
        return array

    return change


WRONG = [
    _set("version", lambda version: version + 1),
    _set("v_template", lambda array: array[:, :2]),
    _set("v_template", _spoilt((0, 0), np.nan)),
    _set("v_template", lambda array: array.astype(np.int64)),
    _set("shapedirs", lambda array: array[:-1]),
    _set("shapedirs", lambda array: array[:, :, :0]),
    _set("posedirs", lambda array: array[:, :, :-1]),
    _set("posedirs", _spoilt((0, 0, 0), np.inf)),
    _set("weights", _spoilt((3, 2), 0.5)),
    _set("weights", lambda array: np.hstack((array[:, :1] - 1, array[:, 1:2] + 1, array[:, 2:]))),
    _set("f", _spoilt((0, 0), 10_000)),
    _set("f", lambda array: array.astype(np.float64)),
    _set("kintree_table", _spoilt((0, 5), 1)),
    _set("J_template", _spoilt((0, 2), 0.1)),
    _set("J_shapedirs", lambda array: array[:, :, :-1]),
    _set("J_regressor", lambda array: array * 0.9),
    _set("prior_mean", lambda array: array[:1]),
    _set("prior_cov", lambda array: -array),
    _set("prior_ages", lambda array: array[::-1]),
    ("surprise", lambda arrays: arrays | {"surprise": np.zeros(3)}),
    ("prior_cov", lambda arrays: {key: value for key, value in arrays.items() if key != "prior_cov"}),
    ("v_part", lambda arrays: arrays | {"part_names": np.array(["body"])}),
    ("v_part", lambda arrays: arrays | {"part_names": np.array(["body"]), "v_part": np.ones(60, np.uint8)}),
    ("coco_regressor", lambda arrays: arrays | {"coco_regressor": np.zeros((23, 60))}),
    ("coco_regressor", lambda arrays: arrays | {"coco_regressor": np.full((17, 60), 1 / 60)}),
]


@pytest.mark.parametrize(("key", "spoil"), WRONG, ids=[f"{key}-{number}" for number, (key, _) in enumerate(WRONG)])
def test_a_wrong_key_is_named(key: str, spoil: Callable[[Arrays], Arrays]) -> None:
    with pytest.raises(UserError, match=rf"^toy\.npz: {key} "):
        decode(encode(spoil(with_prior(toy_arrays()))), "toy.npz")


@pytest.mark.parametrize("data", [b"", b"nonsense", b"PK\x03\x04 cut off"])
def test_what_is_no_archive_is_refused_in_one_line(data: bytes) -> None:
    with pytest.raises(UserError, match=r"^toy\.npz: is no body's file, or is damaged"):
        decode(data, "toy.npz")


def test_a_damaged_file_is_refused() -> None:
    data = bytearray(body_bytes())
    for place in range(2000, len(data), 5000):
        data[place] ^= 0xFF
    with pytest.raises(UserError, match="toy"):
        decode(bytes(data), "toy.npz")


def test_an_official_file_that_was_not_converted_is_told_so() -> None:
    content = official_content()
    arrays = {key: np.asarray(content[key]) for key in ("v_template", "shapedirs", "weights", "f")}
    with pytest.raises(UserError, match=r"convert an official SMPL file with models\.body\.build\.smpl"):
        decode(encode(arrays), "smpl.npz")


def test_nothing_is_unpickled() -> None:
    arrays = toy_arrays()

    out = io.BytesIO()
    np.savez(out, allow_pickle=True, **(arrays | {"source": np.array({"a": 1}, dtype=object)}))
    with pytest.raises(UserError, match="is no body's file"):
        decode(out.getvalue(), "toy.npz")


@pytest.mark.parametrize("name", [SMALL, LARGE])
def test_the_shipped_surface_is_closed_and_faces_outwards(name: str) -> None:
    model = body_model(name)
    edges = np.concatenate([model.faces[:, [corner, (corner + 1) % 3]] for corner in range(3)])
    assert len(np.unique(edges, axis=0)) == len(edges)
    there = {tuple(edge) for edge in edges.tolist()}
    assert all((end, start) in there for start, end in there)
    assert model.shaped(np.zeros(model.shape_count)).volume_m3 > 0.02


def test_every_part_of_the_body_is_named_and_none_is_empty() -> None:
    model = body_model(LARGE)
    counts = np.bincount(model.vertex_parts, minlength=len(model.part_names))
    assert counts.min() > 20, dict(zip(model.part_names, counts, strict=True))
    places = model.skin.vertices
    for name in smpl.NAMES[4:6]:
        shank = model.part_names.index(f"{name.split('_')[0]}_shank")
        assert (np.sign(places[model.vertex_parts == shank, 1]) == (1 if name.startswith("left") else -1)).all()
    hair, face = (places[model.vertex_parts == model.part_names.index(part)] for part in ("hair", "face"))
    assert hair[:, 2].max() > face[:, 2].max()
    assert face[:, 0].mean() > hair[:, 0].mean()
