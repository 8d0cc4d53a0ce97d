"""A curve on paper: the pupil's angle, the band about the standard, keyframes marked."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.messages.feedback import Feedback
from models.teaching.schema import Language
from services.evaluation.report import svg
from services.evaluation.report.curve import Curve
from services.evaluation.report.hatching import hatched
from services.evaluation.report.numbers import number
from services.evaluation.report.svg import Point
from services.evaluation.report.words import ANGLES, Words

WIDTH_MM: Final = 66.0
HEIGHT_MM: Final = 36.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.5, 2.0, 4.6, 7.0
_APART_MM: Final = 2.4
_STEPS_DEG: Final = (5, 10, 15, 30, 45, 60, 90, 180)
_MOST_TICKS: Final = 5
_LEAST_RANGE_DEG: Final = 30.0
_HALF_TURN_DEG: Final = 180.0
_STEPS_S: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
_MOST_SECONDS: Final = 6


class _Plane:
    """From seconds and degrees to the paper."""

    def __init__(self, t_s: tuple[float, float], deg: tuple[float, float]) -> None:
        self.t_s, self.deg = t_s, deg

    def at(self, t_s: float, deg: float) -> Point:
        across = (t_s - self.t_s[0]) / (self.t_s[1] - self.t_s[0])
        up = (deg - self.deg[0]) / (self.deg[1] - self.deg[0])
        return _LEFT + across * (WIDTH_MM - _LEFT - _RIGHT), HEIGHT_MM - _BOTTOM - up * (HEIGHT_MM - _TOP - _BOTTOM)

    def points(self, t_s: Float, deg: Float) -> list[Point]:
        return [self.at(float(t), float(value)) for t, value in zip(t_s, deg, strict=True)]


def chart(curve: Curve, feedback: Feedback, label: str, words: Words) -> str:
    """The drawing.

    Args:
        curve: what is drawn.
        feedback: of the attempt.
        label: what it shows, for those who cannot see it.
        words: the page's language.
    """
    ticks = _ticks(curve)
    plane = _Plane((float(curve.t_s[0]), float(curve.t_s[-1])), (ticks[0], ticks[-1]))
    content = [
        *_gaps(curve, plane),
        *_band(curve, plane),
        *_axes(plane, ticks, words),
        *_marks(plane, [(t_ns - feedback.keyframes_ns[0]) * 1e-9 for t_ns in feedback.keyframes_ns]),
        *(svg.path(points, "pupil") for points in _runs(plane, curve.t_s, curve.pupil_deg)),
    ]
    return svg.drawing(WIDTH_MM, HEIGHT_MM, "".join(content), label)


def title_of(curve: Curve, language: Language, words: Words) -> str:
    """Which angle it is, of which limb."""
    name = ANGLES[curve.signal][language] if curve.signal in ANGLES else curve.signal.replace("_", " ")
    return f"{name} ({words.sides[curve.side]})" if curve.sided else name


def legend_of(curve: Curve, words: Words) -> str:
    """What its lines are, and how sure they are."""
    sigma, tolerance = (f"{number(value, 0, words)}°" for value in (max(curve.sigma_deg, 1.0), curve.tolerance_deg))
    told = [words.curve_sigma.format(sigma=sigma), words.band.format(tolerance=tolerance)]
    return " · ".join([*told, *([words.curve_gap] if np.isnan(curve.pupil_deg).any() else [])])


def _ticks(curve: Curve) -> list[float]:
    """Round numbers of degrees that hold all that is drawn."""
    values = np.concatenate([curve.pupil_deg, *curve.band_deg])
    values = values[np.isfinite(values)]
    low, high = float(values.min()), float(values.max())
    spare = max(_LEAST_RANGE_DEG - (high - low), 0) / 2
    low, high = low - spare, high + spare
    step = next((step for step in _STEPS_DEG if (high - low) / step <= _MOST_TICKS), _STEPS_DEG[-1])
    return [float(step * count) for count in range(int(np.floor(low / step)), int(np.ceil(high / step)) + 1)]


def _band(curve: Curve, plane: _Plane) -> Iterator[str]:
    low, high = curve.band_deg
    for run in _stretches(np.isfinite(curve.standard_deg)):
        below, above = (plane.points(curve.t_s[run], edge[run]) for edge in (low, high))
        yield svg.path([*above, *reversed(below)], "band", closed=True)
        yield svg.path(plane.points(curve.t_s[run], curve.standard_deg[run]), "model")


def _gaps(curve: Curve, plane: _Plane) -> Iterator[str]:
    """Hatched from the last frame that was seen to the next one."""
    half_s = float(curve.t_s[1] - curve.t_s[0]) if len(curve.t_s) > 1 else 0.0
    for run in _stretches(~np.isfinite(curve.pupil_deg)):
        first_s = max(float(curve.t_s[run.start]) - half_s, plane.t_s[0])
        last_s = min(float(curve.t_s[run.stop - 1]) + half_s, plane.t_s[1])
        (left, top), (right, bottom) = plane.at(first_s, plane.deg[1]), plane.at(last_s, plane.deg[0])
        yield svg.element("rect", x=left, y=top, width=right - left, height=bottom - top, class_="gap")
        yield hatched([(left, top), (right, top), (right, bottom), (left, bottom)], "lines")


def _runs(plane: _Plane, t_s: Float, deg: Float) -> Iterator[list[Point]]:
    """Of what was seen; a single frame is a dot. An angle that goes over half a turn from the model comes in again at the other
    edge (`Curve.pupil_deg`), and no line leads across."""
    for run in _stretches(np.isfinite(deg)):
        comes_in = 1 + np.flatnonzero(np.abs(np.diff(deg[run])) > _HALF_TURN_DEG)
        for part_s, part_deg in zip(np.split(t_s[run], comes_in), np.split(deg[run], comes_in), strict=True):
            points = plane.points(part_s, part_deg)
            yield points if len(points) > 1 else [points[0], (points[0][0] + 0.01, points[0][1])]


def _stretches(flags: Bool) -> Iterator[slice]:
    """Of consecutive frames where it holds."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    yield from (slice(int(first), int(end)) for first, end in zip(edges[::2], edges[1::2], strict=True))


def _axes(plane: _Plane, ticks: Sequence[float], words: Words) -> Iterator[str]:
    left, right = plane.t_s
    for tick in ticks:
        yield svg.line(plane.at(left, tick), plane.at(right, tick), "grid")
        x, y = plane.at(left, tick)
        yield svg.text((x - 1, y + 0.9), f"{number(tick, 0, words)}°", "tick", "end")
    step = next((step for step in _STEPS_S if (right - left) / step <= _MOST_SECONDS), _STEPS_S[-1])
    for count in range(int(np.ceil(left / step)), int(np.floor(right / step)) + 1):
        x, y = plane.at(count * step, ticks[0])
        yield svg.line((x, y), (x, y + 0.8), "axis")
        yield svg.text((x, y + 3.4), number(count * step, 0 if step >= 1 else 1, words), "tick", "middle")
    yield svg.line(plane.at(left, ticks[0]), plane.at(right, ticks[0]), "axis")
    yield svg.text((WIDTH_MM - _RIGHT, HEIGHT_MM - 0.6), words.seconds, "tick", "end")


def _marks(plane: _Plane, moments_s: Sequence[float]) -> Iterator[str]:
    """Keyframes; their numbers do not cover one another where they are close."""
    places = [plane.at(moment_s, plane.deg[1]) for moment_s in moments_s]
    for (x, top), (_, bottom) in zip(places, [plane.at(moment_s, plane.deg[0]) for moment_s in moments_s], strict=True):
        yield svg.line((x, top - 0.6), (x, bottom), "keyframe")
    labels = [x for x, _ in places]
    for place, (before, after) in enumerate(pairwise(labels)):
        labels[place + 1] = max(after, before + _APART_MM)
    for place, x in enumerate(labels):
        yield svg.text((x, places[place][1] - 1.2), str(place + 1), "mark", "middle")
