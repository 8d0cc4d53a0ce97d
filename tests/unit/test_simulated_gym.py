from functools import cache
from typing import get_args

import numpy as np
import pytest

from edge.simulation.gym.court import PX_PER_M, Court, paint_floor
from edge.simulation.gym.furniture import BOX_HEIGHT_M, bench, mat, net, vaulting_box
from edge.simulation.gym.hall import FREE_RADIUS_M, Gym, make_gym
from edge.simulation.gym.solids import Heap, placed, sphere
from edge.simulation.gym.things import PlayedThing, surface_of
from edge.simulation.people.casting import cast
from edge.simulation.people.shell import borders
from edge.simulation.picture.scene import Scene
from edge.simulation.rigs.arrangements import NAMES, make_rig
from edge.simulation.split import SPLITS, Split
from edge.simulation.surface import Surface
from models.arrays import Float
from models.motions import things as sizes
from models.motions.motion import RATE_HZ, Thing, ThingKind

KINDS: tuple[ThingKind, ...] = get_args(ThingKind)
WHITE, BLACK, RED, GREY = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.5, 0.5)


@cache
def gym(split: Split = "development", seed: int = 0) -> Gym:
    return make_gym(split, seed)


def closed_volume(surface: Surface) -> float:
    a, b, c = (surface.vertices_m[surface.faces[:, corner]] for corner in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


def welded_faces(surface: Surface) -> np.ndarray:
    _, place = np.unique(np.round(surface.vertices_m, 7), axis=0, return_inverse=True)
    return np.asarray(place.ravel()[surface.faces], np.int32)


def floor_with(
    basketball: tuple[float, float, float], volleyball: tuple[float, float, float], badminton: tuple[float, float, float]
) -> Float:
    court = Court(30.0, 17.0, GREY, basketball, volleyball, badminton)
    return paint_floor(court, np.random.default_rng(0)) / 255.0


def painted_at(floor: Float, x_m: float, y_m: float) -> bool:
    """Whether a line is there, drawn in white on grey."""
    row, column = round(floor.shape[0] / 2 - y_m * PX_PER_M - 0.5), round(floor.shape[1] / 2 + x_m * PX_PER_M - 0.5)
    return bool(floor[row, column].min() > 0.75)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sport", "on", "off"),
    [
        (
            "basketball",
            [
                (14.025, 3),
                (0, 5),
                (14 - 5.80 + 0.025, 1.0),
                (12, 2.425),
                (1.775, 0),
                (14 - 1.575 - 6.725, 0),
                (13, 6.575),
                (14 - 1.575 - 1.275, 0),
            ],
            [(13.9, 3), (14 - 5.80 - 0.03, 1.0), (12, 2.35), (1.70, 0), (14 - 1.575 - 6.80, 0), (13, 6.70), (7, 4.2)],
        ),
        ("volleyball", [(8.975, 0), (2.975, 1), (-2.975, -4), (4, 4.475)], [(9.05, 0), (3.05, 1), (5, 4.3), (6, 0)]),
        (
            "badminton",
            [(6.68, 1), (2.0, 1), (5.92, 2), (4, 0), (4, 2.57), (4, 3.03)],
            [(6.75, 1), (1.95, 1), (1.0, 0.0), (5.8, 2), (4, 2.62)],
        ),
    ],
)
def test_lines_lie_where_the_rules_of_each_sport_put_them(
    sport: str, on: list[tuple[float, float]], off: list[tuple[float, float]]
) -> None:
    floor = floor_with(*(WHITE if sport == name else GREY for name in ("basketball", "volleyball", "badminton")))
    for x, y in on:
        assert painted_at(floor, x, y), (x, y)
        assert painted_at(floor, -x, y), (-x, y)
    for x, y in off:
        assert not painted_at(floor, x, y), (x, y)


@pytest.mark.slow
def test_a_gym_holds_every_camera_and_leaves_the_acting_area_free() -> None:
    hall = gym()
    for surface in hall.room:
        x, y, z = surface.vertices_m.T
        assert np.abs(x).max() <= hall.length_m / 2 + 0.05
        assert np.abs(y).max() <= hall.width_m / 2 + 0.05
        assert z.min() >= 0
        assert z.max() <= hall.height_m + 1e-9
        if surface.name != "floor":
            standing = surface.vertices_m[z < 2.0]
            assert (np.hypot(standing[:, 0], standing[:, 1]) > FREE_RADIUS_M).all(), surface.name
    for name in NAMES:
        for camera in make_rig(name):
            assert (np.abs(camera.centre_m[:2]) < (hall.length_m / 2 - 0.3, hall.width_m / 2 - 0.3)).all()
    assert sum(len(surface.faces) for surface in hall.room) < 60_000


@pytest.mark.slow
def test_walls_floor_and_ceiling_face_the_hall() -> None:
    middle = np.array((0.0, 0.0, 2.0))
    for surface in gym().room:
        if surface.name in {"floor", "wall", "ceiling", "window"}:
            a, b, c = surface.vertices_m[surface.faces[0]]
            assert np.dot(np.cross(b - a, c - a), middle - a) > 0, surface.name


@pytest.mark.slow
def test_gyms_are_the_same_by_seed_and_differ_between_seeds_and_splits() -> None:
    again = make_gym("development", 0)
    for one, other in zip(gym().room, again.room, strict=True):
        assert one.vertices_m.tobytes() == other.vertices_m.tobytes()
        assert one.colours.tobytes() == other.colours.tobytes()
        if one.texture is not None and other.texture is not None:
            assert one.texture.picture.tobytes() == other.texture.picture.tobytes()
    sizes_m = {(split, seed): gym(split, seed).length_m for split in SPLITS for seed in range(2)}
    assert len(set(sizes_m.values())) == len(sizes_m)


@pytest.mark.slow
def test_a_scene_takes_it() -> None:
    scene = Scene(gym().room, (), (PlayedThing(still("basketball", 3)),), gym().lamps, gym().ambient)
    for lamp in scene.lamps:
        assert np.linalg.norm(lamp.direction) == pytest.approx(1)
    total = np.sum([lamp.colour for lamp in scene.lamps], axis=0) + scene.ambient
    assert (total > 0.8).all()
    assert (total < 1.35).all()


def still(kind: ThingKind, count: int) -> Thing:
    return Thing(kind, np.zeros((count, 3)), np.zeros((count, 3)))


@pytest.mark.parametrize("kind", KINDS)
def test_things_have_the_sizes_and_frames_that_motions_go_by(kind: ThingKind) -> None:
    vertices = surface_of(kind).vertices_m
    low, high = vertices.min(0), vertices.max(0)
    if kind == "racket":
        assert (low[2], high[2]) == pytest.approx((-sizes.RACKET_GRIP_M, sizes.RACKET_LENGTH_M - sizes.RACKET_GRIP_M), abs=0.01)
        head = vertices[vertices[:, 2] > 0.35]
        assert np.ptp(head[:, 0]) < 0.03
        assert 0.2 < np.ptp(head[:, 1]) <= 0.245
        assert (head[:, 2].min() + head[:, 2].max()) / 2 == pytest.approx(sizes.RACKET_SWEET_SPOT_M - 0.04, abs=0.05)
    elif kind == "shuttlecock":
        assert (low[2], high[2]) == pytest.approx((0, sizes.SHUTTLECOCK_LENGTH_M), abs=1e-3)
    else:
        radius = {
            "basketball": sizes.BASKETBALL_RADIUS_M,
            "volleyball": sizes.VOLLEYBALL_RADIUS_M,
            "football": sizes.FOOTBALL_RADIUS_M,
        }[kind]
        assert np.linalg.norm(vertices, axis=1) == pytest.approx(np.full(len(vertices), radius))


def test_a_thing_is_between_its_samples_and_absent_where_it_is_not_there() -> None:
    places = np.array(((0, 0, 1.0), (0.1, 0, 1.0), (np.nan, np.nan, np.nan), (0, 0, 2), (0, 0, 3)))
    turns = np.zeros((5, 3))
    turns[4, 2] = np.pi / 2
    ball = PlayedThing(Thing("football", places, turns))
    between = ball.vertices_m(0.5 / RATE_HZ)
    assert between is not None
    assert (between.max(0) + between.min(0)) / 2 == pytest.approx((0.05, 0, 1.0), abs=1e-6)
    for share in (-0.1, 1.5, 2.5, 4.1):
        assert ball.vertices_m(share / RATE_HZ) is None
    turned, own = ball.vertices_m(3.5 / RATE_HZ), ball.surface.vertices_m
    assert turned is not None
    c = np.sqrt(0.5)
    assert turned[5] - (0, 0, 2.5) == pytest.approx((c * (own[5, 0] - own[5, 1]), c * (own[5, 0] + own[5, 1]), own[5, 2]))


def test_solids_are_closed_and_face_outwards() -> None:
    heap = Heap()
    heap.box((0, 0, 0), (1, 2, 3), RED)
    assert closed_volume(heap.surface("box")) == pytest.approx(6)
    heap = Heap()
    heap.bar((0, 0, 0), (0, 1, 1), 0.1, RED, sides=64)
    assert closed_volume(heap.surface("bar")) == pytest.approx(np.pi * 0.01 * np.sqrt(2), rel=0.01)
    for surface in (heap.surface("bar"), vaulting_box(), bench()):
        assert not len(borders(welded_faces(surface)))
    vertices, faces, _ = sphere(1.0, 24)
    ball = Surface("ball", vertices, faces.astype(np.int32), np.ones_like(vertices))
    assert closed_volume(ball) == pytest.approx(4 / 3 * np.pi, rel=0.02)


def test_furniture_stands_on_the_floor_in_its_size() -> None:
    for surface, size in ((vaulting_box(), (1.5, 0.8, BOX_HEIGHT_M)), (bench(), (4.0, 0.32, 0.35)), (mat(), (2.0, 1.0, 0.042))):
        assert surface.vertices_m[:, 2].min() == pytest.approx(0, abs=0.005)
        assert np.ptp(surface.vertices_m, axis=0) == pytest.approx(size, abs=0.01)
    assert net("volleyball").vertices_m[:, 2].max() == pytest.approx(2.29, abs=0.01)
    assert net("badminton", 1.55).vertices_m[:, 2].max() == pytest.approx(1.60, abs=0.01)
    moved = placed(bench(), (1, 2, 0), np.pi / 2)
    assert np.ptp(moved.vertices_m, axis=0) == pytest.approx((0.32, 4.0, 0.35), abs=0.01)
    assert moved.vertices_m[:, :2].mean(0) == pytest.approx((1, 2), abs=1e-6)


def test_nobody_of_the_cast_is_taller_than_the_cameras_expect() -> None:
    assert cast("test", 0).subject.body.stature_m < 2.0
