"""One lesson looked at in one way: keypoints, fusion, figures."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

import numpy as np

from models.arrays import Float
from models.camera.rig import Rig
from services.fusion.config import FusionConfig
from tests.bench.metrics.position import position_error
from tests.bench.reconstruct.each_frame import frame_by_frame, looks_at_pupil
from tests.bench.reconstruct.figures import Judged, bound_mm, jitter_reduction_pct, judge, of_action, reprojection_rmse_px
from tests.bench.reconstruct.fused import Fused, fuse
from tests.bench.reconstruct.keypoints import Seen, by_frame, interpolated, pupil_seen
from tests.bench.reconstruct.lesson import Lesson
from tests.bench.reconstruct.observed import CONFIG, RATE_HZ, Looking, Observed, observed

UPRIGHT_MEAN: Final = "upright"


@dataclass(frozen=True, eq=False)
class Clip:
    """What a method that wants whole frames is given, and what ours made of it.

    Attributes:
        rig: the cameras that looked.
        points_px, scores: (frames, cameras, 17, 2) as observed and (frames, cameras, 17), at the instants `times_s`.
        times_s: (frames,)
        truth_m: (frames, 17, 3) at them.
        actions: (frames,) what is done then, empty between attempts.
        ours_m: (frames, 17, 3) our smooth joints.
    """

    rig: Rig
    points_px: Float
    scores: Float
    times_s: Float
    truth_m: Float
    actions: tuple[str, ...]
    ours_m: Float


@dataclass(frozen=True, eq=False)
class Measured:
    """What came out.

    Attributes:
        lesson, seed, pupil: of the lesson.
        way: name of the way of looking.
        smooth, live: figures by action, and by `UPRIGHT_MEAN` those of all upright actions' frames together.
        without_pose: by action, the instants (seconds) at which the smooth motion has no pose.
        further: figures of the whole lesson.
        commit: see `Observed`.
        clip: for methods that want whole frames.
    """

    lesson: str
    seed: int
    pupil: str
    way: str
    smooth: dict[str, dict[str, float]]
    live: dict[str, dict[str, float]]
    without_pose: dict[str, list[float]]
    further: dict[str, float]
    commit: str
    clip: Clip


@dataclass(frozen=True)
class Way:
    """A way of looking: name, how often, and how many cameras (the first ones of the rig; None is all)."""

    name: str
    rate_hz: float
    cameras: int | None = None
    config: FusionConfig = field(default=CONFIG)

    def looking(self, lesson: Lesson) -> Looking:
        """At a lesson."""
        return Looking(lesson.rig.names[: self.cameras], self.rate_hz)


def measure(lesson: Lesson, way: Way, upright: tuple[str, ...], data: Path, *, fresh: bool = False) -> Measured:
    """Look, fuse, judge."""
    return judged(lesson, way, upright, observed(lesson, way.looking(lesson), data, fresh=fresh))


def judged(lesson: Lesson, way: Way, upright: tuple[str, ...], seen: Observed) -> Measured:
    """Figures of what was observed."""
    rig = lesson.rig.select(seen.looking.cameras)
    fused = fuse(rig, seen.events, lesson.length_s, way.config)
    looks = pupil_seen(lesson, seen.looking.cameras, seen.events)
    smooth, live = (judge(lesson.spans, fused.times_s, joints, lesson.truth_m) for joints in (fused.smooth_m, fused.live_m))
    inferences = sum(len(look.numbers) for look in looks)
    further = {
        "reprojection_rmse_px": reprojection_rmse_px(rig, looks, Interpolated(fused)),
        "edge_ms_per_inference": 1e3 * seen.edge_cpu_s / inferences,
        "fusion_ms_per_frame": 1e3 * fused.cpu_s / len(fused.times_s),
    }
    every_frame = way.rate_hz >= RATE_HZ and _frames_are_instants(looks, fused)
    if every_frame:
        further |= _against_each_frame(rig, seen, fused, looks, lesson, upright)
    points, scores = (by_frame if every_frame else interpolated)(looks, len(fused.times_s))
    actions = tuple(lesson.action_at(float(t)) for t in fused.times_s)
    clip = Clip(rig, points, scores, fused.times_s, lesson.truth_m(fused.times_s), actions, fused.smooth_m)
    return Measured(
        lesson=lesson.name,
        seed=lesson.seed,
        pupil=lesson.pupil,
        way=way.name,
        smooth=_by_action(smooth, upright),
        live=_by_action(live, upright),
        without_pose=_without_pose(smooth),
        further=further,
        commit=seen.commit,
        clip=clip,
    )


def _by_action(judged: list[Judged], upright: tuple[str, ...]) -> dict[str, dict[str, float]]:
    actions = dict.fromkeys(each.action for each in judged)
    figures = {action: of_action([each for each in judged if each.action == action]) for action in actions}
    together = [each for each in judged if each.action in upright]
    return figures | ({UPRIGHT_MEAN: of_action(together)} if together else {})


def _without_pose(judged: list[Judged]) -> dict[str, list[float]]:
    found: dict[str, list[float]] = {}
    for each in judged:
        frames = position_error(each.found_m, each.truth_m).without_pose
        if frames:
            found.setdefault(each.action, []).extend(round(float(each.times_s[frame]), 3) for frame in frames)
    return found


def _against_each_frame(
    rig: Rig, seen: Observed, fused: Fused, looks: list[Seen], lesson: Lesson, upright: tuple[str, ...]
) -> dict[str, float]:
    """Jitter against the fit of each frame alone, of the same person, and the bound, over the upright actions."""
    spans = [span for span in lesson.spans if span.action in upright]
    of_pupil = looks_at_pupil(rig, seen.events, lesson.truth_m(fused.times_s))
    alone = frame_by_frame(rig, of_pupil, len(fused.times_s))
    smooth, raw = (judge(spans, fused.times_s, joints, lesson.truth_m) for joints in (fused.smooth_m, alone))
    if not smooth:
        return {}
    bounds = [bound_mm(rig, looks, each.times_s, each.truth_m) for each in smooth]
    return {
        "jitter_reduction_pct": jitter_reduction_pct(smooth, raw),
        "each_frame_mpjpe_mm": of_action(raw)["mpjpe_mm"],
        "crb_mm": float(np.nanmean(np.concatenate(bounds))),
    }


def _frames_are_instants(looks: list[Seen], fused: Fused) -> bool:
    """Whether the cameras expose at the output's instants, so that a frame's number is an instant's."""
    return (
        all(np.abs(look.times_s - look.numbers / RATE_HZ).max() < 1e-3 for look in looks if len(look.numbers))
        and len(fused.times_s) > 0
    )


@dataclass(frozen=True, eq=False)
class Interpolated:
    """Smooth joints between the output's instants, linear."""

    fused: Fused

    def __call__(self, times_s: Float) -> Float:
        place = times_s * RATE_HZ
        before = np.clip(np.floor(place).astype(int), 0, max(len(self.fused.times_s) - 2, 0))
        share = (place - before)[:, None, None]
        joints = (1 - share) * self.fused.smooth_m[before] + share * self.fused.smooth_m[before + 1]
        return np.where((share >= 0) & (share <= 1), joints, np.nan)
