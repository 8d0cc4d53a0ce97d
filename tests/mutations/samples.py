"""Valid messages of every topic of a small room and of its tablets: of them mutants are made, and they must be understood later."""

import time
from typing import Literal

import numpy as np

from models.messages import codec, topics
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
    Restarts,
    SupervisorHealth,
)
from models.messages.lesson import Entry, FusionLog, LessonRequest, SegmentRequest
from models.messages.motion import CameraUse, JointState, Motion
from models.messages.observation import Crop, Observation, Person
from models.messages.pupil import NOBODY, PupilCorrection, PupilCorrections, PupilTurn
from models.messages.trouble import Trouble
from models.skeleton import coco
from services.tablet.messages import Ack, Anew, Choose, Correction, Ping, Turn, Wish
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person as Pupil

RIG = ring_rig(4)
JOINTS_M = Pupil().joints(1.0)
KINDS: tuple[Literal["live", "smooth"], ...] = ("live", "smooth")


def observation(index: int, t_ns: int, sequence: int = 0, epoch: int = 0) -> Observation:
    """The pupil as camera `index` sees him."""
    camera = RIG.cameras[index]
    pixels = camera.project(JOINTS_M).astype(np.float32)
    persons = tuple(
        Person(
            track, Crop(640.0, 360.0, 400.0), pixels + 80 * (track - 1), np.full(17, 2, np.float32), np.full(17, 0.9, np.float32)
        )
        for track in (1, 2)
    )
    return Observation(camera.name, epoch, sequence, sequence, t_ns, t_ns, "thunder", persons)


def motion(t_ns: int, sequence: int = 0, kind: Literal["live", "smooth"] = "live") -> Motion:
    """The pupil, seen by all."""
    return Motion(
        kind=kind,
        sequence=sequence,
        epoch=0,
        t_ns=t_ns,
        t_newest_ns=t_ns,
        t_published_ns=t_ns,
        joints_m=JOINTS_M.astype(np.float32),
        covariance_m2=np.tile(np.eye(3, dtype=np.float32) * np.float32(1e-4), (coco.COUNT, 1, 1)),
        states=np.full(coco.COUNT, JointState.SEEN, np.uint8),
        views=np.full(coco.COUNT, 15, np.uint32),
        cameras=tuple(CameraUse(name, True, 40.0) for name in RIG.names),
    )


def control(t_ns: int, camera: str = RIG.names[0]) -> ViewControl:
    """A plan of fusion's."""
    prediction = CropPrediction(Crop(640.0, 360.0, 400.0), t_ns, 1.0, -1.0)
    return ViewControl(camera, 5, t_ns, 10.0, 25_000_000, "thunder", False, prediction)


def healths(t_ns: int) -> dict[str, Health]:
    """A word of every process, by its name."""
    camera = CameraHealth(RIG.names[0], 30.0, 10.0, 10.0, 0, 5.0, "thunder", {"pose": 24.0, "decode": 4.0})
    machine = MachineHealth(1.2, 2.0, 4000.0, 9000.0, 55.0, 10**18, 0.0)
    evaluation = EvaluationHealth("long_jump", "tablet", "moving", 3, 0.2, 30.0, 0, 0, "B12", t_ns, 1, 3, t_ns // 10**6)
    recorder = RecorderHealth("2026", "a", 3.0, 1_000_000, 0, t_ns - 10**9, 2, (t_ns // 10**6 - 9000, t_ns // 10**6 - 500))
    mending = Trouble("restarting", "tablet hung and is started again")
    restarts = (Restarts("tablet", 1, t_ns, "hung", ""),)
    return {
        f"edge-{RIG.names[0]}": Health(f"edge-{RIG.names[0]}", 1, t_ns, "ok", (), 0.3, 200.0, camera=camera),
        "fusion": Health("fusion", 2, t_ns, "ok", (), 0.2, 150.0, fusion=FusionHealth(30.0, 1.2, 0.8, 0, {}, "found")),
        "supervisor": Health(
            "supervisor",
            3,
            t_ns,
            "degraded",
            (mending,),
            0.01,
            30.0,
            machine=machine,
            supervisor=SupervisorHealth("0.1", t_ns, restarts),
        ),
        "evaluation": Health("evaluation", 5, t_ns, "ok", (), 0.1, 160.0, evaluation=evaluation),
        "recorder": Health("recorder", 4, t_ns, "ok", (), 0.01, 60.0, recorder=recorder),
    }


def feedback(t_ns: int) -> Feedback:
    """A shot of ten frames that ended now, with something to correct."""
    frames, frame_ns = 10, 33_333_333
    first_ns = t_ns - frames * frame_ns
    keyframes_ns = (first_ns, first_ns + 3 * frame_ns, first_ns + 6 * frame_ns, first_ns + 9 * frame_ns)
    joints_m = np.tile(JOINTS_M.astype(np.float32), (frames, 1, 1))
    return Feedback(
        id=keyframes_ns[-1] // 1_000_000,
        epoch=0,
        action="basketball_shot",
        by="recognised",
        handed="right",
        keyframes_ns=keyframes_ns,
        t_published_ns=t_ns,
        score=70.0,
        score_sigma=5.0,
        praise="elbow_out",
        cue="no_knee_bend",
        cue_certainty=0.97,
        judgements=(Judgement("no_knee_bend", 0.9, 0.1), Judgement("elbow_out", 0.1, 0.1), Judgement("flat_shot", None, None)),
        measures=(
            MeasureResult("knee_flexion", 25.0, 4.0, "deg", "poor", low=60.0),
            MeasureResult("balance", None, None, "cm", "unknown"),
        ),
        shown=("knee_flexion", "balance"),
        t_first_ns=first_ns,
        frame_ns=frame_ns,
        joints_m=joints_m,
        states=np.full((frames, coco.COUNT), JointState.SEEN, np.uint8),
        colours=np.full((frames, coco.COUNT), 2, np.uint8),
        standard_m=joints_m + np.float32(0.1),
    )


def log(t_ns: int, sequence: int = 0, segment_ns: int = 1) -> FusionLog:
    """What fusion took in and gave out."""
    entries = (
        Entry("observation", t_ns, codec.encode(observation(0, t_ns))),
        Entry("tick", t_ns, b""),
        Entry("motion", t_ns, codec.encode(motion(t_ns))),
        Entry("health", t_ns, codec.encode(healths(t_ns)["fusion"])),
    )
    return FusionLog(segment_ns, sequence, entries)


def by_topic() -> dict[str, list[bytes]]:
    """Valid messages, encoded, by the topic that they belong to, as of now."""
    t_ns = time.monotonic_ns()
    found = {topics.observation(name): [codec.encode(observation(i, t_ns))] for i, name in enumerate(RIG.names)}
    found |= {topics.motion(kind): [codec.encode(motion(t_ns, kind=kind))] for kind in KINDS}
    found[topics.control(RIG.names[0])] = [codec.encode(control(t_ns))]
    found |= {topics.health(name): [codec.encode(health)] for name, health in healths(t_ns).items()}
    found |= {topics.beat(name): [b"4711", b"1"] for name in ("fusion", "tablet")}
    found[topics.fusion_log()] = [codec.encode(log(t_ns))]
    found[topics.segment_request()] = [codec.encode(SegmentRequest(t_ns))]
    found[topics.lesson_request()] = [codec.encode(LessonRequest("start", "a lesson", t_ns)), codec.encode(LessonRequest("stop"))]
    found[topics.feedback()] = [codec.encode(feedback(t_ns))]
    found[topics.activity_request()] = [codec.encode(ActivityRequest("long_jump")), codec.encode(ActivityRequest(""))]
    found[topics.pupil_turn()] = [codec.encode(PupilTurn("B12", t_ns)), codec.encode(PupilTurn(NOBODY, t_ns))]
    found[topics.pupil_corrections()] = [codec.encode(PupilCorrections((PupilCorrection(feedback(t_ns).id, "7"),)))]
    found[topics.attempts_begin()] = [codec.encode(AttemptsBegin(t_ns, 3, feedback(t_ns).id))]
    found[topics.feedback_request()] = [codec.encode(FeedbackRequest(feedback(t_ns).id))]
    found[topics.remembered_feedback()] = [
        codec.encode(RememberedFeedback(feedback(t_ns), 2)),
        codec.encode(RememberedFeedback(None, 0)),
    ]
    return found


CLIENT_MESSAGES: tuple[Ack | Ping | Wish, ...] = (
    Ack(type="ack", motions=1, statuses=1),
    Ping(type="ping", id=7),
    Choose(type="choose", activity="long_jump"),
    Turn(type="turn", pupil="7"),
    Correction(type="correction", attempt=1, pupil="7"),
    Anew(type="anew"),
)
"""What a page sends to the box, of every kind."""
