"""Jump heights of real people, beside what a force plate says."""

from functools import cache

import numpy as np
import pytest

from tests.bench.teaching.force_plate import FOLDER, DropJump, drop_jump, names
from tests.installed import ROOT

SHARED = ROOT.parent / "shared/data"
pytestmark = [
    pytest.mark.shared_data,
    pytest.mark.slow,
    pytest.mark.timeout(600),
    pytest.mark.skipif(not names(SHARED), reason=f"the measurement data is not there: {FOLDER}"),
]


@cache
def jumps() -> tuple[DropJump, ...]:
    return tuple(drop_jump(SHARED, name) for name in names(SHARED))


def test_heights_are_the_force_plates() -> None:
    assert len(jumps()) == 5
    assert all(jump.ours.known for jump in jumps())
    assert np.mean([abs(jump.error_cm) for jump in jumps()]) <= 1.2


def test_errors_are_within_what_is_stated() -> None:
    assert all(abs(jump.error_cm) <= 2 * jump.ours.sigma for jump in jumps())
