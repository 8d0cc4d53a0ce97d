"""Compiles every hot loop before the first attempt, by judging one that is known."""

from dataclasses import replace

from models.messages.feedback import ANY
from services.evaluation.appraisal import Moments, appraise
from services.evaluation.attempt import FoundAttempt
from services.evaluation.config import EvaluationConfig
from services.evaluation.keyframes import keyframes_of
from services.evaluation.pipeline import initial_state
from services.evaluation.track import known_track


def warm_up(config: EvaluationConfig) -> None:
    """Run every kernel once with the types that live data has. Seconds on a box's first start, milliseconds after."""
    action, standard = next(iter(config.standards.items()))
    # One action runs what all run, and to look for ten takes a second of preparation.
    one = replace(config, teachings={action: config.teachings[action]}, standards={action: standard}, activity=ANY)
    finder = initial_state(one).finder
    track = known_track(standard.joints_m, config.frame_s, 0.01)
    for joints_m, t_s in zip(track.joints_m, track.t_s.tolist(), strict=True):
        finder.push(joints_m, t_s)
    keyframes_of(track.joints_m, config.frame_s, (standard,), action)
    feedback = appraise(
        track, FoundAttempt(action, "left", standard.moments_s), "chosen", Moments(float(track.t_s[-1]), 10**12, 0), one
    )
    if not feedback.colours.any():
        raise AssertionError("the evaluation cannot compare a standard with itself")
