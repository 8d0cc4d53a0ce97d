"""The sigmas of values: against the scatter of many draws of the errors that they are told of."""

import numpy as np
import pytest

from models.arrays import Float
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.catalogue import CATALOGUE
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.stretch import sample, stretch, top
from services.evaluation.stature import Stature
from services.evaluation.track import Track, known_track
from services.evaluation.uncertainty import EXACT, NETWORK, Uncertainty, roots
from tests.stick_figure import DOWN, LEFT, figure, turned

pytestmark = pytest.mark.slow

SIGMA_M = 0.006
COUNT = 30
STATURE = Stature(1.5, 0.0)


def kneeling() -> Float:
    bends = 60 + 50 * np.sin(np.linspace(0, np.pi, COUNT))
    return np.stack([figure({"right_shank": turned(bend, LEFT, DOWN)}) for bend in bends])


def reading(joints_m: Float, model: Uncertainty = NETWORK) -> Reading:
    return Reading(known_track(joints_m, 1 / 30, SIGMA_M), "right", model, STATURE)


@pytest.mark.parametrize("name", ["knee_flexion", "trunk_forward", "com_height", "wrist_forward", "trunk_side", "hip_drop"])
def test_a_sigma_is_the_scatter_of_what_is_measured(name: str) -> None:
    random = np.random.default_rng(1)
    joints_m, scales = kneeling(), np.array(NETWORK.noise_scale)
    frame = COUNT // 2
    values = []
    for _ in range(600):
        noise = SIGMA_M * scales[:, None] * (NETWORK.mixed @ random.standard_normal((coco.COUNT, 3)))
        landmarks = np.array(NETWORK.landmark_m)[:, None] * (NETWORK.mixed @ random.standard_normal((coco.COUNT, 3)))
        values.append(reading(joints_m[[frame]] + noise + landmarks).of(CATALOGUE[name], "lead").value[0])
    stated = reading(joints_m[[frame]]).of(CATALOGUE[name], "lead").sigma[0]
    assert stated == pytest.approx(np.std(values), rel=0.12)


def test_what_two_instants_share_is_not_charged_to_their_difference() -> None:
    series = reading(kneeling()).of(CATALOGUE["knee_flexion"], "lead")
    near, far = np.zeros(COUNT), np.zeros(COUNT)
    near[[10, 11]], far[[2, 28]] = (-1, 1), (-1, 1)
    assert np.sqrt(series.variance(near)) < series.sigma[10] / 2 < np.sqrt(series.variance(far))


def test_a_mean_is_surer_than_a_value_and_never_surer_than_the_landmarks() -> None:
    series = reading(kneeling()).of(CATALOGUE["knee_flexion"], "lead")
    mean = np.sqrt(series.variance(np.full(COUNT, 1 / COUNT)))
    assert 0.3 * series.sigma.mean() < mean < series.sigma.mean()


def test_truth_has_no_sigma_but_its_own() -> None:
    exact = Reading(known_track(kneeling(), 1 / 30), "right", EXACT, STATURE)
    assert exact.of(CATALOGUE["knee_flexion"], "lead").sigma == pytest.approx(0)


def test_a_top_is_found_between_frames() -> None:
    t_s = np.arange(COUNT) / 30
    joints = np.stack([figure() + np.array((0, 0, 0.3 - 4.0 * (t - 0.487) ** 2)) for t in t_s])
    series = reading(joints, EXACT).of(CATALOGUE["hip_height"], "lead")
    highest = top(series, stretch(series, 0.1, 0.9))
    assert highest is not None
    assert highest.place / 30 == pytest.approx(0.487, abs=1e-6)
    assert highest.value == pytest.approx(100 * 1.15 / 1.5)
    assert sample(series, 0.487).value == pytest.approx(100 * 1.15 / 1.5, abs=1e-6)


def test_a_keyframe_that_is_not_sure_makes_a_fast_value_less_sure() -> None:
    attempt = FoundAttempt("squat", "right", (0.1, 0.25, 0.5, 0.8))
    sigmas = [
        evaluate(Measure(signal="knee_flexion", side="lead", at=phase), reading(kneeling()), attempt).sigma
        for phase in ("start", "peak")
    ]
    assert sigmas[0] > sigmas[1] + 0.3


def test_guessed_joints_are_measured_but_nobody_is_judged_by_them() -> None:
    track = known_track(kneeling(), 1 / 30, SIGMA_M)
    states = track.states.copy()
    states[:, coco.INDEX["right_ankle"]] = 1
    guessed = Reading(Track(track.t_s, track.joints_m, track.covariance_m2, states), "right")
    attempt = FoundAttempt("squat", "right", (0.1, 0.25, 0.5, 0.8))
    knee = evaluate(Measure(signal="knee_flexion", side="lead", at="peak"), guessed, attempt)
    assert np.isfinite(knee.value)
    assert not knee.known
    assert evaluate(Measure(signal="elbow_flexion", side="lead", at="peak"), guessed, attempt).known


def test_roots_of_covariances_that_are_flat_or_unknown() -> None:
    random = np.random.default_rng(0)
    half = random.standard_normal((5, 3, 3))
    half[3, :, 1:] = 0
    covariance = half @ half.swapaxes(1, 2)
    covariance[4] = np.nan
    root = roots(covariance)
    np.testing.assert_allclose(root @ root.swapaxes(1, 2), covariance, atol=1e-9)
