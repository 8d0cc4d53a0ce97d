from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from edge.simulation.people.casting import body_model, cast
from edge.simulation.people.off_model import CENTRE_MOVED_M, LIMB_RATIO, Alteration, altered, draw_alteration
from edge.simulation.people.shell import edges
from edge.simulation.split import SPLITS, Split
from models.arrays import Float
from models.body import LARGE
from models.body.file import coco_regressor
from models.body.model import Body
from models.body.pose import Pose, from_vector
from models.motions.standing import stand
from models.skeleton import smpl
from tests.bodies import body_bytes, prior_of

LIMBS = {
    "upper arm": ("shoulder", "elbow", 1),
    "forearm": ("elbow", "wrist", 1),
    "thigh": ("hip", "knee", 2),
    "shank": ("knee", "ankle", 2),
}
SEEDS = (0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 6)))


@cache
def regressor() -> Float:
    return coco_regressor(body_bytes(LARGE), LARGE)


@cache
def original() -> Body:
    return body_model().shaped(prior_of(body_model()).likely(11, "female").mean)


def some_pose(seed: int) -> Pose:
    vector = np.random.default_rng(seed).normal(0, 0.4, 75)
    return from_vector(vector)


def length(joints: Float, side: str, start: str, end: str) -> float:
    return float(np.linalg.norm(joints[smpl.INDEX[f"{side}_{end}"]] - joints[smpl.INDEX[f"{side}_{start}"]]))


@pytest.mark.parametrize("seed", SEEDS)
def test_limbs_are_as_much_longer_or_shorter_as_asked_and_alike_on_both_sides(seed: int) -> None:
    alteration = draw_alteration("test", seed)
    body = altered(original(), Alteration(alteration.stretch, np.zeros((smpl.COUNT, 3))), regressor())
    for start, end, axis in LIMBS.values():
        ratios = [
            length(body.rest_joints_m, s, start, end) / length(original().rest_joints_m, s, start, end) for s in ("left", "right")
        ]
        asked = [alteration.stretch[smpl.INDEX[f"{side}_{start}"], axis] for side in ("left", "right")]
        assert ratios == pytest.approx(asked, abs=2e-3)
        assert max(abs(ratio - 1) for ratio in ratios) <= LIMB_RATIO + 2e-3
        assert abs(ratios[0] - ratios[1]) < 0.015


def test_limbs_differ_from_one_another_and_from_person_to_person() -> None:
    ratios = np.array(
        [
            [draw_alteration("test", seed).stretch[smpl.INDEX[f"left_{start}"], axis] for start, _, axis in LIMBS.values()]
            for seed in range(30)
        ]
    )
    assert np.ptp(ratios, axis=1).mean() > 0.04
    assert ratios.std(0) == pytest.approx(np.full(4, 0.0315), rel=0.35)
    assert ratios.mean(0) == pytest.approx(np.ones(4), abs=0.02)


@pytest.mark.parametrize("seed", SEEDS)
def test_joints_centres_move_inside_the_flesh_while_the_skin_stays(seed: int) -> None:
    centres = draw_alteration("test", seed).centres_m
    body = altered(original(), Alteration(np.ones((smpl.COUNT, 3)), centres), regressor())
    assert body.rest_vertices_m == pytest.approx(original().rest_vertices_m, abs=1e-12)
    moved = np.linalg.norm(body.rest_joints_m - original().rest_joints_m, axis=1)
    assert moved[0] == 0
    assert (moved[1:] >= CENTRE_MOVED_M[0] - 1e-9).all()
    assert (moved[1:] <= CENTRE_MOVED_M[1] + 1e-9).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_altered_skin_has_no_tears_and_no_folds(seed: int) -> None:
    body = altered(original(), draw_alteration("test", seed), regressor())
    pairs = edges(body.model.faces.astype(np.int32))
    lengths = [np.linalg.norm(b.rest_vertices_m[pairs[:, 0]] - b.rest_vertices_m[pairs[:, 1]], axis=1) for b in (body, original())]
    ratio = lengths[0] / lengths[1]
    assert ratio.min() > 0.5  # short edges in the crotch give most
    assert ratio.max() < 1.7
    facing = []
    for person in (body, original()):
        a, b, c = (person.rest_vertices_m[person.model.faces[:, corner]] for corner in range(3))
        facing.append(np.cross(b - a, c - a))
    assert ((facing[0] * facing[1]).sum(1) > 0).all()
    assert body.volume_m3 == pytest.approx(original().volume_m3, rel=0.25)


@pytest.mark.parametrize("seed", SEEDS)
def test_truth_of_an_altered_body_is_that_of_its_own_skin(seed: int) -> None:
    body = cast("test", seed).subject.body
    pose = some_pose(seed)
    assert body.coco_m(pose) == pytest.approx(regressor() @ body.vertices_m(pose), abs=1e-9)
    points, jacobian = body.landmarks_jacobian(pose, body.coco_landmarks)
    assert points == pytest.approx(body.coco_m(pose), abs=1e-12)
    assert jacobian.shape == (23, 3, 75)


def test_no_shape_of_the_model_has_the_joints_of_a_test_body_but_every_development_body_is_one() -> None:
    model = body_model()
    directions = model.joint_shapedirs.reshape(-1, model.shape_count)
    bounds: dict[Split, tuple[float, float]] = {"development": (0.0, 1e-9), "test": (0.003, 0.05)}
    for split, (low, high) in bounds.items():
        for seed in range(4):
            wanted = (cast(split, seed).subject.body.rest_joints_m - model.joints).ravel()
            shape = np.linalg.lstsq(directions, wanted, rcond=None)[0]
            error = float(np.linalg.norm((directions @ shape - wanted).reshape(-1, 3), axis=1).mean())
            assert low <= error <= high


@pytest.mark.parametrize("split", SPLITS)
def test_everybody_can_stand_on_the_floor(split: Split) -> None:
    for seed in range(2):
        subject = cast(split, seed).subject
        lowest = subject.body.vertices_m(stand(subject))[:, 2].min()
        assert abs(lowest) < 0.012


def test_a_body_with_pose_correctives_is_refused() -> None:
    model = body_model()
    skin = replace(model.skin, posedirs=np.ones((len(model.skin.vertices), 3, 207)))
    with pytest.raises(ValueError, match="pose correctives"):
        altered(replace(model, skin=skin).shaped(np.zeros(16)), draw_alteration("test", 0), regressor())
