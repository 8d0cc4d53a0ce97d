"""Equation 19 against another implementation, and where templates are found in a stream."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from models.arrays import Float
from services.evaluation.alignment import Spring, warp

ROOT = Path(__file__).parents[2]


def _motion(frames: int, seed: int) -> Float:
    return np.random.default_rng(seed).normal(size=(frames, 17, 3)).cumsum(axis=0)


CASES = ((40, 40, 5), (50, 37, 4), (37, 50, 4), (30, 30, None), (1, 20, None), (20, 1, 0), (1, 1, 0))
"""Frames of the one motion and of the other, and the band's radius."""


@pytest.mark.slow
def test_costs_and_paths_agree_with_tslearn(tmp_path: Path) -> None:
    pairs = {}
    for number, (frames, others, radius) in enumerate(CASES):
        pairs[f"ours{number}"], pairs[f"theirs{number}"] = (_motion(frames, 1), _motion(others, 2))
        pairs[f"radius{number}"] = np.array(-1 if radius is None else radius)
    file = tmp_path / "pairs.npz"
    flat = {name: array.reshape(len(array), -1) if array.ndim else array for name, array in pairs.items()}
    np.savez(file, allow_pickle=False, **flat)
    words = [sys.executable, "-m", "tests.tslearn_paths", str(file)]
    told = subprocess.run(words, capture_output=True, text=True, cwd=ROOT, timeout=100, check=True).stdout
    for number, ((_, _, radius), (path, cost)) in enumerate(zip(CASES, json.loads(told), strict=True)):
        found = warp(pairs[f"ours{number}"], pairs[f"theirs{number}"], radius)
        assert found.cost == pytest.approx(cost, rel=1e-9)
        assert found.path.tolist() == path


def test_the_cost_is_the_sum_along_the_path_also_where_joints_are_unknown() -> None:
    ours, theirs = _motion(30, 3), _motion(25, 4)
    ours[3:9, 5], theirs[10, 2:7], ours[20] = np.nan, np.nan, np.nan
    found = warp(ours, theirs)
    squared = ((ours[found.path[:, 0]] - theirs[found.path[:, 1]]) ** 2).sum(axis=2)
    known = np.isfinite(squared).sum(axis=1)
    each = np.divide(17 * np.nansum(squared, axis=1), known, out=np.zeros(len(known)), where=known > 0)
    assert found.cost == pytest.approx(each.sum(), rel=1e-12)


def test_an_instant_of_one_motion_is_found_in_the_other() -> None:
    motion = _motion(40, 5)
    slower = np.repeat(motion, 3, axis=0)
    found = warp(slower, motion)
    assert found.onto(10) == pytest.approx(31.0)
    assert found.onto(10.5) == pytest.approx(32.5)


@pytest.mark.parametrize(
    ("ours", "theirs", "radius"),
    [(_motion(0, 0), _motion(3, 0), None), (_motion(3, 0), _motion(0, 0), None), (_motion(3, 0), _motion(3, 0)[:, :5], None),
     (_motion(3, 0), _motion(3, 0), -1)],
)  # fmt: skip
def test_what_cannot_be_aligned_is_refused(ours: Float, theirs: Float, radius: int | None) -> None:
    with pytest.raises(ValueError, match="cannot be aligned"):
        warp(ours, theirs, radius)


def test_each_template_is_found_where_it_is_performed_whatever_the_tempo() -> None:
    first, second = _motion(30, 6), _motion(20, 7)
    stream = np.concatenate((_motion(50, 8) + 9, np.repeat(first, 2, axis=0), _motion(15, 9) - 9, second, _motion(10, 10) + 9))
    spring = Spring([first, second])
    costs = np.empty((len(stream), 2))
    starts = np.empty((len(stream), 2), np.int64)
    for number, frame in enumerate(stream):
        spring.push(frame)
        costs[number], starts[number] = spring.costs, spring.starts
    ends = costs.argmin(axis=0)
    assert costs.min(axis=0) == pytest.approx([0.0, 0.0])
    assert ends.tolist() == [108, 144]  # the first of two alike frames ends it
    assert starts[ends, [0, 1]].tolist() == [51, 125]


def test_the_stream_may_begin_anew() -> None:
    template = _motion(12, 11)
    spring = Spring([template])
    for frame in _motion(30, 12):
        spring.push(frame)
    spring.reset()
    assert np.isinf(spring.costs).all()
    for frame in template:
        spring.push(frame)
    assert spring.costs[0] == 0
    assert spring.starts[0] == 0


def test_a_search_for_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one"):
        Spring([])
    with pytest.raises(ValueError, match="at least one"):
        Spring([_motion(3, 0), _motion(0, 0)])
