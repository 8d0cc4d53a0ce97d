"""Pupils who show how it is done: performances that no standard knows, and lessons in which they were recorded."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from models.messages import codec
from models.messages.feedback import Feedback
from models.messages.lesson import Entry, FusionLog
from models.messages.motion import JointState, Motion
from models.messages.pupil import NOBODY
from models.motions.motion import Handed
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.standpoint import Standpoint
from models.skeleton import coco
from models.teaching.standard import FRAME_S
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track, known_track
from services.lesson.lesson_file import LessonWriter
from tests.installed import ROOT
from tests.pupils import pupil
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header
from tests.taught import shipped

SITE = (ROOT / "deploy/sites/simulated/site.toml").read_text()
SIGMA_M = 0.008
WAIT = 30
"""Frames for which the pupil stands before and after."""
PLACE = Standpoint(1.5, -2.0, 2.1)


@cache
def shown(
    action: str, handed: Handed = "right", years: float = 13.0, tempo: float = 1.0, seed: int = 1
) -> tuple[Track, FoundAttempt]:
    """A mean pupil of this age performs an action without a fault, with the variation of life: true motion and keyframes."""
    subject = pupil(years)
    motion = PLACE.motion(perform(Performance(action, handed, tempo=tempo, skill=0.5, seed=seed), subject))
    times_s = np.arange(0, motion.duration_s, FRAME_S)
    joints = np.stack([subject.body.coco_m(motion.pose_at(float(t_s)))[: coco.COUNT] for t_s in times_s])
    waiting = np.concatenate([np.repeat(joints[:1], WAIT, axis=0), joints, np.repeat(joints[-1:], WAIT, axis=0)])
    (true,) = motion.attempts
    start, exertion, peak, end = (t_s + WAIT * FRAME_S for t_s in (true.start_s, true.exertion_s, true.peak_s, true.end_s))
    return known_track(waiting, FRAME_S, SIGMA_M), FoundAttempt(action, handed, (start, exertion, peak, end))


def hidden(track: Track, joints: Sequence[str], first_s: float, last_s: float) -> Track:
    """The same motion; nobody sees these joints from one instant to another."""
    frames = slice(round(track.frame_at(first_s)), round(track.frame_at(last_s)) + 1)
    states, places = track.states.copy(), [coco.INDEX[name] for name in joints]
    states[frames, places] = JointState.UNKNOWN
    known = (states != JointState.UNKNOWN)[..., None]
    return Track(
        track.t_s, np.where(known, track.joints_m, np.nan), np.where(known[..., None], track.covariance_m2, np.nan), states
    )


def recorded(
    folder: Path, track: Track, *attempts: FoundAttempt, site_toml: str = SITE, name: str = "lesson", pupil: str = NOBODY
) -> Path:
    """A lesson of this motion; attempts are what was told on the day, all of one pupil."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = LessonWriter.create(folder, name, replace(header(), site_toml=site_toml))
    entries = list(_log(track, [_told(track, attempt, pupil) for attempt in attempts]))
    for sequence, first in enumerate(range(0, len(entries), 60)):
        writer.append(FusionLog(BEGIN_NS, sequence, tuple(entries[first : first + 60])), "")
    return writer.finish()


def _told(track: Track, attempt: FoundAttempt, pupil: str) -> Feedback:
    last_s = float(track.t_s[-1])
    return appraise(track, attempt, "recognised", Moments(last_s, BEGIN_NS + round(last_s * SECOND_NS), 0), shipped(), pupil)


def smooth_motion(track: Track, frame: int) -> Motion:
    """A frame as fusion publishes it; time 0 is `BEGIN_NS`."""
    known = track.states[frame] != JointState.UNKNOWN
    t_ns = BEGIN_NS + round(float(track.t_s[frame]) * SECOND_NS)
    return Motion(
        kind="smooth",
        sequence=frame,
        epoch=0,
        t_ns=t_ns,
        t_newest_ns=t_ns,
        t_published_ns=t_ns,
        joints_m=np.where(known[:, None], track.joints_m[frame], 0).astype(np.float32),
        covariance_m2=np.where(known[:, None, None], track.covariance_m2[frame], 0).astype(np.float32),
        states=track.states[frame].astype(np.uint8),
        views=np.zeros(coco.COUNT, np.uint32),
        cameras=(),
    )


def _log(track: Track, feedbacks: Sequence[Feedback]) -> Iterator[Entry]:
    for frame in range(len(track.t_s)):
        motion = smooth_motion(track, frame)
        yield Entry("tick", motion.t_ns, b"")
        yield Entry("motion", motion.t_ns, codec.encode(motion))
    for feedback in feedbacks:
        yield Entry("feedback", feedback.t_published_ns, codec.encode(feedback))
