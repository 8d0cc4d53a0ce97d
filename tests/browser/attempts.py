"""Attempts for the page: true simulated motion, judged as the box judges it; and what the box says when it saw too little."""

from functools import cache

import msgspec
import numpy as np

from models.messages.feedback import Colour, Feedback, NameOrNone
from models.messages.motion import JointState
from models.motions.perform import perform
from models.motions.performance import Performance
from models.skeleton import coco
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import FoundAttempt
from services.evaluation.config import VOCABULARY, EvaluationConfig
from services.evaluation.track import known_track
from services.support.teaching_files import load_standards, load_teachings
from tests.pupils import pupil

_FRAME_S = 1 / 30
_SIGMA_M = 0.01
_NOW_S = 1000.0


@cache
def tried(action: str, fault: NameOrNone = "") -> Feedback:
    """What the box makes of an action that is performed well but for a fault, an empty name for none."""
    subject = pupil()
    motion = perform(Performance(action, faults={fault: 1.0} if fault else {}), subject)
    instants_s = np.arange(int(motion.duration_s / _FRAME_S)) * _FRAME_S
    joints_m = np.stack([subject.body.coco_m(motion.pose_at(float(t_s)))[: coco.COUNT] for t_s in instants_s])
    true = motion.attempts[0]
    end_s = min(true.end_s, float(instants_s[-1]))
    attempt = FoundAttempt(action, true.handed, (true.start_s, true.exertion_s, true.peak_s, end_s))
    moments = Moments(float(instants_s[-1]), round(_NOW_S * 1e9), epoch=0)
    config = EvaluationConfig(load_teachings(None, VOCABULARY), load_standards(None))
    return appraise(known_track(joints_m, _FRAME_S, _SIGMA_M), attempt, "chosen", moments, config)


def unseen(feedback: Feedback) -> Feedback:
    """The same attempt, seen by too few cameras to say anything of it."""
    return msgspec.structs.replace(
        feedback,
        score=None,
        score_sigma=None,
        praise="",
        cue="",
        cue_certainty=0.0,
        fine=False,
        judgements=tuple(msgspec.structs.replace(one, severity=None, sigma=None) for one in feedback.judgements),
        measures=tuple(msgspec.structs.replace(one, value=None, sigma=None, verdict="unknown") for one in feedback.measures),
        states=np.full_like(feedback.states, JointState.GUESSED),
        colours=np.full_like(feedback.colours, Colour.GREY),
    )


def ending(feedback: Feedback, ended_ns: int) -> Feedback:
    """The same attempt, ended at an instant of CLOCK_MONOTONIC."""
    later_ns = ended_ns - feedback.keyframes_ns[-1]
    start, exertion, peak, end = (t_ns + later_ns for t_ns in feedback.keyframes_ns)
    return msgspec.structs.replace(
        feedback,
        id=ended_ns // 1_000_000,
        keyframes_ns=(start, exertion, peak, end),
        t_first_ns=feedback.t_first_ns + later_ns,
        t_published_ns=ended_ns + 400_000_000,
    )
