"""The twin's pieces: situations, errors, the library's file, neighbours, time."""

from dataclasses import fields, replace

import numpy as np
import pytest

from edge.simulation.picture.shutter import Shutter
from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.errors import UserError
from models.skeleton import coco
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person
from tests.twin import library as libraries
from tests.twin import walk
from tests.twin.context import MIRROR, Context, look
from tests.twin.errors import Errors, displacement, errors_of, said_of
from tests.twin.lesson import Lesson, PlainPerformer, Sampled, truth_of, turns
from tests.twin.library import Library, build, decode, encode
from tests.twin.occlusion import hidden
from tests.twin.stand_in import StandIn, lesson_of, streams_of
from tests.twin.truth import Said, Stream, Truth

PERSON = Person(height_m=1.5)


def _truth(camera: Camera, mirrored: bool = False, count: int = 40) -> Truth:
    """Somebody who walks past a camera; or his mirror image in the plane y = 0."""
    t_s = np.arange(count) / 15
    points = np.stack([PERSON.joints(float(t)) for t in t_s])
    later = np.stack([PERSON.joints(float(t) + 1e-3) for t in t_s])
    velocity = (later - points) * 1e3
    if mirrored:
        points, velocity = (values[:, MIRROR] * (1.0, -1.0, 1.0) for values in (points, velocity))
    return Truth(camera, t_s, points[:, None], velocity, np.array([1.5]))


def _mirrored_camera(camera: Camera) -> Camera:
    flip_x, flip_y = np.diag((-1.0, 1.0, 1.0)), np.diag((1.0, -1.0, 1.0))
    return replace(camera, rotation=flip_x @ camera.rotation @ flip_y, translation_m=flip_x @ camera.translation_m)


@pytest.fixture(scope="module")
def streams() -> list[Stream]:
    return streams_of(lesson_of(3, 4.0), StandIn())


@pytest.fixture(scope="module")
def library(streams: list[Stream]) -> Library:
    return build(streams)


def test_a_mirrored_world_gives_the_mirrored_situation() -> None:
    matrix = np.array(((900.0, 0.0, 639.5), (0.0, 900.0, 359.5), (0.0, 0.0, 1.0)))
    camera = replace(ring_rig().cameras[1], matrix_px=matrix)
    _, plain = look(_truth(camera))
    _, mirrored = look(_truth(_mirrored_camera(camera), mirrored=True))
    for field in fields(Context):
        assert getattr(mirrored, field.name) == pytest.approx(getattr(plain.mirrored(), field.name), abs=1e-9), field.name


def test_a_situation_stays_what_it_is_wherever_and_however_large_and_turned_it_is_in_the_picture() -> None:
    camera = ring_rig().cameras[0]
    roll = 0.7
    turn = np.array(((np.cos(roll), -np.sin(roll), 0.0), (np.sin(roll), np.cos(roll), 0.0), (0.0, 0.0, 1.0)))
    matrix = np.array(((450.0, 0.0, 300.0), (0.0, 450.0, 500.0), (0.0, 0.0, 1.0)))
    other = replace(camera, rotation=turn @ camera.rotation, translation_m=turn @ camera.translation_m, matrix_px=matrix)
    _, one = look(_truth(camera))
    _, two = look(_truth(replace(other, size_px=(4000, 4000))))
    assert two.pose == pytest.approx(one.pose, abs=1e-9)
    assert two.view == pytest.approx(one.view, abs=1e-9)
    assert two.speed == pytest.approx(one.speed, abs=1e-9)
    assert two.size == pytest.approx(one.size + np.log(0.5), abs=1e-9)


def test_the_head_hides_the_face_from_behind_and_somebody_in_the_way_hides_everything() -> None:
    still = Person(height_m=1.6, radius_m=0.0, throws=False)
    points = still.joints(0.0)
    across = points[5, :2] - points[6, :2]
    ahead = np.array((across[1], -across[0], 0.0)) / np.linalg.norm(across)
    face = [0, 1, 2]
    front, behind = (points[0] + side * 4.0 * ahead for side in (1.0, -1.0))
    alone, statures = points[None, None], np.array([1.6])
    assert hidden(front, alone, statures)[0, face].max() < 0.2
    assert hidden(behind, alone, statures)[0, face].min() > 0.5
    both = np.stack((points, points + 1.0 * ahead))[None]
    assert hidden(front, both, np.array([1.6, 1.6]))[0].mean() > hidden(front, alone, statures)[0].mean() + 0.5
    beyond = np.stack((points, points - 1.0 * ahead))[None]
    assert hidden(front, beyond, np.array([1.6, 1.6])) == pytest.approx(hidden(front, alone, statures))


def test_errors_and_words_are_the_same_thing_told_twice(streams: list[Stream]) -> None:
    for stream in streams:
        frame, context = look(stream.truth)
        errors = errors_of(frame, stream.said)
        said = said_of(
            frame, replace(errors, spread=errors.spread + np.log(stream.said.side_px / frame.side_px)[:, None]), stream.said.delay_s
        )
        for name in ("keypoints_px", "sigma_px", "score"):
            assert getattr(said, name) == pytest.approx(getattr(stream.said, name), nan_ok=True)
        assert errors.found.any()
        off = displacement(context.pose, errors)[errors.found] * frame.stature_px[errors.found, None, None]
        plain = np.linalg.norm(stream.said.keypoints_px - frame.points_px, axis=-1)[errors.found]
        assert np.linalg.norm(off, axis=-1) == pytest.approx(plain, abs=1e-6)


def test_a_swapped_wrist_is_told_by_the_wrist_that_it_is_on() -> None:
    truth = _truth(ring_rig().cameras[0])
    frame, _ = look(truth)
    wrists = [coco.INDEX["left_wrist"], coco.INDEX["right_wrist"]]
    keypoints = frame.points_px.copy()
    keypoints[:, wrists] = keypoints[:, wrists[::-1]] + 1.0
    count = len(truth)
    ones = np.ones((count, coco.COUNT))
    errors = errors_of(frame, Said(keypoints, ones, ones, np.full(count, 300.0), np.zeros(count, np.bool_), np.zeros(count)))
    apart = np.linalg.norm(frame.points_px[:, wrists[0]] - frame.points_px[:, wrists[1]], axis=-1) / frame.stature_px
    assert (errors.crossed[apart > 0.06][:, wrists]).all()
    assert not np.delete(errors.crossed, wrists, axis=1).any()
    assert np.linalg.norm(errors.residual[apart > 0.06][:, wrists], axis=-1).max() < 0.01


def test_the_file_keeps_the_library_to_a_byte_a_number_and_is_the_same_every_time(library: Library) -> None:
    data = encode(library, {"network": "thunder"})
    kept, settings = decode(data, "x")
    assert settings == {"network": "thunder"}
    assert data == encode(library, {"network": "thunder"})
    assert encode(kept, settings) == data
    assert kept.errors.residual == pytest.approx(library.errors.residual, rel=0.06, abs=2e-4)
    assert kept.errors.score == pytest.approx(library.errors.score, abs=0.005)
    assert (kept.errors.crossed == library.errors.crossed).all()
    assert (kept.errors.found == library.errors.found).all()
    assert (kept.starts == library.starts).all()
    assert kept.seeds == library.seeds
    assert len(data) < 110 * len(library) + 4000


def test_what_is_no_file_or_of_another_version_is_refused_with_what_to_do(
    library: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = encode(library, {})
    for broken in (b"", b"nothing", data[: len(data) // 2]):
        with pytest.raises(UserError, match=r"twin\.npz is no file of the twin; make it anew with make twin"):
            decode(broken, "twin.npz")
    monkeypatch.setattr(libraries, "VERSION", libraries.VERSION + 1)
    with pytest.raises(UserError, match="is of version 1, this twin reads 2"):
        decode(data, "twin.npz")


def test_transitions_join_pictures_of_one_stream_at_the_interval_that_was_asked(library: Library) -> None:
    for interval_s in (1 / 15, 2 / 15):
        first, second = library.transitions(interval_s)
        stream = [np.searchsorted(library.starts, entries, side="right") for entries in (first, second)]
        assert (stream[0] == stream[1]).all()
        assert library.t_s[second] - library.t_s[first] == pytest.approx(interval_s, rel=0.01)
        assert len(first) == len(library) - len(library.lessons) * round(interval_s * 15)
    with pytest.raises(UserError, match="knows no pictures 33 ms apart"):
        library.transitions(1 / 30)


def test_a_seed_that_is_left_out_is_out(streams: list[Stream]) -> None:
    both = build([*streams, *(replace(stream, seed=8) for stream in streams[:2])])
    rest = both.without(3)
    assert rest.seeds == (8, 8)
    assert len(rest) == len(streams[0].truth) + len(streams[1].truth)
    assert rest.errors.residual == pytest.approx(both.errors.residual[both.starts[4] :])


def test_the_nearest_are_those_that_sorting_gives() -> None:
    random = np.random.default_rng(0)
    for count in (3, 50, 400):
        values = random.integers(0, 40, count).astype(np.float32)
        values[random.uniform(size=count) < 0.2] = np.float32(1e30)
        best = np.full(12, -1)
        held = walk.smallest(values, best)
        order = np.argsort(values, kind="stable")
        order = order[values[order] < 1e30][:12]
        assert held == len(order)
        assert (best[:held] == order).all()


@pytest.mark.slow
def test_points_between_samples_and_of_late_rows_are_where_they_were() -> None:
    performer = PlainPerformer(1.5, PERSON.joints)
    sampled = Sampled((performer,), 0.0, 2.0)
    times_s = np.random.default_rng(1).uniform(0.0, 2.0, 200)
    exact = np.stack([PERSON.joints(float(t)) for t in times_s])
    assert sampled.at(np.broadcast_to(times_s[:, None, None], (200, 1, coco.COUNT)))[:, 0] == pytest.approx(exact, abs=1e-4)
    camera, shutter = ring_rig().cameras[0], Shutter(readout_s=0.03)
    truth = truth_of(sampled, camera, times_s[np.argsort(times_s)], shutter)
    rows = camera.project(truth.points_m[:, 0])[..., 1]
    delays_s = shutter.row_delay_s(rows, 720)
    expected = np.array(
        [[PERSON.joints(float(t + d))[j] for j, d in enumerate(row)] for t, row in zip(truth.t_s, delays_s, strict=True)]
    )
    assert truth.points_m[:, 0] == pytest.approx(expected, abs=1e-3)


def test_cameras_take_turns_at_their_rates() -> None:
    rig = ring_rig()
    times = turns(rig, 15.0, 10.0)
    assert [len(times_s) for times_s in times] == [150] * 4
    first: Float = np.array([times_s[0] for times_s in times])
    assert np.diff(first) == pytest.approx(np.full(3, 1 / 60))
    with pytest.raises(ValueError, match="times for each camera"):
        Lesson(Rig(rig.cameras[:2]), (PlainPerformer(1.5, PERSON.joints),), times)


def test_mirroring_twice_changes_nothing(library: Library) -> None:
    twice = library.errors.mirrored().mirrored()
    for field in fields(Errors):
        assert (getattr(twice, field.name) == getattr(library.errors, field.name)).all(), field.name
