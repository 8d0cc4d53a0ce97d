"""`kinebox standard import` of files of other programs and other schools: what counts afterwards, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.messages.feedback import Colour
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.standard import FRAME_S, Exemplar, Standard, encode
from services.cli.new_standards import Import, bring_in
from services.cli.standards import restore
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.config import EvaluationConfig
from services.evaluation.resampling import resampled
from services.evaluation.search import attempts_in
from services.evaluation.track import known_track
from services.support.own_standards import OwnStandards
from tests.demonstrations import hidden, shown
from tests.integration.school import counting, file_of, import_refused
from tests.taught import shipped

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("kind", "handed", "rate_hz"), [("trc", "right", 30.0), ("trc", "left", 59.94), ("c3d", "left", 100.0), ("bvh", "left", 50.0)]
)
def test_a_file_of_another_program_becomes_the_standard(
    tmp_path: Path, kind: str, handed: Handed, rate_hz: float, capsys: pytest.CaptureFixture[str]
) -> None:
    track, true = shown("badminton_clear", handed)
    file = file_of(tmp_path / "files", kind, resampled(track, 1 / rate_hz), "anna_schmidt")
    bring_in(file, tmp_path, None, Import("badminton_clear"))
    standard = counting(tmp_path)
    np.testing.assert_allclose(np.diff(standard.moments_s), np.diff(true.moments_s), atol=0.15)
    assert standard.origin.startswith(f"imported from a {kind.upper()} file on 20")
    assert "anna" not in standard.origin, "it goes wherever the standard goes"
    assert standard.stature_m == pytest.approx(1.56, abs=0.08)
    peak = round(standard.moments_s[2] / FRAME_S)
    assert standard.joints_m[peak, 10, 2] > standard.joints_m[peak, 9, 2] + 0.3
    assert ("its left side led" in capsys.readouterr().out) == (handed == "left")
    copy, _ = shown("badminton_clear", handed)
    config = EvaluationConfig({"badminton_clear": shipped().teachings["badminton_clear"]}, {"badminton_clear": standard})
    (found,) = attempts_in(copy, standard)
    colours = appraise(copy, found, "chosen", Moments(float(copy.t_s[-1]), 10**12, 0), config).colours
    assert (colours == Colour.GREEN).mean() > 0.95


def test_keyframes_that_are_given_are_those_of_the_standard(tmp_path: Path) -> None:
    track, true = shown("soccer_kick", "left")
    file = file_of(tmp_path / "files", "c3d", track)
    start, exertion, peak, end = (round(moment_s + 0.05, 2) for moment_s in true.moments_s)
    bring_in(file, tmp_path, None, Import("soccer_kick", None, (start, exertion, peak, end)))
    standard = counting(tmp_path, "soccer_kick")
    np.testing.assert_allclose(np.diff(standard.moments_s), np.diff((start, exertion, peak, end)), atol=1e-6)
    last = round(standard.moments_s[2] / FRAME_S)
    assert standard.joints_m[last, 16, 0] > standard.joints_m[last, 15, 0], "the right foot kicks"


def test_files_that_hold_no_standard_are_refused_with_what_to_do(tmp_path: Path) -> None:
    track, true = shown("squat")
    file = file_of(tmp_path, "c3d", track)
    told = import_refused(tmp_path, file, Import("badminton_clear"))
    assert told.startswith(f"no badminton_clear is found in {file}; correct --action, or give its keyframes: --start")
    assert "there is no action 'handstand'" in import_refused(tmp_path, file, Import("handstand"))
    twice = known_track(np.concatenate([track.joints_m, track.joints_m]), FRAME_S)
    both = file_of(tmp_path, "c3d", twice, "both")
    told = import_refused(tmp_path, both, Import("squat"))
    assert "holds 2 attempts (" in told
    assert told.endswith("choose one with --attempt")
    assert "has no attempt 3; it has 1-2" in import_refused(tmp_path, both, Import("squat", 3))
    slow = file_of(tmp_path, "c3d", resampled(track, 0.1), "slow")
    assert "has 10 frames a second; a standard needs 20" in import_refused(tmp_path, slow, Import("squat"))
    high = file_of(tmp_path, "c3d", known_track(track.joints_m + np.array((0, 0, 1.0)), FRAME_S), "high")
    told = import_refused(tmp_path, high, Import("squat", None, true.moments_s))
    assert "does not stand on the floor at height 0" in told
    unseen = file_of(tmp_path, "c3d", hidden(track, ("left_ankle",), *true.moments_s[1:3]), "unseen")
    told = import_refused(tmp_path, unseen, Import("squat"))
    assert told.endswith("too little of the left ankle from exertion to peak; correct the file, or take another performance")
    assert "--unit is for BVH files" in import_refused(tmp_path, file, Import("squat", unit="cm"))
    bones = file_of(tmp_path, "bvh", track)
    assert "correct --unit" in import_refused(tmp_path, bones, Import("squat", unit="mm"))
    text = tmp_path / "coach.trc"
    text.write_text("hello\n")
    assert "is no TRC file" in import_refused(tmp_path, text, Import("squat"))
    assert "does not exist" in import_refused(tmp_path, tmp_path / "gone.bvh", Import("squat"))


@pytest.mark.parametrize(
    ("moments", "attempt", "told"),
    [
        ((0.5, 1.0, None, 2.0), None, "keyframes are given with all of --start, --exertion, --peak and --end"),
        ((0.5, 1.0, 1.5, 2.0), 1, "and without --attempt"),
        ((0.5, 1.0, 0.9, 2.0), None, "follow one another within the 0 to"),
        ((0.5, 1.0, 1.5, 99.0), None, "follow one another within the 0 to"),
        ((-0.5, 1.0, 1.5, 2.0), None, "follow one another within the 0 to"),
        ((0.5, float("nan"), 1.5, 2.0), None, "follow one another within the 0 to"),
    ],
)
def test_keyframes_that_cannot_be_are_refused(
    tmp_path: Path, moments: tuple[float, float, float, float], attempt: int | None, told: str
) -> None:
    file = file_of(tmp_path, "c3d", shown("squat")[0])
    assert told in import_refused(tmp_path, file, Import("squat", attempt, moments))


def test_of_several_attempts_in_a_file_the_one_that_was_chosen_is_taken(tmp_path: Path) -> None:
    first, second = shown("squat"), shown("squat", tempo=0.75, seed=3)
    twice = known_track(np.concatenate([first[0].joints_m, second[0].joints_m]), FRAME_S)
    bring_in(file_of(tmp_path, "trc", twice), tmp_path, None, Import("squat", 2))
    np.testing.assert_allclose(np.diff(counting(tmp_path, "squat").moments_s), np.diff(second[1].moments_s), atol=0.15)


def test_a_standard_of_another_school_gets_a_number_of_its_own_and_is_otherwise_as_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    squat = replace(shipped().standards["squat"], stature_m=1.3)
    (tmp_path / "ours").mkdir()
    theirs, ours = OwnStandards(tmp_path / "theirs"), OwnStandards(tmp_path / "ours/school")
    theirs.put(replace(squat, origin="of another school"))
    for origin in ("a", "b"):
        ours.put(replace(squat, origin=origin))
    bring_in(theirs.file("squat"), tmp_path / "ours", None, Import("squat"))
    out = capsys.readouterr().out.splitlines()
    assert out[0] == f"squat: version 4 counts now, made of {theirs.file('squat')}"
    assert out[3] == f"bring back what counted before (b): kinebox standard restore squat 3 --data {tmp_path / 'ours'}"
    there, here = theirs.counts("squat"), counting(tmp_path / "ours", "squat")
    assert (here.version, here.origin, here.stature_m) == (4, there.origin, there.stature_m)
    assert encode(replace(here, version=there.version)) == encode(there)
    restore("squat", "2", tmp_path / "ours", None)
    assert counting(tmp_path / "ours", "squat").origin == "a"


def test_a_file_that_is_no_standard_of_that_action_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "squat.npz"
    file.write_bytes(encode(shipped().standards["squat"]))
    assert import_refused(tmp_path, file, Import("run")) == f"{file} is a standard of 'squat'; correct --action"
    assert "there is no action 'handstand'" in import_refused(tmp_path, file, Import("handstand"))
    for order in (Import("squat", 1), Import("squat", None, (0.5, 1.0, 1.5, 2.0)), Import("squat", unit="m")):
        assert import_refused(tmp_path, file, order).endswith("leave out all options but --action")
    file.write_bytes(b"damaged")
    assert f"{file}: is no standard's file, or is damaged" in import_refused(tmp_path, file, Import("squat"))
    assert "standard gone.npz does not exist" in import_refused(tmp_path, Path("gone.npz"), Import("squat"))


def without(standard: Standard, joint: str) -> Exemplar:
    """Its performance, of which nobody ever saw a joint."""
    joints = standard.joints_m.copy()
    joints[:, coco.INDEX[joint]] = np.nan
    return Exemplar(joints, standard.moments_s)


def showing_nothing() -> dict[str, tuple[Exemplar, str]]:
    """What a file of another school may hold in the place of a performance, and why it can be none."""
    squat = shipped().standards["squat"]
    joints, moments_s = squat.joints_m, squat.moments_s
    raised = joints + np.array((0.0, 0.0, 1.0))
    jump = np.stack([joints[0], joints[round(moments_s[2] / FRAME_S)]])
    return {
        "nobody": (
            Exemplar(np.full_like(joints, np.nan), moments_s),
            "was not seen well enough: too little of the whole body from",
        ),
        "no left knee": (
            without(squat, "left_knee"),
            "was not seen well enough: too little of the left knee from start to exertion",
        ),
        "a point": (Exemplar(np.zeros_like(joints), moments_s), "hardly moves between its keyframes"),
        "a statue": (Exemplar(np.repeat(joints[:1], len(joints), axis=0), moments_s), "hardly moves between its keyframes"),
        "in the air": (Exemplar(raised, moments_s), "does not stand on the floor at height 0"),
        "two frames": (Exemplar(joints[:2], (0.0, 0.01, 0.02, 0.05)), "hardly moves between its keyframes"),
        "two frames that differ": (Exemplar(jump, (0.0, 0.01, 0.02, 0.05)), "is not like an attempt at anything"),
    }


@pytest.mark.parametrize("what", showing_nothing())
def test_a_standard_of_another_school_must_show_what_one_from_a_lesson_must(tmp_path: Path, what: str) -> None:
    performance, told = showing_nothing()[what]
    spread_m = np.full((len(performance.joints_m), coco.COUNT), np.nan)
    file = tmp_path / "squat.npz"
    file.write_bytes(encode(replace(shipped().standards["squat"], performance=performance, spread_m=spread_m)))
    line = import_refused(tmp_path, file, Import("squat"))
    assert line.startswith(str(file))
    assert told in line


def test_a_standard_of_another_school_whose_exemplars_show_nothing_is_refused(tmp_path: Path) -> None:
    squat = shipped().standards["squat"]
    file = tmp_path / "squat.npz"
    file.write_bytes(encode(replace(squat, exemplars=(without(squat, "left_knee"),))))
    assert "too little of the left knee" in import_refused(tmp_path, file, Import("squat"))


def test_every_standard_that_ships_can_be_taken_to_another_school(tmp_path: Path) -> None:
    for action, standard in shipped().standards.items():
        file = tmp_path / f"{action}.npz"
        file.write_bytes(encode(standard))
        bring_in(file, tmp_path, None, Import(action))
        assert counting(tmp_path, action).version == 2
