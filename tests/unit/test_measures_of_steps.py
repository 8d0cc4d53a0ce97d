"""Where a runner's feet land, of what noise makes of somebody who runs and of somebody who stands."""

from dataclasses import replace

import numpy as np
import pytest

from models.arrays import Float
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from tests.bench.teaching.noise import as_fused
from tests.taught import performance

REACHES = ("landing_reach", "standing_reach")


def measured(name: str, track: Track, attempt: FoundAttempt) -> Measured:
    return evaluate(Measure(function=name), Reading(track, "right", told=Stature(1.5, 0.02)), attempt)


def noisy(joints_m: Float, frame_s: float, random: np.random.Generator, times: float) -> Track:
    """With so many times the errors that fusion has."""
    seen = as_fused(joints_m, frame_s, random)
    return replace(seen, joints_m=joints_m + times * (seen.joints_m - joints_m), covariance_m2=times**2 * seen.covariance_m2)


def few_steps() -> FoundAttempt:
    """A run of which two or three steps are at full speed."""
    _, attempt = performance("run")
    start, exertion, peak, end = attempt.moments_s
    return replace(attempt, moments_s=(start, exertion + 0.9, max(peak - 0.5, exertion + 0.92), end))


def test_noise_alone_makes_no_steps_of_somebody_who_stands() -> None:
    track, _ = performance("run")
    still = np.repeat(track.joints_m[:1], 120, axis=0)
    attempt = FoundAttempt("run", "right", (0.5, 1.2, 2.2, 3.0))
    random = np.random.default_rng(5)
    for _ in range(30):
        seen = noisy(still, track.frame_s, random, 2.0)
        assert not any(measured(name, seen, attempt).known for name in REACHES)


@pytest.mark.parametrize("name", REACHES)
def test_steps_that_agree_by_chance_are_no_surer_than_the_joints(name: str) -> None:
    """How well ankles and hips were known was of no account: two steps that happened to agree were as sure as could be."""
    track, attempt = performance("run")[0], few_steps()
    well, badly = (measured(name, known_track(track.joints_m, track.frame_s, sigma_m), attempt) for sigma_m in (0.005, 0.05))
    assert badly.known
    assert badly.value == pytest.approx(well.value)
    assert badly.sigma > 2 * well.sigma
    random = np.random.default_rng(7)
    seen = [noisy(track.joints_m, track.frame_s, random, 2.0) for _ in range(60)]
    found = [one for one in (measured(name, one, attempt) for one in seen) if one.known]
    off = np.sqrt(np.mean([(one.value - well.value) ** 2 for one in found]))
    assert min(one.sigma for one in found) > off / 2
