"""The standards of the repository: all ten, small, in the canonical frame, and as the exporter makes them."""

from importlib.resources import files

import numpy as np
import pytest

import models.teaching
from models.motions.actions.library import ACTIONS
from models.motions.performance import Performance
from models.teaching.build import export
from models.teaching.standard import UNIT_M, Standard, decode, encode
from services.evaluation.normalise import facing, root_m, size_m
from tests.bench.teaching.finding import shipped

FOLDER = files(models.teaching) / "standards"


def test_every_action_has_one_and_together_they_are_small() -> None:
    contents = {file.name: file.read_bytes() for file in FOLDER.iterdir()}
    assert contents.keys() == {f"{action}.npz" for action in ACTIONS}
    assert sum(map(len, contents.values())) < 700_000
    for name, data in contents.items():
        standard = decode(data, name)
        assert name == f"{standard.action}.npz"
        assert encode(standard) == data


@pytest.mark.parametrize("standard", shipped(), ids=lambda standard: standard.action)
def test_a_standard_is_whole_and_in_the_canonical_frame(standard: Standard) -> None:
    for one in (standard.performance, *standard.exemplars):
        assert np.isfinite(one.joints_m).all()
        np.testing.assert_allclose(root_m(one.joints_m)[0, :2], 0.0, atol=UNIT_M)
        np.testing.assert_allclose(facing(one.joints_m)[0], (1.0, 0.0), atol=0.1)
    assert size_m(standard.joints_m) == pytest.approx(0.72 * standard.stature_m, rel=0.08)
    assert np.nanmin(standard.spread_m) > 0.005
    assert np.nanmedian(standard.spread_m) < 0.1


def test_the_standard_throws_and_kicks_with_the_right() -> None:
    by_action = {standard.action: standard for standard in shipped()}
    for action, joints in (("badminton_clear", (10, 9)), ("volleyball_spike", (10, 9)), ("soccer_kick", (16, 15))):
        standard = by_action[action]
        peak = round(standard.moments_s[2] * 30)
        right, left = (standard.joints_m[peak, joint, 2] for joint in joints)
        assert right > left


@pytest.mark.slow
def test_the_exporter_performs_what_is_in_the_file() -> None:
    fresh = export.performed(Performance("squat"), 12.0)
    shipped_one = next(standard for standard in shipped() if standard.action == "squat")
    np.testing.assert_allclose(shipped_one.joints_m, fresh.exemplar.joints_m, atol=0.002)
    assert shipped_one.moments_s == pytest.approx(fresh.exemplar.moments_s, abs=1e-6)
    assert shipped_one.stature_m == pytest.approx(fresh.stature_m, abs=1e-3)
