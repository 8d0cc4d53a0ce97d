"""Attempts for tests of reports: what ships is performed in the room, seen with noise and gaps, and judged."""

import datetime as dt
from functools import cache
from typing import Any

import msgspec
import numpy as np

from models.messages.feedback import Feedback
from models.messages.motion import JointState
from models.motions.motion import Handed
from models.skeleton import coco
from models.teaching.schema import Language
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.report.sheet import NOBODY, LessonFacts, Sheet, Tried, sheet_of
from services.evaluation.track import Track
from tests.taught import performance, shipped

NOISE_M = 0.004
BEGUN_NS = 10**12
BEGUN = dt.datetime(2026, 11, 20, 10, 5, 12, tzinfo=dt.timezone(dt.timedelta(hours=1)))
FACTS = LessonFacts("2026-11-20-7b", "7b, throwing", BEGUN, BEGUN_NS, 2712.4, "0.1.0", "recorded")


def attempt(
    action: str = "basketball_shot",
    *,
    handed: Handed = "right",
    after_s: float = 40.0,
    exemplar: int = 1,
    hidden: tuple[str, ...] = (),
    guessed: tuple[str, ...] = (),
    **told: Any,
) -> Feedback:
    """What is said of somebody who performs a shipped exemplar.

    Args:
        action: its name.
        handed: the side that leads.
        after_s: seconds since the lesson's begin when the recording of it ended.
        exemplar: which one; 0 is the standard.
        hidden: joints that nobody saw.
        guessed: joints that were guessed.
        told: fields of the feedback that shall be otherwise; of what is made up nobody approves, unless told.
    """
    made_up = {"fine": False} | told if told else {}
    changed: Feedback = msgspec.structs.replace(_attempt(action, handed, after_s, exemplar, hidden, guessed), **made_up)
    return changed


@cache
def _attempt(
    action: str, handed: Handed, after_s: float, exemplar: int, hidden: tuple[str, ...], guessed: tuple[str, ...]
) -> Feedback:
    track, found = performance(action, handed, exemplar)
    states = track.states.copy()
    states[:, [coco.INDEX[name] for name in guessed]] = JointState.GUESSED
    states[:, [coco.INDEX[name] for name in hidden]] = JointState.UNKNOWN
    known = (states != JointState.UNKNOWN)[..., None]
    noise = np.random.default_rng(exemplar).normal(0, NOISE_M, track.joints_m.shape)
    joints, covariance = np.where(known, track.joints_m + noise, np.nan), np.where(known[..., None], track.covariance_m2, np.nan)
    seen = Track(track.t_s, joints, covariance, states)
    moments = Moments(float(track.t_s[-1]), BEGUN_NS + round(after_s * 1e9), 0)
    return appraise(seen, found, "recognised", moments, shipped())


def sheet(*attempts: Feedback | tuple[Feedback, str], language: Language = "en", pupil: str | None = None) -> Sheet:
    """A report of attempts, each with the code of its pupil or of nobody."""
    tried = [Tried(*one) if isinstance(one, tuple) else Tried(one, NOBODY) for one in attempts]
    return sheet_of(FACTS, tried, shipped().teachings, language, pupil)
