from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial import KDTree

from edge.simulation.people.anatomy import Anatomy
from edge.simulation.people.avatar import Avatar
from edge.simulation.people.casting import Member, cast
from edge.simulation.people.clothing import sew_footwear, sew_legwear, sew_shirt
from edge.simulation.people.hair import STYLES, Style, grow
from edge.simulation.people.look import Dressed, dress
from edge.simulation.people.shell import Shell, borders, clipped, edges, joined, subdivided
from edge.simulation.split import SPLITS, Split
from models.arrays import Float
from models.body.model import Body
from models.motions.motion import CONTACTS, Motion
from models.motions.standing import stand
from models.motions.subject import Subject
from tests.bodies import body_model

SEEDS = (0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 5)))


@cache
def member(split: Split, seed: int) -> Member:
    return cast(split, seed)


@cache
def dressed(split: Split, seed: int) -> Dressed:
    one = member(split, seed)
    return dress(one.subject.body, one.look, detail=0)


@cache
def still(subject: Subject) -> Motion:
    pose = stand(subject)
    count = 3
    rotations = np.tile(pose.rotations_rad, (count, 1, 1))
    return Motion(np.tile(pose.translation_m, (count, 1)), rotations, np.zeros((count, len(CONTACTS)), np.bool_))


def depth_in_skin_m(points_m: Float, body: Body) -> Float:
    """(V,) how deep points lie under the skin, by its nearest vertex; negative outside."""
    skin = Anatomy(body).skin
    _, nearest = KDTree(skin.vertices_m).query(points_m)
    return np.asarray(-((points_m - skin.vertices_m[nearest]) * skin.normals[nearest]).sum(1))


def ball() -> Shell:
    """The closed mesh of a body, as a thing to cut."""
    skin = Anatomy(body_model().shaped(np.zeros(16))).skin
    return replace(skin, weights=skin.weights[:, :24])


def area(shell: Shell) -> float:
    a, b, c = (shell.vertices_m[shell.faces[:, corner]] for corner in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_a_cut_keeps_the_area_of_both_parts_and_opens_borders_only_along_the_cut() -> None:
    whole = ball()
    field = whole.vertices_m[:, 2] - 0.1001
    above, below = clipped(whole, field), clipped(whole, -field)
    assert area(above) + area(below) == pytest.approx(area(whole), rel=1e-9)
    assert above.vertices_m[borders(above.faces)][..., 2] == pytest.approx(0.1001, abs=1e-9)
    assert above.vertices_m[:, 2].min() == pytest.approx(0.1001, abs=1e-9)
    assert (above.normals * clipped(whole, field).normals).sum(1).min() > 0.99
    assert above.weights.sum(1) == pytest.approx(np.ones(len(above.vertices_m)), abs=1e-6)


def test_subdivision_leaves_no_gap_and_hardly_moves_the_surface() -> None:
    whole = ball()
    fine = subdivided(whole)
    assert len(fine.faces) == 4 * len(whole.faces)
    assert not len(borders(fine.faces))
    assert len(edges(fine.faces)) == 2 * len(edges(whole.faces)) + 3 * len(whole.faces)
    assert area(fine) == pytest.approx(area(whole), rel=0.02)


@pytest.mark.parametrize("split", SPLITS)
@pytest.mark.parametrize("seed", SEEDS)
def test_clothes_lie_outside_the_skin(split: Split, seed: int) -> None:
    one, random = member(split, seed), np.random.default_rng(0)
    anatomy, look = Anatomy(one.subject.body), one.look
    shoes = sew_footwear(anatomy, look.footwear, 0)
    for garment in (sew_shirt(anatomy, replace(look.shirt, hood=False), 0, random), sew_legwear(anatomy, look.legwear, 0, random)):
        points = garment.shell.vertices_m
        # Between the legs the nearest skin is that of the other side.
        apart = np.hypot(points[:, 1], points[:, 2] - anatomy.crotch_z) > 0.08 * anatomy.scale
        depth = depth_in_skin_m(points[apart], one.subject.body)
        assert np.quantile(depth, 0.9) < 0
        assert np.quantile(depth, 0.99) < 0.002  # a hem ends on the skin
    assert np.quantile(depth_in_skin_m(shoes.shell.vertices_m, one.subject.body), 0.95) < 0.002


@pytest.mark.slow
@pytest.mark.parametrize("style", STYLES)
def test_hair_lies_outside_the_head_and_leaves_the_face_free(style: Style) -> None:
    anatomy = Anatomy(member("development", 1).subject.body)
    shell = grow(anatomy, style, (0.2, 0.1, 0.1), 1).shell
    depth = depth_in_skin_m(shell.vertices_m, anatomy.body)
    assert np.quantile(depth, 0.5) < 0
    for name in ("nose", "left_eye", "right_eye"):
        point = anatomy.point(name)
        ahead = shell.vertices_m[:, 0] > point[0] - 0.01
        assert np.linalg.norm((shell.vertices_m - point)[ahead][:, 1:], axis=1).min(initial=1.0) > 0.02


@pytest.mark.slow
@pytest.mark.parametrize("split", SPLITS)
@pytest.mark.parametrize("seed", SEEDS)
def test_shoes_and_nothing_else_stand_on_the_floor(split: Split, seed: int) -> None:
    one = member(split, seed)
    avatar = Avatar("a", one.subject, one.look, still(one.subject), detail=0)
    vertices = avatar.vertices_m(0.001)
    lowest = vertices[:, 2].min()
    assert abs(lowest) < 0.015
    on_floor = vertices[vertices[:, 2] < lowest + 0.004]
    feet = avatar.coco_m(0.001)[17:, :2]
    assert (KDTree(feet).query(on_floor[:, :2])[0] < 0.14).all()
    for side in (1, -1):
        assert (np.sign(on_floor[:, 1]) == side).sum() > 20


def test_an_avatars_truth_is_its_bodys_at_every_time() -> None:
    one = member("test", 0)
    motion = still(one.subject)
    avatar = Avatar("a", one.subject, one.look, motion)
    for t_s in (-1.0, 0.003, 99.0):
        assert avatar.joints_m(t_s) == pytest.approx(one.subject.body.joints_m(motion.pose(0)), abs=1e-9)
        assert avatar.coco_m(t_s) == pytest.approx(one.subject.body.coco_m(motion.pose(0)), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("split", SPLITS)
def test_surfaces_are_whole_and_a_seed_gives_the_same_twice(split: Split) -> None:
    one, surface = member(split, 0), dressed(split, 0).surface
    again = dress(cast(split, 0).subject.body, cast(split, 0).look, detail=0).surface
    assert surface.vertices_m.tobytes() == again.vertices_m.tobytes()
    assert surface.texture is not None
    assert again.texture is not None
    assert surface.texture.picture.tobytes() == again.texture.picture.tobytes()
    assert one.look == cast(split, 0).look
    assert np.isfinite(surface.vertices_m).all()
    assert surface.faces.max() < len(surface.vertices_m)
    assert ((surface.colours >= 0) & (surface.colours <= 1)).all()
    assert ((surface.texture.uv >= 0) & (surface.texture.uv <= 1)).all()
    assert dressed(split, 0).weights.sum(1) == pytest.approx(np.ones(len(surface.vertices_m)))


def test_splits_dress_nobody_alike_and_share_no_body() -> None:
    shirts: dict[Split, set[tuple[float, float, float]]] = {split: set() for split in SPLITS}
    for split in SPLITS:
        for seed in range(12):
            colour = cast(split, seed).look.shirt.colour
            if len(set(colour)) > 1:
                shirts[split].add(colour)
    assert len(shirts["test"]) > 5
    assert not shirts["development"] & shirts["test"]
    assert not np.allclose(
        member("development", 0).subject.body.rest_joints_m, member("test", 0).subject.body.rest_joints_m, atol=0.02
    )


@pytest.mark.slow
def test_two_pupils_may_wear_the_same_bib() -> None:
    ones = [member("development", seed).in_bib((0.9, 0.8, 0.1), 4) for seed in range(2)]
    for one in ones:
        bib = dress(one.subject.body, one.look, detail=0).surface
        yellow = np.abs(bib.colours - (0.9, 0.8, 0.1)).max(1) < 0.01
        assert yellow.sum() > 200


def test_joining_keeps_each_piece() -> None:
    whole = ball()
    both = joined((whole, whole))
    assert len(both.vertices_m) == 2 * len(whole.vertices_m)
    assert area(both) == pytest.approx(2 * area(whole))
