"""Laws of the benchmarks' measures: what must not change a figure, and how it must change."""

from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from models.arrays import Float
from models.skeleton import coco
from tests.bench.metrics.alignment import pampjpe_mm
from tests.bench.metrics.bound import triangulation_bound_m
from tests.bench.metrics.correctness import pck_auc_pct, pck_pct, right_parts
from tests.bench.metrics.position import distances_m, position_error
from tests.bench.metrics.retrieval import Retrieval, intervals, moments
from tests.bench.metrics.steadiness import acceleration_error_mm, jitter_mm, largest_jump_mm, peak_speed_m_s
from tests.synthetic.gym import ring_rig

SEEDS = st.integers(0, 2**32 - 1)
few = partial(settings, max_examples=25)
MIRROR = np.array((1.0, -1.0, 1.0))


def poses(seed: int) -> tuple[Float, Float, np.random.Generator]:
    """What was found and the truth, six frames each, some joints missing."""
    generator = np.random.default_rng(seed)
    truth = generator.normal(size=(6, coco.COUNT, 3))
    found = truth + generator.normal(scale=0.05, size=truth.shape)
    found[generator.random(found.shape[:2]) < 0.1] = np.nan
    return found, truth, generator


def motion(generator: np.random.Generator) -> tuple[Float, Float]:
    """A rotation and a shift of the world."""
    return Rotation.random(rng=generator).as_matrix(), generator.normal(scale=3.0, size=3)


def figures(found: Float, truth: Float) -> list[float]:
    """Every measure of position and movement."""
    error, distance = position_error(found, truth), distances_m(found, truth)
    parts = right_parts(found, truth, np.array(list(coco.LIMBS.values())), 0.05)
    return [
        error.mpjpe_mm,
        error.p95_mm,
        pampjpe_mm(found, truth),
        acceleration_error_mm(found, truth),
        jitter_mm(found),
        largest_jump_mm(found),
        pck_pct(distance, 0.1),
        pck_auc_pct(distance, 0.15),
        float(parts.mean()),
    ]


@few()
@given(SEEDS)
def test_moving_the_world_changes_nothing(seed: int) -> None:
    found, truth, generator = poses(seed)
    rotation, shift = motion(generator)
    moved = figures(found @ rotation.T + shift, truth @ rotation.T + shift)
    assert moved == pytest.approx(figures(found, truth), rel=1e-9)


@few()
@given(SEEDS)
def test_a_mirrored_world_with_left_and_right_exchanged_changes_nothing(seed: int) -> None:
    found, truth, _ = poses(seed)
    mirrored = figures(MIRROR * found[:, list(coco.MIRROR)], MIRROR * truth[:, list(coco.MIRROR)])
    assert mirrored == pytest.approx(figures(found, truth), rel=1e-9)


@few()
@given(SEEDS)
def test_the_order_of_joints_changes_nothing_but_which_parts_there_are(seed: int) -> None:
    found, truth, generator = poses(seed)
    order = generator.permutation(coco.COUNT)
    assert figures(found[:, order], truth[:, order])[:-1] == pytest.approx(figures(found, truth)[:-1], rel=1e-9)


@few()
@given(SEEDS, st.floats(0.1, 10.0))
def test_millimetres_scale_with_the_world_and_shares_with_their_tolerance_do_not(seed: int, scale: float) -> None:
    found, truth, _ = poses(seed)
    own, larger = figures(found, truth), figures(scale * found, scale * truth)
    assert larger[:6] == pytest.approx([scale * figure for figure in own[:6]], rel=1e-9)
    assert pck_auc_pct(scale * distances_m(found, truth), scale * 0.15) == pytest.approx(own[7])
    assert larger[8] == own[8]


@few()
@given(SEEDS, st.floats(0.2, 5.0))
def test_pampjpe_sees_no_similarity_and_is_zero_for_one(seed: int, scale: float) -> None:
    found, truth, generator = poses(seed)
    rotation, shift = motion(generator)
    assert pampjpe_mm(scale * found @ rotation.T + shift, truth) == pytest.approx(pampjpe_mm(found, truth), rel=1e-6)
    assert pampjpe_mm(scale * truth @ rotation.T + shift, truth) == pytest.approx(0.0, abs=1e-8)


@few()
@given(SEEDS)
def test_an_error_that_grows_evenly_with_time_has_no_acceleration(seed: int) -> None:
    found, truth, generator = poses(seed)
    drift = np.arange(6)[:, None, None] * generator.normal(size=(1, coco.COUNT, 3)) + generator.normal(size=3)
    assert acceleration_error_mm(found + drift, truth) == pytest.approx(acceleration_error_mm(found, truth), rel=1e-6)
    assert jitter_mm(truth + drift) == pytest.approx(jitter_mm(truth), rel=1e-6)


@few()
@given(SEEDS)
def test_time_backwards_is_as_steady_and_as_fast(seed: int) -> None:
    found, truth, _ = poses(seed)
    assert acceleration_error_mm(found[::-1], truth[::-1]) == pytest.approx(acceleration_error_mm(found, truth))
    assert largest_jump_mm(found[::-1]) == pytest.approx(largest_jump_mm(found))
    assert peak_speed_m_s(truth[::-1, 0], 30.0) == pytest.approx(peak_speed_m_s(truth[:, 0], 30.0))


@few()
@given(SEEDS)
def test_saying_less_never_makes_more_right(seed: int) -> None:
    found, truth, generator = poses(seed)
    shy = found.copy()
    shy[generator.random(found.shape[:2]) < 0.3] = np.nan
    for share in (partial(pck_pct, within=0.1), partial(pck_auc_pct, limit=0.15)):
        assert share(distances_m(shy, truth)) <= share(distances_m(found, truth))
    assert position_error(shy, truth).missing_pct >= position_error(found, truth).missing_pct
    assert set(position_error(shy, truth).without_pose) >= set(position_error(found, truth).without_pose)


TIMES = st.lists(st.integers(0, 2000), max_size=8).map(lambda ticks: [tick / 64 for tick in ticks])


@few()
@given(TIMES, TIMES, st.integers(0, 64), st.integers(-500, 500))
def test_keyframes_count_the_same_both_ways_and_at_any_hour(found: list[float], true: list[float], width: int, hour: int) -> None:
    tolerance = width / 64
    forth, back = moments(found, true, tolerance), moments(true, found, tolerance)
    assert (forth.right, forth.found, forth.there) == (back.right, back.there, back.found)
    assert moments([t + hour for t in found], [t + hour for t in true], tolerance) == forth
    assert forth.right <= moments(found, true, tolerance + 1 / 64).right
    assert moments(found, found, tolerance) == Retrieval(len(found), len(found), len(found))


@few()
@given(TIMES)
def test_every_attempt_matches_itself(times: list[float]) -> None:
    spans = [(time, time + 0.5) for time in times]
    assert intervals(spans, spans).right == len(spans)


@few()
@given(SEEDS, st.floats(0.1, 10.0))
def test_the_bound_grows_with_the_noise_and_falls_with_every_camera(seed: int, factor: float) -> None:
    generator = np.random.default_rng(seed)
    rig, point = ring_rig(4), generator.uniform((-1, -1, 0), (1, 1, 2))
    sigma, seen = generator.uniform(0.5, 5, 4), np.array((True, True, True, False))
    three = float(triangulation_bound_m(rig, point, sigma, seen))
    assert float(triangulation_bound_m(rig, point, factor * sigma, seen)) == pytest.approx(factor * three, rel=1e-6)
    assert float(triangulation_bound_m(rig, point, sigma, np.ones(4, np.bool_))) < three
