"""The scores of a pupil's attempts over the lesson, each with how sure it is, on paper."""

from collections.abc import Iterator, Sequence
from typing import Final

from services.evaluation.report import svg
from services.evaluation.report.document import Attempt, PupilSummary

WIDTH_MM: Final = 186.0
HEIGHT_MM: Final = 38.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 8.0, 3.0, 2.5, 6.5
_TICKS: Final = (0, 25, 50, 75, 100)
_RADIUS_MM: Final = 1.75
_MOST_LABELS: Final = 40
_WIDEST_MM: Final = 14.0
"""From one attempt to the next; a few of them are not strewn over the whole page."""


def letter(place: int) -> str:
    """A, B, ... by which an action is known in the drawing and in the table beside it."""
    return chr(ord("A") + place % 26)


def chart(summary: PupilSummary, attempts: Sequence[Attempt], label: str) -> str:
    """The drawing.

    Args:
        summary: of the pupil, with his actions in the table's order.
        attempts: his.
        label: what it shows, for those who cannot see it.
    """
    step = min((WIDTH_MM - _LEFT - _RIGHT) / len(attempts), _WIDEST_MM)
    width = _LEFT + _RIGHT + step * len(attempts)
    letters = {action.action: letter(place) for place, action in enumerate(summary.actions)}
    every = 1 + len(attempts) // _MOST_LABELS
    drawn = [*_grid(width)]
    for place, attempt in enumerate(attempts):
        x = _LEFT + (place + 0.5) * step
        drawn += _point(x, attempt, letters[attempt.action], min(_RADIUS_MM, 0.45 * step))
        if place % every == 0:
            drawn.append(svg.text((x, HEIGHT_MM - 1.2), str(attempt.number), "tick", "middle"))
    return svg.drawing(width, HEIGHT_MM, "".join(drawn), label)


def _height(score: float) -> float:
    return _TOP + (100 - min(max(score, 0.0), 100.0)) / 100 * (HEIGHT_MM - _TOP - _BOTTOM)


def _grid(width: float) -> Iterator[str]:
    for tick in _TICKS:
        y = _height(tick)
        yield svg.line((_LEFT, y), (width - _RIGHT, y), "axis" if tick == 0 else "grid")
        yield svg.text((_LEFT - 1, y + 0.9), str(tick), "tick", "end")


def _point(x: float, attempt: Attempt, name: str, radius: float) -> Iterator[str]:
    if attempt.score is None or attempt.score_sigma is None:
        # It stands nowhere: least of all at nought.
        yield svg.text((x, _height(50) + 1), "?", "lost small", "middle")
        return
    y = _height(attempt.score)
    ends = [_height(attempt.score + way * attempt.score_sigma) for way in (-1, 1)]
    yield svg.line((x, ends[0]), (x, ends[1]), "whisker")
    yield from (svg.line((x - radius / 2, end), (x + radius / 2, end), "whisker") for end in ends)
    yield svg.element("circle", cx=x, cy=y, r=radius, class_="score")
    yield svg.text((x, y + 0.85), name, "letter", "middle")
