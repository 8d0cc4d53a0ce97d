"""Laws of exported motions: what is read back is what was written; what is cut off is refused, what is changed is harmless."""

import struct
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arrays import Float
from models.errors import UserError
from models.messages.motion import JointState
from models.skeleton import coco
from services.evaluation.track import Track
from services.lesson.export import bvh, c3d, glb, mot, trc
from services.lesson.export.armature import armature
from services.lesson.export.take import Take, TakeError
from services.lesson.imports import bvh as bvh_reading
from services.lesson.imports import c3d as c3d_reading
from services.lesson.imports import trc as trc_reading
from tests.takes import FRAME_S, moving

pytestmark = pytest.mark.slow

TEXT_M = 1e-5
FLOAT_M = 1e-6
READERS = {trc: trc_reading.decode, c3d: c3d_reading.decode, bvh: bvh_reading.decode}

tracks = st.builds(moving, st.integers(0, 10**6), st.integers(2, 40), st.sampled_from((0.0, 0.3, 0.8)))


def take_of(track: Track) -> Take:
    return Take(track, "motion")


def read_or_refused(data: bytes, kind: object) -> Track | None:
    try:
        return READERS[kind](data, "motion")  # type: ignore[index]
    except UserError as error:
        told = str(error)
    assert "\n" not in told
    assert "motion" in told
    return None


def writable(track: Track) -> bool:
    """Whether some joint is left, and each of those that an importer needs is left somewhere."""
    return bool((track.states != JointState.UNKNOWN).any(axis=0).all())


@settings(max_examples=60, deadline=None)
@given(tracks)
def test_trc_read_back_is_the_motion_to_a_hundredth_of_a_millimetre(track: Track) -> None:
    if not writable(track):
        return
    back = trc_reading.decode(trc.encode(take_of(track)), "motion.trc")
    assert back.frame_s == pytest.approx(track.frame_s, rel=1e-6)
    np.testing.assert_allclose(back.joints_m, track.joints_m, atol=TEXT_M)
    np.testing.assert_array_equal(back.states == JointState.UNKNOWN, track.states == JointState.UNKNOWN)


@settings(max_examples=60, deadline=None)
@given(tracks)
def test_c3d_read_back_is_the_motion_with_its_states_and_sigmas(track: Track) -> None:
    if not writable(track):
        return
    back = c3d_reading.decode(c3d.encode(take_of(track)), "motion.c3d")
    assert back.frame_s == pytest.approx(track.frame_s, rel=1e-6)
    np.testing.assert_allclose(back.joints_m, track.joints_m, atol=FLOAT_M)
    np.testing.assert_array_equal(back.states, track.states)
    seen = track.states == JointState.SEEN
    sigma_m = np.sqrt(np.trace(back.covariance_m2, axis1=2, axis2=3)[seen] / 3)
    truth_m = np.sqrt(np.trace(track.covariance_m2, axis1=2, axis2=3)[seen] / 3)
    np.testing.assert_allclose(sigma_m, truth_m, atol=1e-3 * c3d.SIGMA_STEP_MM / 2 + 1e-9)


CHAINS = {
    f"{side}_{far}": [(f"{side}_{a}", f"{side}_{b}") for a, b in chain]
    for side in ("left", "right")
    for far, chain in (
        ("knee", [("hip", "knee")]),
        ("ankle", [("hip", "knee"), ("knee", "ankle")]),
        ("elbow", [("shoulder", "elbow")]),
        ("wrist", [("shoulder", "elbow"), ("elbow", "wrist")]),
    )
}


@settings(max_examples=60, deadline=None)
@given(tracks)
def test_a_skeletons_joints_are_off_by_no_more_than_its_bones_vary(track: Track) -> None:
    """In every frame in which all is known, whatever was held before."""
    whole = (track.states != JointState.UNKNOWN).all(axis=1)
    if not whole.any():
        return
    back = bvh_reading.decode(bvh.encode(take_of(track)), "motion.bvh")
    off_m = np.linalg.norm(back.joints_m - track.joints_m, axis=2)[whole]
    joints = {name: track.joints_m[:, index] for index, name in enumerate(coco.NAMES)}

    def varies(start: Float, end: Float) -> Float:
        lengths = np.linalg.norm(end - start, axis=1)
        return np.asarray(np.abs(lengths - np.nanmedian(lengths))[whole])

    hips, shoulders = ((joints[f"left_{part}"] + joints[f"right_{part}"]) / 2 for part in ("hip", "shoulder"))
    for name in coco.NAMES[coco.INDEX["left_shoulder"] :]:
        side = name.partition("_")[0]
        arm = "shoulder" in name or "elbow" in name or "wrist" in name
        base = (
            varies(hips, shoulders) + varies(shoulders, joints[f"{side}_shoulder"]) if arm else varies(hips, joints[f"{side}_hip"])
        )
        bound = base + sum(varies(joints[a], joints[b]) for a, b in CHAINS.get(name, []))
        assert (off_m[:, coco.INDEX[name]] <= bound + 2e-5).all(), name


SPINE = ("Hips", "Shoulders")
PLACES: dict[str, tuple[str, ...]] = {
    "Hips": SPINE[:1],
    "Spine": SPINE[:1],
    "Spine1": SPINE,
    "Neck": SPINE,
    "Head": (*SPINE, "Ears"),
}
"""The points over which each bone's joint follows from the root."""
for label in ("Left", "Right"):
    for bones, carrier, parts in (
        (("UpLeg", "Leg", "Foot"), SPINE[:1], ("hip", "knee", "ankle")),
        (("Arm", "ForeArm", "Hand"), SPINE, ("shoulder", "elbow", "wrist")),
    ):
        for count, bone in enumerate(bones, start=1):
            PLACES[label + bone] = (*carrier, *(f"{label.lower()}_{part}" for part in parts[:count]))


@settings(max_examples=60, deadline=None)
@given(tracks)
def test_a_shape_that_is_shown_is_where_the_points_are_whatever_is_unknown(track: Track) -> None:
    take = take_of(track)
    try:
        tree = armature(take)
    except TakeError:
        return
    point = {name: take.joints_m[:, index] for index, name in enumerate(coco.NAMES)}
    for middle, part in (("Hips", "hip"), ("Shoulders", "shoulder"), ("Ears", "ear")):
        point[middle] = (point[f"left_{part}"] + point[f"right_{part}"]) / 2
    at: list[Float] = []
    axes: list[Float] = []
    for index, bone in enumerate(tree.bones):
        turn = tree.turns[:, index]
        at.append(tree.root_m if bone.parent < 0 else at[bone.parent] + axes[bone.parent] @ bone.offset_m)
        axes.append(turn if bone.parent < 0 else axes[bone.parent] @ turn)
        chain, shown = [point[name] for name in PLACES.get(bone.name, ())], ~tree.lost[:, index]
        if not chain or not shown.any():
            continue
        bound = np.full(len(track), 1e-9)
        for start, end in pairwise(chain):
            lengths = np.linalg.norm(end - start, axis=1)
            bound += np.abs(lengths - np.nanmedian(lengths))
        assert (np.linalg.norm(at[-1] - chain[-1], axis=1)[shown] <= bound[shown]).all(), bone.name


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_a_skeleton_of_rigid_bones_comes_back_whole(seed: int) -> None:
    """One pose that turns: all bones keep their lengths, so only the file's four digits are lost."""
    still = moving(seed, 2, swing_m=0.03).joints_m[0]
    angles = np.linspace(0, 5, 20)
    turned = np.stack([still @ np.array(((np.cos(a), -np.sin(a), 0), (np.sin(a), np.cos(a), 0), (0, 0, 1))).T for a in angles])
    states = np.full(turned.shape[:2], JointState.SEEN, np.uint8)
    track = Track(angles * 0 + np.arange(20) * FRAME_S, turned, np.zeros((20, 17, 3, 3)), states)
    back = bvh_reading.decode(bvh.encode(take_of(track)), "motion.bvh")
    np.testing.assert_allclose(back.joints_m, turned, atol=2e-5)


@settings(max_examples=60, deadline=None)
@given(tracks, st.sampled_from((trc, c3d, bvh, glb, mot)))
def test_whatever_is_unknown_a_take_is_written_or_refused_with_a_reason(track: Track, kind: object) -> None:
    try:
        data = kind.encode(take_of(track))  # type: ignore[attr-defined]
    except TakeError:
        return
    assert len(data) > 100
    if kind in (trc, bvh, mot):
        assert b"nan" not in data.lower()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from((0.0, 1e-3, 0.1, 1.0)), st.sampled_from((0, 1, 2)), st.sampled_from((bvh, glb, mot)))
def test_points_on_one_place_or_in_one_line_make_no_number_that_is_none(seed: int, size: float, flat: int, kind: object) -> None:
    track = moving(seed, 12, 0.3)
    squeezed = track.joints_m * size
    squeezed[..., :flat] = 0
    take = take_of(Track(track.t_s, squeezed, track.covariance_m2, track.states))
    try:
        data = kind.encode(take)  # type: ignore[attr-defined]
    except TakeError:
        return
    turns = armature(take).turns
    np.testing.assert_allclose(turns @ turns.swapaxes(-1, -2), np.broadcast_to(np.eye(3), turns.shape), atol=1e-9)
    if kind is glb:
        (length,) = struct.unpack_from("<I", data, 12)
        assert np.isfinite(np.frombuffer(data[28 + length :], "<f4")).all()
    else:
        assert b"nan" not in data


@settings(max_examples=60, deadline=None)
@given(st.sampled_from((trc, c3d, bvh)), st.floats(0, 1))
def test_a_file_that_is_cut_off_anywhere_is_refused(kind: object, share: float) -> None:
    data = kind.encode(take_of(moving(3, 20)))  # type: ignore[attr-defined]
    assert read_or_refused(data[: int(share * (len(data) - 513))], kind) is None


@settings(max_examples=300, deadline=None)
@given(st.sampled_from((trc, c3d, bvh)), st.data())
def test_a_file_in_which_bytes_were_changed_is_read_or_refused_in_one_line(kind: object, data: st.DataObject) -> None:
    changed = bytearray(kind.encode(take_of(moving(3, 5))))  # type: ignore[attr-defined]
    for _ in range(data.draw(st.integers(1, 6))):
        changed[data.draw(st.integers(0, min(len(changed) - 1, 4000)))] = data.draw(st.integers(0, 255))
    track = read_or_refused(bytes(changed), kind)
    assert track is None or len(track) >= 2


@given(st.binary(max_size=3000), st.sampled_from((trc, c3d, bvh)))
def test_bytes_of_anything_are_refused_in_one_line(data: bytes, kind: object) -> None:
    assert read_or_refused(data, kind) is None
