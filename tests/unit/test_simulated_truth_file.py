"""The file of a lesson's truth: what is read is what was written, and of no other version."""

import io
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from edge.simulation.picture.shutter import Shutter
from edge.simulation.truth.truth import LessonTruth, Truth, joined, joined_lesson
from edge.simulation.truth.truth_file import _SHAPES, decode, encode, read
from edge.simulation.truth.visibility import Seen
from models.errors import UserError


def some_truth(count: int = 3, pupils: int = 2, seed: int = 0) -> Truth:
    generator = np.random.default_rng(seed)
    arrays: dict[str, Any] = {}
    for name, (kind, shape) in _SHAPES.items():
        size = (count, *(pupils if side == "P" else int(side) for side in shape))
        arrays[name] = generator.integers(0, 6, size).astype(kind) if kind is np.uint8 else generator.normal(size=size).astype(kind)
    return Truth(**arrays)


def some_lesson(count: int = 3, seed: int = 0) -> LessonTruth:
    return LessonTruth(
        origin="a plan",
        pupils=("A", "B"),
        shapes=np.zeros((2, 16)),
        rest_joints_m=np.ones((2, 24, 3)),
        shutter=Shutter(0.004, 0.016),
        sizes_px={"cam01": (1280, 720), "cam02": (640, 480)},
        cameras={"cam01": some_truth(count, seed=seed), "cam02": some_truth(count, seed=seed + 1)},
    )


def same(one: Truth, other: Truth) -> bool:
    return all(np.array_equal(getattr(one, field.name), getattr(other, field.name)) for field in fields(Truth))


def test_every_field_comes_back() -> None:
    lesson = some_lesson()
    found = decode(encode(lesson), "truth.npz")
    assert (found.origin, found.pupils, dict(found.sizes_px), found.shutter) == (
        lesson.origin,
        lesson.pupils,
        lesson.sizes_px,
        lesson.shutter,
    )
    assert np.array_equal(found.rest_joints_m, lesson.rest_joints_m)
    assert all(same(found.cameras[name], lesson.cameras[name]) for name in lesson.cameras)
    assert found.cameras["cam01"].coco_visible.any()
    assert np.array_equal(found.cameras["cam01"].coco_visible, lesson.cameras["cam01"].coco_seen == Seen.VISIBLE)


def test_the_same_truth_is_the_same_bytes() -> None:
    assert encode(some_lesson()) == encode(some_lesson())


def test_pieces_make_a_lesson() -> None:
    pieces = [some_lesson(3, 0), some_lesson(2, 5)]
    lesson = joined_lesson(pieces)
    assert len(lesson.cameras["cam01"]) == 5
    assert same(lesson.cameras["cam02"], joined([piece.cameras["cam02"] for piece in pieces]))
    with pytest.raises(ValueError, match="several lessons"):
        joined_lesson([pieces[0], replace(pieces[1], origin="another")])


def test_another_version_is_refused_and_named() -> None:
    data = encode(some_lesson())
    with np.load(io.BytesIO(data)) as archive:
        arrays = dict(archive)
    arrays["header"] = np.frombuffer(arrays["header"].tobytes().replace(b'"version":1', b'"version":2'), np.uint8)
    changed = io.BytesIO()
    np.savez(changed, allow_pickle=False, **arrays)
    with pytest.raises(UserError, match=r"truth\.npz: truth of version 2; this KineBox reads version 1; render"):
        decode(changed.getvalue(), "truth.npz")


@pytest.mark.parametrize("damage", ["nothing", "cut", "other", "shape", "locked"])
def test_what_is_no_truth_is_refused(damage: str) -> None:
    data = encode(some_lesson())
    other = io.BytesIO()
    np.savez(other, allow_pickle=False, something=np.zeros(3))
    lesson = some_lesson()
    wrong = replace(lesson, cameras={**lesson.cameras, "cam02": some_truth(3, pupils=3)})
    locked = bytearray(data)
    locked[data.index(b"PK\1\2") + 8] |= 1  # one bit says that what follows is encrypted
    damaged = {
        "nothing": b"",
        "cut": data[: len(data) // 2],
        "other": other.getvalue(),
        "shape": encode(wrong),
        "locked": bytes(locked),
    }[damage]
    with pytest.raises(UserError, match=r"truth\.npz: is no lesson's truth, or is damaged"):
        decode(damaged, "truth.npz")


def test_a_file_that_is_not_there_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"truth\.npz: cannot be read .* render the lesson again"):
        read(tmp_path / "truth.npz")
