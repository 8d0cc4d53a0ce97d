"""A teaching lesson as the box has it: rendered pictures, the real networks at the live rate, fusion; beside it, what is true."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME
from edge.simulation.lesson.plan import Plan
from edge.simulation.rendering.render_lesson import folder_of
from edge.simulation.split import Split
from models.camera.rig import Rig
from models.messages.motion import Motion
from models.motions.motion import Attempt
from services.evaluation.track import Track, track_of
from services.fusion.pipeline import initial_state, step
from tests.bench.reconstruct.lesson import START_NS
from tests.bench.reconstruct.observed import CONFIG, RATE_HZ, Looking, Observed, observed
from tests.bench.reconstruct.rendered import render_all, rendered_lesson
from tests.bench.teaching.lessons import filmed_lesson


def films(split: Split, seeds: Sequence[int], data: Path) -> Iterator[tuple[Plan, Track, tuple[Attempt, ...]]]:
    """Every pupil's lesson, rendered and looked at if that was not done before: the plan, the smooth motion, the true attempts.

    Times count from the lesson's beginning. Attempts stand in the order of the plan's performances.

    Raises:
        UserError: there is no OpenGL, no room on the disk, or the networks are not installed.
    """
    plans = [filmed_lesson(split, seed) for seed in seeds]
    render_all(plans, data)
    for plan in plans:
        lesson = rendered_lesson(plan, data)
        consumed = observed(lesson, Looking(lesson.rig.names), data)
        attempts = read_attempts(folder_of(plan, data) / ATTEMPTS_NAME)[plan.pupils[0].name]
        smooth = [motion for motion in _motions(lesson.rig, consumed) if motion.kind == "smooth"]
        track = track_of([motion for motion in smooth if motion.epoch == smooth[-1].epoch], 1 / RATE_HZ)
        yield plan, Track(track.t_s - START_NS * 1e-9, track.joints_m, track.covariance_m2, track.states), attempts


def _motions(rig: Rig, consumed: Observed) -> Iterator[Motion]:
    state = initial_state(rig.select(consumed.looking.cameras))
    for event in consumed.events:
        state, output = step(state, event, CONFIG)
        yield from output.motions
