"""Motions of other programs: foreign names, units and axes; and what is refused, in one line that says what to do."""

import warnings
from io import BytesIO
from pathlib import Path

import c3d as library
import numpy as np
import pytest

from models.errors import UserError
from models.messages.motion import JointState
from models.skeleton import coco
from services.evaluation.track import Track
from services.lesson.export import bvh, c3d, trc
from services.lesson.export.take import Take
from services.lesson.imports import bvh as bvh_reading
from services.lesson.imports import c3d as c3d_reading
from services.lesson.imports import trc as trc_reading
from services.lesson.imports.file import read_motion
from services.lesson.imports.names import NamesError, points_of
from tests.takes import moving

TAKE = Take(moving(4, 12), "motion")
TEXTS = {"trc": trc.encode(TAKE).decode(), "bvh": bvh.encode(TAKE).decode()}
READ = {"trc": trc_reading.decode, "bvh": bvh_reading.decode}
SHARED = Path(__file__).parents[3] / "shared/data"


@pytest.mark.parametrize(
    ("form", "parts"),
    [
        ("{Side}{Part}", ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")),
        ("{S}{Part}", ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")),
        ("{S}{PART}", ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")),
        ("{side}_{part}", ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")),
        ("{part}.{S}", ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")),
        ("Pupil:{S}.{Part}", ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")),
        ("mixamorig:{Side}{Part}", ("Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")),
        ("{Part}_{S}", ("UpperArm", "LowerArm", "Hand", "Thigh", "Calf", "Foot")),
    ],
)
def test_names_of_other_programs_are_known(form: str, parts: tuple[str, ...]) -> None:
    names = ["Hips", "Spine", "LeftToeBase"]
    for side in ("left", "right"):
        names += [
            form.format(side=side, Side=side.capitalize(), S=side[0].upper(), part=part, Part=part, PART=part.upper())
            for part in parts
        ]
    found = points_of(names)
    assert {coco.NAMES[joint]: place for joint, place in found.items()} == {
        f"{side}_{part}": 3 + 6 * (side == "right") + number
        for side in ("left", "right")
        for number, part in enumerate(("shoulder", "elbow", "wrist", "hip", "knee", "ankle"))
    }


def test_mixamos_shoulder_is_the_collar_bone() -> None:
    parts = ("Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot")
    names = [f"{side}{part}" for side in ("Left", "Right") for part in parts]
    assert points_of(names)[coco.INDEX["left_shoulder"]] == 1


def test_two_markers_for_one_point_are_refused_by_their_names() -> None:
    with pytest.raises(NamesError, match="twice where the left hip is, as 'LHip' and 'left_hip'"):
        points_of([*(f"{s}{part}" for s in "LR" for part in ("Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle")), "left_hip"])


def refused(kind: str, text: str) -> str:
    with pytest.raises(UserError) as caught:
        READ[kind](text.encode(), f"standard.{kind}")
    told = str(caught.value)
    assert "\n" not in told
    assert f"standard.{kind}" in told
    return told


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("PathFileType\t4", "PathFileType\t3", "another version than 4"),
        ("PathFileType", "Filetype", "is no TRC file"),
        ("\tmm\t", "\tfurlong\t", "unit is 'furlong'"),
        ("LKnee", "Wand1", "has no left knee"),
        ("\t12\t17\t", "\t14\t17\t", "has 12 frames and says that it has 14"),
        ("\t12\t17\t", "\t12\t18\t", "names 17 markers and says that it has 18"),
        ("\t12\t17\t", "\tmany\t17\t", "says no NumFrames"),
        ("30\t30\t", "60\t60\t", "does not follow at 60 frames a second"),
        ("\n3\t0.066667", "\n3\tsoon", "line 9: 'soon' is no number"),
        ("\n3\t0.066667", "\n3\tinf", "does not follow"),
    ],
)
def test_a_trc_that_is_not_whole_or_foreign_is_refused(before: str, after: str, told: str) -> None:
    assert before in TEXTS["trc"]
    assert told in refused("trc", TEXTS["trc"].replace(before, after, 1))


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("HIERARCHY", "SKELETON", "is no BVH file"),
        ("MOTION", "STILL", "has no MOTION"),
        ("Frames: 12", "Frames: 13", "has 12 frames and says that it has 13"),
        ("Frames: 12", "Frames: x", "does not say its frames"),
        ("LeftUpLeg", "LeftWheel", "has no left hip"),
        ("OFFSET 0.0000", "OFFSET nought", "line 4: 'nought' stands where a number belongs"),
        ("Zrotation", "Wrotation", "'Wrotation' is no channel"),
        ("CHANNELS 6", "CHANNELS 5", "stands where OFFSET, CHANNELS, JOINT, End Site or } belongs"),
        ("Frame Time: 0.0", "Frame Time: 9.0", "frames a second"),
    ],
)
def test_a_bvh_that_is_not_whole_or_foreign_is_refused(before: str, after: str, told: str) -> None:
    assert before in TEXTS["bvh"]
    assert told in refused("bvh", TEXTS["bvh"].replace(before, after, 1))


def scaled_bvh(factor: float) -> bytes:
    """The same skeleton in another unit."""

    def scaled(line: str) -> str:
        words = line.split()
        first, end = (1, 4) if words[:1] == ["OFFSET"] else (0, 3 if len(words) > 20 else 0)
        return " ".join((*words[:first], *(f"{float(word) * factor:.9f}" for word in words[first:end]), *words[end:]))

    return "\n".join(map(scaled, TEXTS["bvh"].split("\n"))).encode()


@pytest.mark.parametrize("factor", [0.01, 1.0, 1 / 2.54, 10.0], ids=["metres", "centimetres", "inches", "millimetres"])
def test_the_unit_of_a_bvh_follows_from_its_legs(factor: float) -> None:
    known = bvh_reading.decode(TEXTS["bvh"].encode(), "a.bvh")
    np.testing.assert_allclose(bvh_reading.decode(scaled_bvh(factor), "b.bvh").joints_m, known.joints_m, atol=1e-6)


def leg_of(track: Track) -> float:
    """Thigh and shank, metres."""
    hip, knee, ankle = (track.joints_m[0, coco.INDEX[f"left_{part}"]] for part in ("hip", "knee", "ankle"))
    return float(np.linalg.norm(hip - knee) + np.linalg.norm(knee - ankle))


KNOWN = bvh_reading.decode(TEXTS["bvh"].encode(), "a.bvh")


def with_leg(units: float) -> bytes:
    """A BVH whose leg is so many units long."""
    return scaled_bvh(units / (100 * leg_of(KNOWN)))


@pytest.mark.parametrize(("units", "leg_m"), [(14.8, 0.835), (15.8, 0.892)], ids=["1.70 m", "1.82 m"])
def test_a_bvh_of_the_cmu_library_is_read_at_every_size_and_not_as_of_a_dwarf(units: float, leg_m: float) -> None:
    """It is in units of 5.644 cm; 15.8 of them were taken for inches, and a grown-up for a child of 82 cm."""
    assert leg_of(bvh_reading.decode(with_leg(units), "cmu.bvh")) == pytest.approx(leg_m, abs=1e-3)


def test_a_bvh_whose_unit_may_be_one_of_two_is_refused_until_it_is_said() -> None:
    with pytest.raises(UserError, match=r"b\.bvh: a leg is 18\.5 long, and the unit may be in or cmu; say it with --unit"):
        bvh_reading.decode(with_leg(18.5), "b.bvh")
    assert leg_of(bvh_reading.decode(with_leg(18.5), "b.bvh", "cmu")) == pytest.approx(1.044, abs=1e-3)
    assert leg_of(bvh_reading.decode(with_leg(18.5), "b.bvh", "in")) == pytest.approx(0.470, abs=1e-3)


def test_inches_of_a_tall_person_are_not_centimetres_of_a_small_one() -> None:
    assert leg_of(bvh_reading.decode(with_leg(42.0), "b.bvh")) == pytest.approx(1.067, abs=1e-3)


@pytest.mark.parametrize(
    ("unit", "told"),
    [
        ("mm", "in the unit 'mm' a leg is 0.074 m long, that of nobody; correct --unit"),
        ("ell", "there is no unit 'ell'; choose one of"),
    ],
)
def test_a_unit_that_makes_nobody_is_refused(unit: str, told: str) -> None:
    with pytest.raises(UserError) as caught:
        bvh_reading.decode(with_leg(74.0), "b.bvh", unit)
    assert told in str(caught.value)


def test_a_file_that_says_its_unit_takes_no_other(tmp_path: Path) -> None:
    (tmp_path / "a.trc").write_text(TEXTS["trc"])
    with pytest.raises(UserError, match=r"--unit is for BVH files, which say none; .*a\.trc says its own"):
        read_motion(tmp_path / "a.trc", "cm")


def test_a_bvh_of_a_giant_is_refused() -> None:
    with pytest.raises(UserError, match=r"c\.bvh: a leg is .* in no unit that of a person; export it in centimetres"):
        bvh_reading.decode(scaled_bvh(100.0), "c.bvh")


def test_a_trc_in_metres_with_windows_line_ends_and_missing_points_is_read() -> None:
    lines = TEXTS["trc"].split("\n")
    rows = []
    for line in lines[6:-1]:
        texts = line.split("\t")
        rows.append("\t".join(texts[:2] + [f"{float(text) / 1000:.6f}" for text in texts[2:]]))
    rows[0] = "\t".join([*rows[0].split("\t")[:2], "", "NaN", "", *rows[0].split("\t")[5:]])
    text = "\r\n".join([*lines[:2], lines[2].replace("mm", "m"), *lines[3:5], *rows, ""])
    track = trc_reading.decode(text.encode("utf-8-sig"), "a.trc")
    assert track.states[0, 0] == JointState.UNKNOWN
    np.testing.assert_allclose(track.joints_m[1:], TAKE.track.joints_m[1:], atol=1e-5)


def test_a_file_with_another_axis_up_is_refused_and_not_read_as_lying() -> None:
    lines = TEXTS["trc"].split("\n")
    rows = []
    for line in lines[6:-1]:
        texts = line.split("\t")
        points = np.array(texts[2:]).reshape(-1, 3)[:, [0, 2, 1]]
        rows.append("\t".join([*texts[:2], *points.ravel()]))
    assert "as if 'z' were up and not 'y'; export it again with y up" in refused("trc", "\n".join([*lines[:6], *rows, ""]))


def c3d_with(labels: list[str] | None = None, units: str = "mm", axis: str = "") -> bytes:
    """A foreign C3D: another company, residuals that mean nothing."""
    writer = library.Writer(point_rate=100.0, point_units=units)
    points = np.zeros((17, 5))
    points[:, :3] = TAKE.track.joints_m[0] * 1000
    if axis:
        writer.set_screen_axis("+X", axis)
        points[:, :3] = points[:, [0, 2, 1]] * (1, 1, -1)
    writer.add_frames([(points, np.zeros((0, 0)))] * 4)
    writer.set_point_labels(labels or [f"Subject1:{name}" for name in coco.NAMES])
    file = BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        writer.write(file)
    return file.getvalue()


@pytest.mark.parametrize("axis", ["", "+Y"], ids=["nothing said", "y up"])
def test_a_foreign_c3d_is_read_with_its_rate_and_its_axes(axis: str) -> None:
    track = c3d_reading.decode(c3d_with(axis=axis), "a.c3d")
    assert track.frame_s == pytest.approx(0.01)
    assert (track.states == JointState.SEEN).all()
    assert (track.covariance_m2 == 0).all()
    np.testing.assert_allclose(track.joints_m[2], TAKE.track.joints_m[0], atol=1e-6)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", "is no C3D file"),
        (b"\x02\x51" + bytes(2000), "is no C3D file"),
        (b"\x02\x50", "is cut off in its head"),
        (b"\x02\x50" + bytes(2000), "is broken or cut off"),
        (c3d_with(units="ft"), "unit is 'ft'"),
        (c3d_with(labels=[f"Marker{k}" for k in range(17)]), "has no shoulders, elbows, wrists, hips, knees and ankles"),
        (c3d.encode(TAKE)[:-600], "frames and says that it has 12"),
    ],
)
def test_a_c3d_that_is_not_whole_or_foreign_is_refused(data: bytes, told: str) -> None:
    with pytest.raises(UserError) as caught:
        c3d_reading.decode(data, "standard.c3d")
    assert told in str(caught.value)
    assert str(caught.value).startswith("standard.c3d")


@pytest.mark.parametrize(
    ("kind", "before", "after"),
    [
        ("trc", "\n3\t0.066667", "\n3\t1e308"),
        ("trc", "\n3\t0.066667\t", "\n3\t0.066667\t1e308\t"),
        ("bvh", "OFFSET 0.0000", "OFFSET 1e308"),
        ("bvh", "OFFSET 0.0000", "OFFSET -1e308"),
    ],
)
def test_a_number_without_measure_is_refused_without_a_line_of_numpys(tmp_path: Path, kind: str, before: str, after: str) -> None:
    file = tmp_path / f"coach.{kind}"
    assert before in TEXTS[kind]
    file.write_text(TEXTS[kind].replace(before, after))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with pytest.raises(UserError, match=r"coach\.(trc|bvh)"):
            read_motion(file)
    assert [str(one.message) for one in said] == []


def test_files_are_read_by_their_suffix_and_refused_by_their_names(tmp_path: Path) -> None:
    good = tmp_path / "clear.TRC"
    good.write_text(TEXTS["trc"])
    assert len(read_motion(good)) == 12
    for name, told in (("clear.fbx", "name a file that ends with .trc, .c3d, .bvh"), ("gone.bvh", "does not exist")):
        with pytest.raises(UserError, match=told):
            read_motion(tmp_path / name)
    (tmp_path / "folder.bvh").mkdir()
    with pytest.raises(UserError, match="cannot be read"):
        read_motion(tmp_path / "folder.bvh")


@pytest.mark.shared_data
def test_what_pose2sim_wrote_is_read() -> None:
    file = SHARED / "pose2sim_single/pose2sim_0.10.49_butterworth.trc"
    if not file.is_file():
        pytest.skip("the measurement data is not here")
    track = read_motion(file)
    assert len(track) == 99
    assert track.frame_s == pytest.approx(1 / 60)
    assert (track.states[:, coco.INDEX["left_eye"]] == JointState.UNKNOWN).all()
    standing = np.nanmean(track.joints_m[:, coco.INDEX["left_shoulder"], 2] - track.joints_m[:, coco.INDEX["left_ankle"], 2])
    assert 1.0 < standing < 1.6
