"""What stands in exported files: heads, axes, units, names, angles; and what is refused."""

import json
import struct

import numpy as np
import pytest

from models.errors import UserError
from models.messages.motion import JointState
from models.motions.rotations import about
from models.skeleton import coco
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track, known_track
from services.lesson.export import beside, c3d, glb, mot, trc
from services.lesson.export.armature import armature
from services.lesson.export.axes import FIGURES, OPENSIM, OURS
from services.lesson.export.formats import files_of
from services.lesson.export.kinds import Format, format_of
from services.lesson.export.take import Take, TakeError
from services.lesson.export.zxy import zxy_deg
from tests.takes import FRAME_S, STANDING_M, moving, performed


def still(joints_m: np.ndarray, frames: int = 3) -> Take:
    return Take(known_track(np.repeat(joints_m[None], frames, axis=0), FRAME_S, 0.01), "still")


def without(take: Take, joints: tuple[str, ...], first: int = 0, end: int | None = None) -> Take:
    states = take.track.states.copy()
    states[first:end, [coco.INDEX[name] for name in joints]] = JointState.UNKNOWN
    return Take(Track(take.track.t_s, take.track.joints_m, take.track.covariance_m2, states), take.name)


@pytest.mark.parametrize("world", [OURS, OPENSIM, FIGURES])
def test_worlds_are_turns_and_no_mirrors(world: object) -> None:
    turn = world.turn  # type: ignore[attr-defined]
    np.testing.assert_allclose(turn @ turn.T, np.eye(3))
    assert np.linalg.det(turn) == pytest.approx(1)


def test_who_looks_along_x_looks_forward_in_every_world() -> None:
    front, left, up = np.eye(3)
    np.testing.assert_array_equal([OPENSIM.to(front), OPENSIM.to(up), OPENSIM.to(-left)], np.eye(3))
    np.testing.assert_array_equal([FIGURES.to(left), FIGURES.to(up), FIGURES.to(front)], np.eye(3))


def test_trc_has_the_head_that_opensim_reads_and_nothing_where_a_point_is_unknown() -> None:
    take = without(still(STANDING_M), ("left_eye",), 1, 2)
    lines = trc.encode(take).decode().split("\n")
    assert lines[0] == "PathFileType\t4\t(X/Y/Z)\tstill.trc"
    assert lines[2].split("\t") == ["30", "30", "3", "17", "mm", "30", "1", "3"]
    assert lines[3].split("\t")[:9] == ["Frame#", "Time", "Nose", "", "", "LEye", "", "", "REye"]
    assert lines[4].split("\t")[-1] == "Z17"
    first, second = lines[6].split("\t"), lines[7].split("\t")
    assert first[:8] == ["1", "0.000000", "120.00", "1420.00", "0.00", "100.00", "1450.00", "-30.00"]
    assert second[:2] == ["2", "0.033333"]
    assert second[5:8] == ["", "", ""]
    assert len(second) == 2 + 3 * 17


def test_a_name_with_line_ends_and_tabs_makes_no_new_lines() -> None:
    take = Take(still(STANDING_M).track, "a\nb\tc")
    assert trc.encode(take).decode().split("\n")[0] == "PathFileType\t4\t(X/Y/Z)\ta b c.trc"


def mot_at(joints_m: np.ndarray) -> dict[str, float]:
    return {name: float(values[0]) for name, (values, _) in mot.coordinates(still(joints_m)).items()}


def bent(joints: tuple[str, ...], about_joint: str, axis: int, degrees: float, joints_m: np.ndarray = STANDING_M) -> np.ndarray:
    """The pose with some joints turned about one."""
    pose = joints_m.copy()
    centre = pose[coco.INDEX[about_joint]]
    places = [coco.INDEX[name] for name in joints]
    pose[places] = (pose[places] - centre) @ about(axis, np.array(np.deg2rad(degrees))).T + centre
    return pose


def hanging() -> np.ndarray:
    """Stands with limbs straight down, so that all angles are zero."""
    pose = STANDING_M.copy()
    for side, sign in (("left", 1), ("right", -1)):
        for part, y, z in (
            ("hip", 0.1, 0.8),
            ("knee", 0.1, 0.45),
            ("ankle", 0.1, 0.1),
            ("shoulder", 0.15, 1.2),
            ("elbow", 0.15, 0.95),
            ("wrist", 0.15, 0.7),
        ):
            pose[coco.INDEX[f"{side}_{part}"]] = (0.0, sign * y, z)
    return pose


def test_mot_is_zero_for_who_stands_upright_and_looks_along_x() -> None:
    found = mot_at(hanging())
    assert {name: value for name, value in found.items() if abs(value) > 1e-9 and not name.startswith("pelvis_t")} == {}
    scale = 0.2 / (2 * 0.07726)
    assert found["pelvis_ty"] == pytest.approx(0.8 + 0.07849 * scale, abs=1e-6)
    assert found["pelvis_tx"] == pytest.approx(0.05628 * scale, abs=1e-6)


@pytest.mark.parametrize(
    ("joints", "centre", "axis", "degrees", "name", "value"),
    [
        # Turns about our y (to the left) by a negative angle bring what hangs to the front.
        (("left_knee", "left_ankle"), "left_hip", 1, -40, "hip_flexion_l", 40),
        (("right_ankle",), "right_knee", 1, 70, "knee_angle_r", 70),
        (("right_wrist",), "right_elbow", 1, -90, "elbow_flex_r", 90),
        (("right_elbow", "right_wrist"), "right_shoulder", 1, -60, "arm_flex_r", 60),
        # About our x (to the front): a positive angle brings the hanging right arm inwards, so a negative one outwards.
        (("right_elbow", "right_wrist"), "right_shoulder", 0, -50, "arm_add_r", -50),
        (("left_elbow", "left_wrist"), "left_shoulder", 0, 50, "arm_add_l", -50),
        (("left_knee", "left_ankle"), "left_hip", 0, 30, "hip_adduction_l", -30),
        (("right_knee", "right_ankle"), "right_hip", 0, -30, "hip_adduction_r", -30),
    ],
)  # fmt: skip
def test_mot_angles_of_known_poses(
    joints: tuple[str, ...], centre: str, axis: int, degrees: float, name: str, value: float
) -> None:
    found = mot_at(bent(joints, centre, axis, degrees, hanging()))
    assert found.pop(name) == pytest.approx(value, abs=1e-6)
    assert {other: angle for other, angle in found.items() if abs(angle) > 1e-6 and not other.startswith("pelvis_t")} == {}


def test_mot_sees_how_a_bent_limb_is_turned_and_leaves_out_what_no_limb_showed() -> None:
    straight = mot_at(hanging())
    assert "arm_rot_r" not in straight
    assert "hip_rotation_l" not in straight
    assert {"ankle_angle_r", "pro_sup_r", "lumbar_extension", "wrist_flex_r"} & set(straight) == set()
    elbow = bent(("right_wrist",), "right_elbow", 1, -90, hanging())
    # The forearm points forward; turned by 30 degrees about the vertical it points inwards, which is a positive turn on the right.
    assert mot_at(bent(("right_wrist",), "right_elbow", 2, 30, elbow))["arm_rot_r"] == pytest.approx(30, abs=1e-6)
    left = bent(("left_wrist",), "left_elbow", 1, -90, hanging())
    assert mot_at(bent(("left_wrist",), "left_elbow", 2, -30, left))["arm_rot_l"] == pytest.approx(30, abs=1e-6)


def rebuilt(found: dict[str, float]) -> dict[str, np.ndarray]:
    """Directions of limbs in OpenSim's world, by the model's own definition of its joints."""

    def zxy(names: tuple[str, str, str], sign: float = 1.0) -> np.ndarray:
        z, x, y = (np.deg2rad(found.get(name, 0.0)) * s for name, s in zip(names, (1.0, sign, sign), strict=True))
        return np.asarray(about(2, np.array(z)) @ about(0, np.array(x)) @ about(1, np.array(y)))

    down = np.array((0.0, -1.0, 0.0))
    pelvis = zxy(("pelvis_tilt", "pelvis_list", "pelvis_rotation"))
    torso = pelvis @ zxy(("lumbar_extension", "lumbar_bending", "lumbar_rotation"))
    directions = {"trunk": -torso @ down}
    for side, sign in (("r", 1.0), ("l", -1.0)):
        femur = pelvis @ zxy((f"hip_flexion_{side}", f"hip_adduction_{side}", f"hip_rotation_{side}"), sign)
        humerus = torso @ zxy((f"arm_flex_{side}", f"arm_add_{side}", f"arm_rot_{side}"), sign)
        directions[f"thigh_{side}"], directions[f"upper_arm_{side}"] = femur @ down, humerus @ down
        directions[f"shank_{side}"] = femur @ about(2, np.array(np.deg2rad(-found[f"knee_angle_{side}"]))) @ down
        directions[f"forearm_{side}"] = humerus @ about(2, np.array(np.deg2rad(found[f"elbow_flex_{side}"]))) @ down
    return directions


@pytest.mark.parametrize("action", ["badminton_clear", "long_jump", "soccer_kick"])
def test_the_model_driven_by_mot_points_its_limbs_where_the_pupils_pointed(action: str) -> None:
    take = performed(action)
    table = mot.coordinates(take)
    for frame in range(0, len(take.track), 5):
        joints = OPENSIM.to(take.track.joints_m[frame])
        directions = rebuilt({name: float(values[frame]) for name, (values, _) in table.items()})
        for limb, (near, far) in coco.LIMBS.items():
            side, part = limb.split("_", 1)
            bends = table[f"{'elbow_flex' if part in {'upper_arm', 'forearm'} else 'knee_angle'}_{side[0]}"][0][frame]
            true = joints[far] - joints[near]
            angle = np.rad2deg(np.arccos(np.clip(directions[f"{part}_{side[0]}"] @ true / np.linalg.norm(true), -1, 1)))
            held = part in {"forearm", "shank"} and bends <= mot.STRAIGHT_DEG
            assert angle < (2 * bends + 1e-3 if held else 1e-3), (limb, frame)


def test_angles_about_z_x_and_y_come_back_also_where_two_axes_are_one() -> None:
    random = np.random.default_rng(1)
    given = random.uniform(-170, 170, (50, 3))
    given[:, 1] /= 2
    given[-5:, 1] = (90, -90, 90, -90, 90)
    turns = about(2, np.deg2rad(given[:, 0])) @ about(0, np.deg2rad(given[:, 1])) @ about(1, np.deg2rad(given[:, 2]))
    found = np.deg2rad(zxy_deg(turns))
    np.testing.assert_allclose(about(2, found[:, 0]) @ about(0, found[:, 1]) @ about(1, found[:, 2]), turns, atol=1e-7)


def test_a_somersault_has_no_jump_in_its_angles() -> None:
    turns = about(2, np.linspace(0, 4 * np.pi, 100))
    np.testing.assert_allclose(zxy_deg(turns)[:, 0], np.linspace(0, 720, 100), atol=1e-6)


def test_what_is_held_is_listed_beside_the_file_with_pupil_and_keyframes() -> None:
    whole = performed()
    take = without(whole, ("left_wrist",), 9, 20)
    files = files_of(Take(take.track, "clear", "P07", whole.attempts), Format.BVH)
    assert list(files) == ["clear.bvh", "clear.bvh.json"]
    about_it = json.loads(files["clear.bvh.json"])
    assert about_it["held_frames"] == {"LeftForeArm": [[10, 20]], "LeftHand": [[10, 20]]}
    assert about_it["guessed_frames"] == {}
    assert about_it["pupil"] == "P07"
    (attempt,) = about_it["attempts"]
    assert attempt["action"] == "badminton_clear"
    assert attempt["keyframes_s"]["peak"] == pytest.approx(whole.attempts[0].moments_s[2], abs=1e-6)


def test_what_was_guessed_is_told_by_point_and_frame() -> None:
    track = still(STANDING_M, 9).track
    states = track.states.copy()
    states[[0, 4, 5, 8], coco.INDEX["right_wrist"]] = JointState.GUESSED
    take = Take(Track(track.t_s, track.joints_m, track.covariance_m2, states), "still")
    assert take.about()["guessed_frames"] == {"RWrist": [[1, 1], [5, 6], [9, 9]]}


def test_formats_that_say_everything_themselves_have_nothing_beside_them() -> None:
    for kind, beside_it in ((Format.C3D, 0), (Format.GLB, 0), (Format.TRC, 1), (Format.MOT, 1), (Format.BVH, 1)):
        assert len(files_of(performed(), kind)) == 1 + beside_it
    assert json.loads(beside.encode(performed(), {}))["held_frames"] == {}


def test_glb_says_in_its_extras_who_it_is_and_when_the_keyframes_are() -> None:
    data = glb.encode(performed())
    (length,) = struct.unpack_from("<I", data, 12)
    extras = json.loads(data[20 : 20 + length])["asset"]["extras"]
    assert (extras["pupil"], extras["attempts"][0]["action"]) == ("P07", "badminton_clear")
    assert list(extras["attempts"][0]["keyframes_s"]) == ["start", "exertion", "peak", "end"]
    assert struct.unpack_from("<II", data, 4) == (2, len(data))


def scales_of(data: bytes) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Instants and scales (n,) of each shape of a GLB that comes and goes."""
    (length,) = struct.unpack_from("<I", data, 12)
    told, binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def values(accessor: int) -> np.ndarray:
        view = told["bufferViews"][told["accessors"][accessor]["bufferView"]]
        return np.frombuffer(binary, "<f4", view["byteLength"] // 4, view["byteOffset"])

    (animation,) = told["animations"]
    found = {}
    for channel in animation["channels"]:
        if channel["target"]["path"] == "scale":
            sampler = animation["samplers"][channel["sampler"]]
            name = told["nodes"][channel["target"]["node"]]["name"]
            found[name] = (values(sampler["input"]), values(sampler["output"]).reshape(-1, 3)[:, 0])
    assert {node["name"] for node in told["nodes"] if "mesh" in node} >= set(found)
    return found


def test_no_shape_of_a_glb_stays_behind_when_a_hip_is_out_of_sight() -> None:
    """All hangs on the hips: a head at the place where they were last is a head where nobody is."""
    take = without(Take(moving(5, 31), "run"), ("left_hip",), 15)
    scales = scales_of(glb.encode(take))
    assert {name.removesuffix(" shape") for name in scales} >= {"Head", "Neck", "Spine", "LeftArm", "RightLeg"}
    for name, (instants_s, sizes) in scales.items():
        assert sizes.tolist() == [1.0, 0.0], name
        assert instants_s[1] == pytest.approx(15 / 30, abs=1e-6)


def test_a_hand_out_of_sight_takes_nothing_else_with_it() -> None:
    take = without(Take(moving(5, 31), "run"), ("left_wrist",), 15)
    assert list(scales_of(glb.encode(take))) == ["LeftForeArm shape"]


def test_a_c3d_holds_no_letters_that_it_cannot_name() -> None:
    whole = performed()
    with pytest.raises(UnicodeEncodeError):
        c3d.encode(Take(whole.track, whole.name, "Ö7"))


def test_bones_are_as_long_as_they_are_in_the_median_frame() -> None:
    take = Take(moving(5, 31), "motion")
    tree = armature(take)
    places = {bone.name: bone for bone in tree.bones}
    joints = take.track.joints_m
    lengths = np.linalg.norm(joints[:, coco.INDEX["right_knee"]] - joints[:, coco.INDEX["right_ankle"]], axis=1)
    assert np.linalg.norm(places["RightFoot"].offset_m) == pytest.approx(np.median(lengths))


def test_a_joint_that_is_never_known_has_no_bone_and_nothing_hangs_on_it() -> None:
    names = {bone.name for bone in armature(without(Take(moving(5, 9), "m"), ("left_elbow",))).bones}
    assert {"LeftForeArm", "LeftHand"} & names == set()
    assert {"LeftArm", "RightHand", "Head"} <= names


@pytest.mark.parametrize(
    ("track", "reason"),
    [
        (moving(1, 2).part(0, 0), "fewer than two frames"),
        (moving(1, 2).part(0, 1), "fewer than two frames"),
        (known_track(np.full((4, 17, 3), np.nan), FRAME_S), "no frame in which a joint is known"),
    ],
)
def test_short_and_empty_tracks_are_refused(track: Track, reason: str) -> None:
    with pytest.raises(TakeError, match=reason):
        Take(track, "motion")


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_joint_that_is_said_to_be_known_and_is_no_number_is_refused(value: float) -> None:
    track = moving(1, 5)
    track.joints_m[3, 7, 1] = value
    with pytest.raises(TakeError, match="joint 7 is said to be known in frame 4"):
        Take(track, "motion")


def test_an_attempt_outside_of_the_track_is_refused() -> None:
    track = moving(1, 30)
    with pytest.raises(TakeError, match="does not hold the whole of its attempt 1, squat"):
        Take(track, "motion", "", (FoundAttempt("squat", "right", (100.1, 100.2, 100.3, 101.5)),))


@pytest.mark.parametrize("kind", [Format.BVH, Format.GLB, Format.MOT])
def test_without_hips_there_are_no_bones_and_trc_and_c3d_are_written_all_the_same(kind: Format) -> None:
    take = without(Take(moving(1, 5), "motion"), ("left_hip",))
    with pytest.raises(TakeError, match="both hips"):
        files_of(take, kind)
    assert files_of(take, Format.TRC)
    assert files_of(take, Format.C3D)


def test_a_format_that_there_is_not_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(UserError, match=r"^there is no format 'pdf'; choose one of trc, c3d, bvh, glb, mot$"):
        format_of("pdf")
