"""Figures of an attempt at its four keyframes, the standard as a shadow behind each.

How far a joint is off is shown by colour and by pattern, so that it survives a black-and-white printer and eyes that tell no red
from green: plain, dots, stripes. What nobody can vouch for is hollow with a dashed edge, and what is not known is not drawn.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.messages.feedback import Colour, Feedback
from models.messages.motion import JointState
from models.skeleton import coco
from models.teaching.measure import PHASES
from services.evaluation.normalise import size_m
from services.evaluation.report import svg
from services.evaluation.report.body import HEAD_RADIUS, TRUNK_WIDTH, Capsule, Head, Limb, Trunk, parts_of
from services.evaluation.report.hatching import around, hatched
from services.evaluation.report.numbers import estimate
from services.evaluation.report.svg import Point
from services.evaluation.report.view import View, view_of
from services.evaluation.report.words import Words
from services.evaluation.uncertainty import NETWORK

WIDTH_MM: Final = 186.0
HEIGHT_MM: Final = 57.0
_FLOOR_MM: Final = 48.0
"""Where the floor is, from the top."""
_TOP_MM: Final = 1.5
_GAP_MM: Final = 1.5
_LARGEST: Final = 36.0
"""Millimetres a metre: nobody is drawn larger."""
_ARC: Final = 7
"""Corners of the round end of a limb."""
_USUAL_SIZE_M: Final = 1.1
"""From shoulder to ankle, of somebody whose limbs were not seen."""
_SINCE_SIGMA_S: Final = math.sqrt(2) * NETWORK.moment_s
"""Of the time from one keyframe to another: both are unsure."""
PAINT: Final = {Colour.GREEN: "good", Colour.YELLOW: "near", Colour.RED: "off", Colour.GREY: "unsure"}
"""Classes of the style sheet."""
_ON_TOP: Final = (Colour.GREEN, Colour.GREY, Colour.YELLOW, Colour.RED)
"""Of two, one behind the other, the later one is seen: paper cannot be turned, and hides nothing that was wrong or not sure."""

HATCHED: Final = {"near": "dots", "off": "stripes"}
"""What lies over the paint of these."""


def figures(feedback: Feedback, words: Words, label: str) -> str:
    """One drawing with the four figures.

    Args:
        feedback: of the attempt.
        words: the page's language.
        label: what it shows, for those who cannot see it.
    """
    pupil = np.where((feedback.states != JointState.UNKNOWN)[..., None], feedback.joints_m.astype(np.float64), np.nan)
    standard = feedback.standard_m.astype(np.float64)
    frames = [feedback.frame_of(t_ns) for t_ns in feedback.keyframes_ns]
    shown = standard if np.isfinite(standard).any() else pupil
    # With something to correct, from where the difference shows.
    view = view_of(shown[frames], feedback.handed, (pupil - standard)[frames[:-1]] if feedback.cue else None)
    size = next((one for one in map(size_m, (standard, pupil)) if one > 0), _USUAL_SIZE_M)
    scene = [_Moment(pupil[frame], standard[frame], view) for frame in frames]
    scale = _scale([moment.extent_m for moment in scene], size)
    panel_mm = WIDTH_MM / len(frames)
    drawn = []
    for place, (frame, moment) in enumerate(zip(frames, scene, strict=True)):
        pen = _Pen(view, scale, size, panel_mm * (place + 0.5), moment.middle_m)
        drawn.append(_panel(pen, panel_mm, feedback, frame, moment))
        drawn.append(_caption(pen.centre_mm, place, feedback, words))
    drawn.append(svg.text((WIDTH_MM, 3.0), words.seen_from[view.seen], "when", "end"))
    return svg.drawing(WIDTH_MM, HEIGHT_MM, "".join(drawn), label)


@dataclass(frozen=True, eq=False)
class _Moment:
    """(17, 3) each, NaN where unknown."""

    pupil_m: Float
    standard_m: Float
    view: View

    @property
    def _ends_m(self) -> Float:
        """(N, 2) all that is drawn, as it is seen."""
        seen = self.view.on_paper(np.concatenate((self.pupil_m, self.standard_m)))
        return np.asarray(seen[np.isfinite(seen).all(axis=1)])

    @property
    def known(self) -> bool:
        """Whether there is anything of the pupil to draw."""
        return bool(np.isfinite(self.pupil_m).all(axis=1).any())

    @property
    def middle_m(self) -> float:
        ends = self._ends_m
        return float(ends[:, 0].min() + ends[:, 0].max()) / 2 if len(ends) else 0.0

    @property
    def extent_m(self) -> tuple[float, float]:
        """How wide, and how high above the floor."""
        ends = self._ends_m
        return (float(np.ptp(ends[:, 0])), float(ends[:, 1].max())) if len(ends) else (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class _Pen:
    """Draws places in metres on one panel.

    Attributes:
        view, scale: millimetres a metre.
        size_m: from shoulder to ankle; widths are shares of it.
        centre_mm, middle_m: this place of the world is drawn there.
    """

    view: View
    scale: float
    size_m: float
    centre_mm: float
    middle_m: float

    def at(self, place_m: Float) -> Point:
        right, up = self.view.on_paper(place_m)
        return self.centre_mm + (float(right) - self.middle_m) * self.scale, _FLOOR_MM - float(up) * self.scale

    def wide(self, share: float) -> float:
        return share * self.size_m * self.scale


def _scale(extents: Sequence[tuple[float, float]], size_m: float) -> float:
    """The largest at which all figures have room; the same for all."""
    margin_m = 2 * HEAD_RADIUS * size_m
    wide = max(width for width, _ in extents) + margin_m
    high = max(height for _, height in extents) + margin_m
    return min((WIDTH_MM / len(extents) - 2 * _GAP_MM) / wide, (_FLOOR_MM - _TOP_MM) / high, _LARGEST)


def _panel(pen: _Pen, width_mm: float, feedback: Feedback, frame: int, moment: _Moment) -> str:
    left, right = pen.centre_mm - width_mm / 2 + _GAP_MM, pen.centre_mm + width_mm / 2 - _GAP_MM
    drawn = [svg.line((left, _FLOOR_MM), (right, _FLOOR_MM), "floor")]
    shadow = _sorted(moment.standard_m, np.zeros(coco.COUNT, np.uint8), pen)
    drawn += [stroke for part in shadow for stroke in _shadow(part, pen)]
    body = _sorted(moment.pupil_m, feedback.colours[frame], pen)
    drawn += [stroke for part in body for stroke in _painted(part, pen)]
    if not moment.known:
        drawn.append(svg.text((pen.centre_mm, _FLOOR_MM / 2), "?", "lost", "middle"))
    return "".join(drawn)


def _sorted(joints_m: Float, colours: "np.ndarray[tuple[int], np.dtype[np.uint8]]", pen: _Pen) -> list[Limb | Trunk | Head]:
    """The farthest first."""
    return sorted(parts_of(joints_m, colours), key=lambda part: float(pen.view.nearness_m(part.middle_m)))


def _painted(part: Limb | Trunk | Head, pen: _Pen) -> Iterator[str]:
    if isinstance(part, Limb):
        for half in part.halves:
            yield from _shape(_outline(half, pen), PAINT[half.colour])
    elif isinstance(part, Trunk):
        for corners, middle, colour in _trunk_pieces(part):
            hull = _rounded([pen.at(one) for one in corners], pen.wide(TRUNK_WIDTH) / 2, [pen.at(one) for one in middle])
            yield from _shape(hull, PAINT[colour], closed=True)
    else:
        yield from _head(part, pen, PAINT[part.colour])


def _shape(corners: list[Point], paint: str, *, closed: bool = False) -> Iterator[str]:
    yield svg.path(corners, f"{paint} edge", closed=closed)
    if paint in HATCHED:
        yield hatched(corners, HATCHED[paint])


def _head(head: Head, pen: _Pen, paint: str) -> Iterator[str]:
    x, y = pen.at(head.middle_m)
    radius = pen.wide(HEAD_RADIUS)
    yield svg.element("circle", cx=x, cy=y, r=radius, class_=f"{paint} edge")
    if paint in HATCHED:
        yield hatched(around((x, y), radius), HATCHED[paint])
    if np.isfinite(head.nose_m).all():
        ahead = np.array(pen.at(head.nose_m)) - (x, y)
        length = float(np.hypot(*ahead))
        # Where it looks, at the rim; looking at us or away from us has no side.
        if length > radius / 3:
            tip = np.array((x, y)) + ahead / length * radius
            yield svg.element("circle", cx=float(tip[0]), cy=float(tip[1]), r=radius / 4, class_="nose")


def _shadow(part: Limb | Trunk | Head, pen: _Pen) -> Iterator[str]:
    if isinstance(part, Limb):
        yield from (svg.path(_outline(half, pen), "shadow") for half in part.halves)
    elif isinstance(part, Trunk):
        yield svg.path(_rounded([pen.at(corner) for corner in part.corners_m], pen.wide(TRUNK_WIDTH) / 2), "shadow", closed=True)
    else:
        x, y = pen.at(part.middle_m)
        yield svg.element("circle", cx=x, cy=y, r=pen.wide(HEAD_RADIUS), class_="shadow")


def _outline(half: Capsule, pen: _Pen) -> list[Point]:
    """Around the joint, open towards the other half."""
    joint, middle = (np.array(pen.at(end)) for end in half.ends_m)
    along = joint - middle
    length = float(np.hypot(*along))
    out = along / length if length > 1e-6 else np.array((0.0, 1.0))
    beside = np.array((-out[1], out[0]))
    radius = pen.wide(half.width) / 2
    turns = np.linspace(np.pi / 2, -np.pi / 2, _ARC)
    arc = [joint + radius * (np.cos(turn) * out + np.sin(turn) * beside) for turn in turns]
    corners = [middle + radius * beside, *arc, middle - radius * beside]
    return [(float(x), float(y)) for x, y in corners]


def _trunk_pieces(trunk: Trunk) -> Iterator[tuple[list[Float], list[Float], Colour]]:
    """Corners of hips, then of shoulders, each to the waist. Where left and right differ, one after the other, the worse on top,
    each with where it meets the other in the middle."""
    left, right, right_hip, left_hip = trunk.corners_m
    waist, sides = (left + right + right_hip + left_hip) / 4, ((left + left_hip) / 2, (right + right_hip) / 2)
    of_left, of_right, of_right_hip, of_left_hip = trunk.colours
    for (first, second), colours in (((left_hip, right_hip), (of_left_hip, of_right_hip)), ((left, right), (of_left, of_right))):
        if colours[0] == colours[1]:
            yield [first, second, *sides], [], colours[0]
            continue
        middle = [(first + second) / 2, waist]
        pieces = [([corner, side], middle, own) for corner, side, own in zip((first, second), sides, colours, strict=True)]
        yield from sorted(pieces, key=lambda piece: _ON_TOP.index(piece[2]))


def _rounded(corners: Sequence[Point], radius: float, middle: Sequence[Point] = ()) -> list[Point]:
    """The hull of circles about the corners, and of those halves of circles about `middle` that look towards the first corner."""
    turns = np.linspace(0, 2 * np.pi, 4 * _ARC, endpoint=False)
    circle = radius * np.stack((np.cos(turns), np.sin(turns)), axis=1)
    points = (np.array(corners)[:, None] + circle).reshape(-1, 2)
    if middle:
        half = circle[circle @ (np.array(corners[0]) - middle[0]) >= 0]
        points = np.concatenate((points, (np.array(middle)[:, None] + half).reshape(-1, 2)))
    return _hull(points)


def _hull(points: Float) -> list[Point]:
    """Convex hull by Andrew's monotone chain."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    chains = []
    for way in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for x, y in way:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], (x, y)) <= 0:
                chain.pop()
            chain.append((x, y))
        chains.append(chain[:-1])
    return chains[0] + chains[1]


def _turn(first: Point, second: Point, third: Point) -> float:
    return (second[0] - first[0]) * (third[1] - first[1]) - (second[1] - first[1]) * (third[0] - first[0])


def _caption(centre_mm: float, place: int, feedback: Feedback, words: Words) -> str:
    """Which keyframe it is, and how long after the start; grey where either was not seen. Of the start only that it was not."""
    name = svg.text((centre_mm, _FLOOR_MM + 4.2), f"{place + 1}  {words.phases[place]}", "phase", "middle")
    seen = {PHASES[0], PHASES[place]}.isdisjoint(feedback.keyframes_unseen)
    if seen and place == 0:
        return name
    since_s = (feedback.keyframes_ns[place] - feedback.keyframes_ns[0]) * 1e-9
    when = estimate(since_s, _SINCE_SIGMA_S, "s", words) if seen else words.no_time
    return name + svg.text((centre_mm, _FLOOR_MM + 7.9), when, "when" if seen else "when vague", "middle")
