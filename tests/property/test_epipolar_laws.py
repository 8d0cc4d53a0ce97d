"""Laws of the distance from epipolar lines: against plain arithmetic, joint by joint, and against the truth."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Bool, Float
from services.fusion.epipolar import Couples, fundamentals
from services.fusion.views import Sighting, Views
from tests.synthetic.gym import ring_rig

VIEWS = Views.of(ring_rig(4))
MATRICES = fundamentals(VIEWS)


def seen(camera: int, joints_m: Float, usable: Bool) -> Sighting:
    return Sighting(camera, 1, 0.0, VIEWS.rig.cameras[camera].project(joints_m), np.ones(17), usable)


def plain_distance(matrix: Float, first_px: Float, second_px: Float) -> float:
    larger = []
    for x, y in zip(first_px, second_px, strict=True):
        x1, y1 = np.append(x, 1.0), np.append(y, 1.0)
        error = abs(y1 @ matrix @ x1)
        in_second = error / np.linalg.norm((matrix @ x1)[:2]) / np.linalg.norm(np.ptp(second_px, axis=0))
        in_first = error / np.linalg.norm((y1 @ matrix)[:2]) / np.linalg.norm(np.ptp(first_px, axis=0))
        larger.append(max(in_second, in_first))
    return float(np.median(larger))


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), pair=st.sampled_from(sorted(MATRICES)))
def test_the_distance_is_that_of_plain_arithmetic_and_vanishes_for_one_body(seed: int, pair: tuple[int, int]) -> None:
    rng = np.random.default_rng(seed)
    bodies = rng.normal((0.0, 0.0, 1.0), 0.4, (3, 17, 3))
    usable = rng.random((2, 17)) < 0.9
    first = [seen(pair[0], body, usable[0]) for body in bodies[:2]]
    second = [seen(pair[1], body, usable[1]) for body in bodies[1:]]
    couples = Couples.of(first, second)
    assert couples is not None
    both = usable[0] & usable[1]
    expected = [plain_distance(MATRICES[pair], a.points_px[both], b.points_px[both]) for a in first for b in second]
    assert couples.distances(MATRICES[pair]) == pytest.approx(expected, rel=1e-6, abs=1e-9)
    assert np.argmin(expected) == 2  # bodies[1] in both pictures
    assert couples.one(2).distances(MATRICES[pair])[0] < 1e-9


def test_only_what_is_newest_is_kept() -> None:
    rng = np.random.default_rng(5)
    everyone = [seen(0, body, np.ones(17, np.bool_)) for body in rng.normal((0.0, 0.0, 1.0), 0.4, (6, 17, 3))]
    couples = [Couples.of([person], [person]) for person in everyone]
    kept = couples[0]
    for couple in couples[1:]:
        assert kept is not None
        assert couple is not None
        kept = kept.and_then(couple, 4)
    assert kept is not None
    assert np.array_equal(kept.points_px[:, 0], [person.points_px for person in everyone[2:]])
