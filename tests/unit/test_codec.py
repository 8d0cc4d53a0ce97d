"""The wire format: what is on the bus today must be readable tomorrow, and rubbish must be refused with a reason."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from models.messages import codec
from models.messages.attempts import AttemptsBegin, FeedbackRequest, RememberedFeedback
from models.messages.control import CropPrediction, ViewControl
from models.messages.feedback import ActivityRequest, Feedback, Judgement, MeasureResult
from models.messages.health import (
    CameraHealth,
    EvaluationHealth,
    FusionHealth,
    Health,
    MachineHealth,
    RecorderHealth,
    ReplayHealth,
    Restarts,
    SupervisorHealth,
)
from models.messages.lesson import Entry, FusionLog, LessonRequest, SegmentRequest
from models.messages.motion import CameraUse, Motion
from models.messages.observation import Crop, Observation, Person
from models.messages.pupil import PupilCorrection, PupilCorrections, PupilTurn
from models.messages.trouble import Trouble

GOLDEN = Path(__file__).parents[1] / "golden/codec"


def feedback() -> Feedback:
    """Three frames of a kick with something to correct."""
    ramp = np.arange(3 * 17, dtype=np.float32).reshape(3, 17)
    states = (np.arange(3 * 17).reshape(3, 17) % 3).astype(np.uint8)
    standard_m = np.stack((ramp / 8, -ramp / 16, ramp / 32), axis=2).astype(np.float32)
    standard_m[1, 4] = np.nan
    return Feedback(
        id=10**9 + 66,
        epoch=2,
        action="soccer_kick",
        by="recognised",
        handed="left",
        keyframes_ns=(10**15, 10**15 + 20_000_000, 10**15 + 40_000_000, 10**15 + 66_000_000),
        t_published_ns=10**15 + 500_000_000,
        score=71.5,
        score_sigma=6.25,
        praise="upright_trunk",
        cue="stiff_knee",
        cue_certainty=0.9375,
        judgements=(
            Judgement("stiff_knee", 0.875, 0.125),
            Judgement("upright_trunk", -0.25, 0.5),
            Judgement("short_step", None, None),
        ),
        measures=(
            MeasureResult("knee_flexion", 21.5, 4.5, "deg", "poor", low=60.0),
            MeasureResult("foot_speed", 9.25, 0.5, "m_s", "fair", low=8.0, high=14.0),
            MeasureResult("balance", None, None, "cm", "unknown"),
        ),
        shown=("foot_speed", "knee_flexion"),
        t_first_ns=10**15,
        frame_ns=33_333_333,
        joints_m=np.stack((ramp / 8, -ramp / 8, ramp / 16), axis=2).astype(np.float32),
        states=states,
        colours=np.where(states == 2, np.arange(3, dtype=np.uint8)[:, None] + 1, 0).astype(np.uint8),
        standard_m=standard_m,
    )


def feedback_of_nothing_wrong() -> Feedback:
    """The same kick as it should be."""
    told = feedback()
    measures = tuple(msgspec.structs.replace(one, verdict="fair") if one.verdict == "poor" else one for one in told.measures)
    judgements = tuple(Judgement(one.fault, -0.125, 0.25) for one in told.judgements)
    return msgspec.structs.replace(told, cue="", cue_certainty=0.0, judgements=judgements, measures=measures, fine=True)


def feedback_of_nothing() -> Feedback:
    """An attempt of which nothing could be judged."""
    nothing = np.zeros((5, 17), np.uint8)
    return Feedback(
        id=0, epoch=0, action="run", by="chosen", handed="right", keyframes_ns=(0, 1, 2, 4), t_published_ns=5, score=None,
        score_sigma=None, praise="", cue="", cue_certainty=0.0, judgements=(), measures=(), shown=(), t_first_ns=0, frame_ns=1,
        joints_m=np.zeros((5, 17, 3), np.float32), states=nothing, colours=nothing.copy(),
        standard_m=np.full((5, 17, 3), np.nan, np.float32),
    )  # fmt: skip


def examples() -> dict[str, codec.Message]:
    ramp = np.arange(17, dtype=np.float32)
    person = Person(
        track=7,
        crop=Crop(360.5, 640.25, 512.0, -0.125),
        keypoints_px=np.stack((10 * ramp, 20 * ramp + 0.5), axis=1),
        sigma_px=(1 + ramp / 8).astype(np.float32),
        score=(ramp / 16).astype(np.float32),
    )
    motion = Motion(
        kind="smooth",
        sequence=12,
        epoch=3,
        t_ns=10**15 + 1,
        t_newest_ns=10**15 + 2,
        t_published_ns=10**15 + 3,
        joints_m=np.stack((ramp / 10, -ramp / 10, ramp / 16), axis=1),
        covariance_m2=np.broadcast_to(np.eye(3, dtype=np.float32) * 1e-4, (17, 3, 3)).copy(),
        states=(np.arange(17) % 3).astype(np.uint8),
        views=(np.arange(17) % 16).astype(np.uint32),
        cameras=(CameraUse("cam01", True, 33.5), CameraUse("cam02", False, 0.0)),
    )
    troubles = Trouble("camera_dark", "slow", "look"), Trouble("plans_refused", "2 plans")
    return {
        "observation": Observation("cam01", 2, 41, 17, 10**15, 10**15 + 5, "thunder", (person,)),
        "observation_nobody": Observation("cam-2", 0, 0, 0, 1, 2, "lightning", ()),
        "motion": motion,
        "control": ViewControl("cam01", 5, 10**15, 10.0, 25_000_000, "thunder", False, CropPrediction(person.crop, 9, 1.5, -2.5)),
        "control_search": ViewControl("cam01", 6, 10**15, 5.0, 0, "lightning", True, None),
        "health": Health(
            "edge-cam01", 4711, 10**15, "degraded", troubles, 0.25, 210.5,
            camera=CameraHealth("cam01", 30.0, 9.9, 10.0, 4, 12.5, "thunder", {"decode": 4.5, "pose": 24.0}),
            fusion=FusionHealth(30.0, 1.25, 0.8, 3, {"cam02": 7}, "found"),
        ),
        "health_recorder": Health(
            "recorder", 4712, 10**15, "ok", (), 0.01, 60.5,
            recorder=RecorderHealth("2026-11-22-7b", "7b", 61.5, 2_250_000, 1),
            machine=MachineHealth(1.5, 2.0, 900.0, 12_000.0, None, 10**18, -250.0),
        ),
        "health_replay": Health(
            "replay", 4713, 10**15, "ok", (), 0.01, 60.5,
            replay=ReplayHealth(61.5, 2700.0, 0.5),
        ),
        "health_supervisor": Health(
            "supervisor", 4714, 10**15, "failed", (Trouble("given_up", "edge-cam01 is given up"),), 0.01, 20.5,
            machine=MachineHealth(1.5, 2.0, 900.0, 12_000.0, 61.5, 10**18, 0.0, throttled=True),
            supervisor=SupervisorHealth(
                "0.1.0", 10**14, (Restarts("edge-cam01", 5, 10**15, "hung", "ended 6 times"),)
            ),
        ),
        "health_evaluation": Health(
            "evaluation", 4715, 10**15, "ok", (), 0.05, 160.5,
            evaluation=EvaluationHealth("long_jump", "tablet", "moving", 7, 0.25, 31.5, 0, 1),
        ),
        "feedback": feedback(),
        "feedback_unknown": feedback_of_nothing(),
        "activity_request": ActivityRequest("soccer_kick"),
        "activity_request_any": ActivityRequest(""),
        "feedback_fine": feedback_of_nothing_wrong(),
        "feedback_keyframes_unseen": msgspec.structs.replace(feedback(), keyframes_unseen=("exertion", "peak")),
        "feedback_of_a_pupil": msgspec.structs.replace(feedback_of_nothing(), pupil="B12"),
        "health_evaluation_pupil": Health(
            "evaluation", 4715, 10**15, "ok", (), 0.05, 160.5,
            evaluation=EvaluationHealth("long_jump", "tablet", "moving", 7, 0.25, 31.5, 0, 1, "7", 10**15 - 9),
        ),
        "pupil_turn": PupilTurn("B12", 10**15),
        "pupil_turn_nobody": PupilTurn("", 10**15),
        "pupil_corrections": PupilCorrections((PupilCorrection(10**9, "7"), PupilCorrection(10**9 + 1, ""))),
        "health_recorder_attempts": Health(
            "recorder", 4712, 10**15, "ok", (), 0.01, 60.5,
            recorder=RecorderHealth("2026-11-22-7b", "7b", 61.5, 2_250_000, 1, 10**15 - 7, 53, (10**9, 10**9 + 1)),
        ),
        "health_evaluation_list": Health(
            "evaluation", 4715, 10**15, "ok", (), 0.05, 160.5,
            evaluation=EvaluationHealth(
                "long_jump", "tablet", "moving", 7, 0.25, 31.5, 0, 1, "7", 10**15 - 9, 10**15 - 11, 53, 10**9
            ),
        ),
        "attempts_begin": AttemptsBegin(10**15, 53, 10**9),
        "feedback_request": FeedbackRequest(10**9),
        "remembered_feedback": RememberedFeedback(feedback(), 49),
        "remembered_feedback_none": RememberedFeedback(None, 0),
        "fusion_log": FusionLog(10**15, 3, (Entry("observation", 10**15 + 7, b"\x01\x01"), Entry("tick", 10**15 + 8, b""))),
        "segment_request": SegmentRequest(10**15),
        "lesson_request": LessonRequest("start", "7b, throwing"),
        "lesson_request_named": LessonRequest("start", "7b, throwing", 10**15),
        "lesson_request_of_one": LessonRequest("stop", lesson="2026-11-22-7b"),
        "health_recorder_asked": Health(
            "recorder", 4712, 10**15, "ok", (), 0.01, 60.5,
            recorder=RecorderHealth("2026-11-22-7b", "7b", 0.0, 2_250, 0, 10**15 - 7, asked_ns=10**15 - 9),
        ),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("state", "troubles"), [("ok", [{"code": "hot", "words": "too hot"}]), ("degraded", []), ("failed", []), ("starting", [])]
)
def test_a_state_that_its_troubles_do_not_explain_is_refused(state: str, troubles: list[dict[str, str]]) -> None:
    good = examples()["health_replay"]
    fields = {name: getattr(good, name) for name in Health.__struct_fields__} | {"state": state, "troubles": troubles}
    with pytest.raises(codec.CodecError, match=f"state '{state}' with"):
        codec.decode(codec.encode(good)[:2] + codec._ENCODER.encode(fields), Health)


def equal(a: codec.Message, b: codec.Message) -> bool:
    return bool(codec.encode(a) == codec.encode(b))


@pytest.mark.parametrize("name", examples())
def test_a_message_written_by_an_earlier_version_is_still_read(name: str) -> None:
    message = examples()[name]
    stored = (GOLDEN / f"{name}.bin").read_bytes()
    assert equal(codec.decode(stored, type(message)), message)


@pytest.mark.parametrize("name", examples())
def test_the_bytes_of_this_version_have_not_changed_without_a_new_version(name: str) -> None:
    assert codec.encode(examples()[name]) == (GOLDEN / f"{name}.bin").read_bytes()


@pytest.mark.parametrize("name", examples())
def test_every_truncation_is_refused(name: str) -> None:
    message = examples()[name]
    data = codec.encode(message)
    for length in range(len(data)):
        with pytest.raises(codec.CodecError):
            codec.decode(data[:length], type(message))


def test_another_version_and_another_type_are_named() -> None:
    data = codec.encode(examples()["motion"])
    with pytest.raises(codec.CodecError, match="version 9"):
        codec.decode(b"\x09" + data[1:], Motion)
    with pytest.raises(codec.CodecError, match="a Motion where Observation belongs"):
        codec.decode(data, Observation)
    with pytest.raises(codec.CodecError, match="unknown type 200"):
        codec.decode(bytes((data[0], 200)) + data[2:], Motion)


@pytest.mark.parametrize(
    ("keypoints", "reason"),
    [
        (np.zeros((16, 2), np.float32), r"\(16, 2\)"),
        (np.zeros((17, 2), np.float64), "float64"),
        (np.full((17, 2), np.nan, np.float32), "not finite"),
    ],
)
def test_an_array_of_wrong_shape_dtype_or_value_is_refused_by_the_reader(keypoints: np.ndarray, reason: str) -> None:
    class Loose(msgspec.Struct):
        track: int
        crop: Crop
        keypoints_px: np.ndarray
        sigma_px: np.ndarray
        score: np.ndarray

    ones = np.ones(17, np.float32)
    good = examples()["observation"]
    assert isinstance(good, Observation)
    fields = {name: getattr(good, name) for name in Observation.__struct_fields__}
    fields["persons"] = [Loose(1, Crop(0, 0, 1), keypoints, ones, ones)]
    data = codec.encode(good)[:2] + codec._ENCODER.encode(fields)
    with pytest.raises(codec.CodecError, match=reason):
        codec.decode(data, Observation)


@pytest.mark.parametrize("name", examples())
def test_what_a_stranger_nested_deeper_than_the_stack_ends_nobody_who_reads(name: str) -> None:
    """A field that this version does not know is skipped, and what is skipped may be nested."""
    message = examples()[name]
    fields = {each: getattr(message, each) for each in type(message).__struct_fields__}
    data = codec.encode(message)[:2] + codec._ENCODER.encode(fields | {"of_tomorrow": msgspec.Raw(b"\x91" * 20_000 + b"\xc0")})
    with pytest.raises(codec.CodecError, match="corrupt"):
        codec.decode(data, type(message))


def test_a_decoded_array_can_be_written_to() -> None:
    good = examples()["observation"]
    decoded = codec.decode(codec.encode(good), Observation)
    decoded.persons[0].keypoints_px[0, 0] = 5.0
    assert decoded.persons[0].keypoints_px[0, 0] == 5.0


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"rate_hz": float("nan")}, "rate_hz"),
        ({"rate_hz": -5.0}, "rate_hz"),
        ({"rate_hz": float("inf")}, "rate_hz"),
    ],
)
def test_a_plan_that_cannot_be_kept_is_refused_by_the_reader(change: dict[str, float], reason: str) -> None:
    good = examples()["control"]
    fields = {name: getattr(good, name) for name in ViewControl.__struct_fields__} | change
    with pytest.raises(codec.CodecError, match=reason):
        codec.decode(codec.encode(good)[:2] + codec._ENCODER.encode(fields), ViewControl)


@pytest.mark.parametrize("side_px", [float("nan"), float("inf"), 0.0, -3.0, 1e300])
def test_a_crop_that_is_no_region_is_refused_by_the_reader(side_px: float) -> None:
    good = examples()["control"]
    assert isinstance(good, ViewControl)
    assert good.prediction is not None
    crop = {"centre_x_px": 1.0, "centre_y_px": 2.0, "side_px": side_px, "angle_rad": 0.0}
    prediction = {"crop": crop, "t_ns": 9, "velocity_x_px_s": 0.0, "velocity_y_px_s": 0.0}
    fields = {name: getattr(good, name) for name in ViewControl.__struct_fields__} | {"prediction": prediction}
    with pytest.raises(codec.CodecError, match="crop"):
        codec.decode(codec.encode(good)[:2] + codec._ENCODER.encode(fields), ViewControl)


@pytest.mark.parametrize(
    "change",
    [
        {"side_px": 5e-324},
        {"side_px": 0.9},
        {"side_px": 6e5},
        {"centre_x_px": 1e6},
        {"centre_y_px": -1e6},
        {"velocity_x_px_s": 2e6},
        {"velocity_y_px_s": -1e308},
        {"velocity_y_px_s": float("nan")},
        {"centre_x_px": 5e5, "velocity_x_px_s": 9e5, "side_px": 1e5},
    ],
)
def test_a_place_at_which_nothing_can_be_observed_is_refused_by_the_reader(change: dict[str, float]) -> None:
    """Whoever looked there would make an observation that is none."""
    good = examples()["control"]
    assert isinstance(good, ViewControl)
    assert good.prediction is not None
    crop, prediction = msgspec.structs.asdict(good.prediction.crop), msgspec.structs.asdict(good.prediction)
    crop |= {name: value for name, value in change.items() if name in crop}
    prediction |= {name: value for name, value in change.items() if name in prediction} | {"crop": crop}
    with pytest.raises(codec.CodecError, match="prediction"):
        codec.decode(changed(good, prediction=prediction), ViewControl)


@pytest.mark.parametrize("value", [-5, 2**63])
@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("fusion_log", "segment_ns"),
        ("fusion_log", "sequence"),
        ("fusion_log", "t_ns"),
        ("segment_request", "t_ns"),
        ("lesson_request", "t_ns"),
    ],
)
def test_a_time_or_number_in_the_log_that_no_clock_gives_is_refused_by_the_reader(name: str, field: str, value: int) -> None:
    good = examples()[name]
    fields = {each: getattr(good, each) for each in type(good).__struct_fields__}
    fields |= {"entries": [("tick", value, b"")]} if (name, field) == ("fusion_log", "t_ns") else {field: value}
    with pytest.raises(codec.CodecError, match=field):
        codec.decode(codec.encode(good)[:2] + codec._ENCODER.encode(fields), type(good))


def changed(message: codec.Message, **changes: object) -> bytes:
    """A message with other values, unchecked."""
    fields = {name: getattr(message, name) for name in type(message).__struct_fields__} | changes
    return codec.encode(message)[:2] + codec._ENCODER.encode(fields)


GREEN = np.ones((3, 17), np.uint8)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"score": 100.5}, "score"),
        ({"score": float("nan")}, "score"),
        ({"score_sigma": None}, "without a sigma"),
        ({"score_sigma": -1.0}, "sigma"),
        ({"action": "../soccer"}, "action"),
        ({"action": ""}, "action"),
        ({"by": "guessed"}, "by"),
        ({"handed": "both"}, "handed"),
        ({"cue": "late_jump"}, "among the faults"),
        ({"praise": "stiff_knee"}, "cannot be good"),
        ({"cue": "", "cue_certainty": 0.5}, "cue_certainty"),
        ({"cue_certainty": float("nan")}, "cue_certainty"),
        ({"shown": ["height"]}, "shown"),
        ({"shown": ["balance", "balance"]}, "twice"),
        ({"shown": ["balance", "foot_speed", "knee_flexion", "balance"]}, "shown"),
        ({"measures": [MeasureResult("balance", 1.0, 1.0, "cm", "good")] * 2, "shown": []}, "twice"),
        ({"keyframes_ns": (10**15, 10**15 + 2, 10**15 + 2, 10**15 + 3)}, "follow one another"),
        ({"keyframes_ns": (10**15, 10**15 + 1, 10**15 + 2, 10**15 + 90_000_000)}, "keyframes_ns must be within"),
        ({"keyframes_ns": (10**15 - 1, 10**15 + 1, 10**15 + 2, 10**15 + 3)}, "keyframes_ns must be within"),
        ({"keyframes_unseen": ["peak", "peak"]}, "keyframes_unseen names something twice"),
        ({"keyframes_unseen": ["top"]}, "keyframes_unseen"),
        ({"t_first_ns": 2**63 - 1}, "last frame"),
        ({"frame_ns": 0}, "frames"),
        ({"id": -1}, "id"),
        ({"joints_m": np.zeros((2, 17, 3), np.float32)}, "joints_m"),
        ({"joints_m": np.full((3, 17, 3), np.nan, np.float32)}, "joints_m"),
        ({"states": np.zeros((0, 17), np.uint8)}, "frames"),
        ({"states": np.full((3, 17), 3, np.uint8)}, "states"),
        ({"colours": np.full((3, 17), 4, np.uint8)}, "colours"),
        ({"colours": GREEN, "states": GREEN}, "grey"),
        ({"standard_m": np.full((3, 17, 3), np.inf, np.float32)}, "standard_m"),
        ({"standard_m": np.zeros((3, 17, 3))}, "standard_m"),
        ({"standard_m": np.zeros((3, 17, 3), np.uint32)}, "standard_m"),
        ({"standard_m": np.zeros((), np.float32)}, "standard_m"),
    ],
)
def test_feedback_that_cannot_be_is_refused_by_the_reader(changes: dict[str, object], reason: str) -> None:
    with pytest.raises(codec.CodecError, match=reason):
        codec.decode(changed(feedback(), **changes), Feedback)


@pytest.mark.parametrize(
    "changes",
    [
        {"cue": "stiff_knee", "cue_certainty": 0.9, "praise": ""},
        {"score": None, "score_sigma": None},
        {"judgements": [Judgement("stiff_knee", 0.0, 0.1), Judgement("upright_trunk", None, None)]},
        {"measures": [MeasureResult("foot_speed", 1.0, 0.5, "m_s", "poor", low=8.0)], "shown": ["foot_speed"]},
    ],
)
def test_fine_is_refused_beside_what_speaks_against_it(changes: dict[str, object]) -> None:
    with pytest.raises(codec.CodecError, match="fine is only what was judged as a whole"):
        codec.decode(changed(feedback_of_nothing_wrong(), **changes), Feedback)


def test_a_poor_measure_that_nobody_is_shown_speaks_against_nothing() -> None:
    poor = MeasureResult("foot_speed", 1.0, 0.5, "m_s", "poor", low=8.0)
    changes: dict[str, object] = {"measures": [poor], "shown": []}
    assert codec.decode(changed(feedback_of_nothing_wrong(), **changes), Feedback).fine


def test_what_silence_means_and_that_nobody_approves_of_lessons_from_before_it_was_said() -> None:
    """What is not said of a lesson is not taken for praise: whether its faults were all judged nobody has asked then."""
    assert feedback().silence is None
    assert feedback_of_nothing_wrong().silence == "fine"
    assert feedback_of_nothing().silence == "unseen"
    before = msgspec.msgpack.decode(codec.encode(feedback_of_nothing_wrong())[2:])
    assert before.pop("fine") is True
    read = codec.decode(codec.encode(feedback())[:2] + msgspec.msgpack.encode(before), Feedback)
    assert (read.fine, read.silence) == (False, "unsure")


def test_no_measure_without_a_value_has_a_verdict() -> None:
    with pytest.raises(ValueError, match="verdict good"):
        MeasureResult("balance", None, None, "cm", "good")
    with pytest.raises(ValueError, match="exchanged"):
        MeasureResult("balance", 1.0, 0.1, "cm", "good", low=2.0, high=1.0)


@pytest.mark.parametrize("activity", ["Soccer", "soccer kick", "x" * 49, "a\n", None, 3])
def test_an_activity_that_is_no_name_is_refused_by_the_reader(activity: object) -> None:
    with pytest.raises(codec.CodecError, match="activity"):
        codec.decode(changed(ActivityRequest(""), activity=activity), ActivityRequest)


@pytest.mark.parametrize("name", ["feedback_of_a_pupil", "pupil_turn"])
@pytest.mark.parametrize("pupil", ["Anna", "ANNA", "-7", "7 B", "123456789", "7\n", None, 7])
def test_a_pupil_who_is_no_code_is_refused_by_the_reader(name: str, pupil: object) -> None:
    message = examples()[name]
    with pytest.raises(codec.CodecError, match="pupil"):
        codec.decode(changed(message, pupil=pupil), type(message))


def test_lessons_from_before_unseen_keyframes_were_told_are_read_as_they_are() -> None:
    assert b"unseen" not in codec.encode(feedback())
    assert codec.decode(codec.encode(feedback()), Feedback).keyframes_unseen == ()


def test_whose_an_attempt_was_is_left_out_where_nobody_was_named() -> None:
    """So that lessons from before there were codes are read as they are."""
    assert b"pupil" not in codec.encode(feedback())
    assert codec.decode(codec.encode(feedback()), Feedback).pupil == ""
