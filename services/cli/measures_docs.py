"""Writes the page about what can be measured: `python -m services.cli.measures_docs > docs/measures.md`."""

import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.measures.measured import Function
from services.evaluation.signals.catalogue import FAMILIES
from services.evaluation.signals.signal import Signal

_OPENING: Final = """\
# What is measured

What a teaching file ([how to edit them](teaching.md)) can look at. A **signal** has a value in every frame; a measure takes one
number of it, at a keyframe (`at`) or over a stretch (`over`, `take`). A **function** gives one number of an attempt.

- **Sides.** `lead` is the side that throws, hits, kicks or leads, `other` the other one, `both` their mean: of angles that go round
  the direction half way between them, the shorter way. Signals without a side have it only to say which direction is positive. So a
  left-handed performance gives the same numbers as its mirror image.
- **Units.** deg degrees, pct percent (of the pupil's stature where nothing else is said), cm centimetres, s seconds, m_s metres a
  second, m_s2 metres a second squared, deg_s degrees a second, 1 a plain number. Stature is estimated from thighs, shanks, trunk
  and neck; its sigma is in every percentage.
- **Sigma.** Every number has a standard deviation: the covariance of the joints, from fusion, and what the pose network puts beside
  the joint, carried to first order through the formula; errors that two instants share cancel in their difference. The instant of a
  keyframe is unsure, too: by 0.02 s, or 0.1 s where the hips or half of the joints were not seen around it. 68 % of errors
  shall lie within it; `make bench-measures` counts them (`services/evaluation/uncertainty.py`).
- **Unknown.** A joint that was not seen makes unknown what is made of it: a number that is not known is grey on the page and judges
  nobody. **The pose network has no points of the feet**: nothing that needs a heel, a toe or the sole is measured; what stands in
  for it here, and how well, is said where it does. Nor has it a pelvis or a spine: the line of the hips and the line from hips to
  shoulders stand in for them.
- **Angles** are as in equation 18 of the paper, but by the arc tangent of sine and cosine in place of the clipped arc cosine, which
  loses half its digits where knees and elbows are straight. Zero is the anatomical position. Where the International Society of
  Biomechanics has a convention it is followed and named.

This page is written from the catalogue by `.venv/bin/python -m services.cli.measures_docs`; a test keeps it current.
"""
_TAKES: Final = """\
## How a number is taken of a signal

| take | what it is |
|---|---|
| at | the value at a keyframe, between frames by a cubic |
| max, min | the extreme value of a stretch, between frames by a parabola |
| mean | of the frames of a stretch that were seen; half of their range times the share that was not is in its sigma |
| range | the largest less the smallest value: **range of motion** of an angle |
| change | the value at the end of a stretch less that at its beginning |
| time_of_max, time_of_min | seconds from the beginning of a stretch to the extreme |

Peak speeds and peak accelerations are `max` of the speeds and accelerations below.
"""


def render() -> str:
    """The page."""
    parts = [_OPENING, _TAKES, "## Signals\n"]
    for family, signals in FAMILIES.items():
        parts += [f"### {family}\n", *_table(_signal_rows(signals))]
    parts.append("## Functions\n")
    families = dict.fromkeys(function.family for function in FUNCTIONS.values())
    for family in families:
        parts += [f"### {family}\n", *_table(_function_rows(one for one in FUNCTIONS.values() if one.family == family))]
    return "\n".join(parts)


def _signal_rows(signals: Sequence[Signal]) -> Iterator[tuple[str, str, str, str]]:
    for signal in signals:
        sides = " Each side has one." if signal.sided else ""
        yield f"`{signal.name}`", signal.unit, signal.definition + sides, signal.source


def _function_rows(functions: Iterable[Function]) -> Iterator[tuple[str, str, str, str]]:
    for function in functions:
        yield f"`{function.name}`", function.unit, function.definition, function.source


def _table(rows: Iterable[tuple[str, ...]]) -> list[str]:
    return ["| name | unit | definition | source |\n|---|---|---|---|", *(f"| {' | '.join(row)} |" for row in rows), ""]


if __name__ == "__main__":
    sys.stdout.write(render())
