"""Whether the twin may be trusted: fusion on its observations beside fusion on the rendered ones, of the same motions.

The lessons are none that the twin was fitted to. Each is told by the twin `TELLINGS` times, for chance is part of it, and figures
are means. A twin agrees where its figures are within `BAR_PCT` of the rendered ones.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import msgspec
import numpy as np

from models.arrays import Float
from models.messages.observation import Observation
from models.skeleton import coco
from tests.bench.closed_loop import Event
from tests.bench.metrics.position import position_error
from tests.bench.metrics.steadiness import jitter_mm
from tests.bench.reconstruct.figures import judge
from tests.bench.reconstruct.fused import fuse
from tests.bench.reconstruct.lesson import START_NS, Lesson
from tests.bench.table import Cell, ResultTable
from tests.twin.context import Context, look
from tests.twin.errors import Errors, errors_of
from tests.twin.likeness import GROUPS, LAGS, SHARES, Description, describe
from tests.twin.rendered import streams_of
from tests.twin.truth import Stream
from tests.twin.twin import Twin

BAR_PCT: Final = 15.0
TELLINGS: Final = 5
FIGURES: Final = ("smooth mpjpe", "live mpjpe", "smooth jitter", "live jitter")
"""Millimetres, and millimetres a frame squared. Figures of attempts will join them when attempts are found."""


@dataclass(frozen=True, eq=False)
class Case:
    """A rendered lesson, and what fusion consumed of it.

    Attributes:
        lesson: with its truth.
        cameras: that looked.
        events: as consumed.
        delay_s: from exposure to arrival.
    """

    lesson: Lesson
    cameras: tuple[str, ...]
    events: Sequence[Event]
    delay_s: float


@dataclass(frozen=True, eq=False)
class Agreement:
    """What was found.

    Attributes:
        rendered: figures by lesson and action.
        twin: the same; means over the tellings.
        told: errors of the networks on all lessons.
        made: errors of the twin.
    """

    rendered: dict[tuple[str, str], dict[str, float]]
    twin: dict[tuple[str, str], dict[str, float]]
    told: Description
    made: Description

    @property
    def actions(self) -> tuple[str, ...]:
        """In the order in which they came."""
        return tuple(dict.fromkeys(action for _, action in self.rendered))

    def figure(self, of: Mapping[tuple[str, str], Mapping[str, float]], name: str, action: str | None = None) -> float:
        """Mean over the lessons of one action's figure, or over the means of all actions."""
        if action is None:
            return float(np.mean([self.figure(of, name, each) for each in self.actions]))
        return float(np.mean([figures[name] for (_, each), figures in of.items() if each == action]))

    def gap_pct(self, name: str, action: str | None = None) -> float:
        """The twin's figure over the rendered one, in per cent of change."""
        return 100 * (self.figure(self.twin, name, action) / self.figure(self.rendered, name, action) - 1)

    def tables(self) -> list[ResultTable]:
        """Figures side by side, then the errors themselves."""
        columns = ("action", *(column for name in FIGURES for column in (name, "twin", "gap %")))
        rows: list[tuple[Cell, ...]] = [
            (action or "mean of the actions", *(cell for name in FIGURES for cell in self._beside(name, action)))
            for action in (*self.actions, None)
        ]
        title = "the twin beside rendered lessons: mpjpe in mm, jitter in mm a frame squared"
        return [ResultTable(title, columns, tuple(rows)), *(table(self.told, self.made) for table in (_sizes, _memory, _habits))]

    def _beside(self, name: str, action: str | None) -> tuple[float, float, float]:
        return self.figure(self.rendered, name, action), self.figure(self.twin, name, action), self.gap_pct(name, action)

    def figures(self) -> dict[str, float]:
        """For the report: the gap that is judged is the larger one of live and smooth."""
        out = {f"twin.{name.replace(' ', '_')}_gap_pct": self.gap_pct(name) for name in FIGURES}
        for short in ("mpjpe", "jitter"):
            out[f"twin.{short}_gap_pct"] = max((self.gap_pct(name) for name in FIGURES if name.endswith(short)), key=abs)
        for action in self.actions:
            out |= {f"twin.{name.replace(' ', '_')}_gap_pct.{action}": self.gap_pct(name, action) for name in FIGURES}
        return out


def agree(cases: Sequence[Case], twin_for: Callable[[Lesson], Twin], shown: Callable[[Case], None] = lambda _: None) -> Agreement:
    """Compare on some lessons.

    Args:
        cases: lessons.
        twin_for: the twin to judge by a lesson, which must not know it.
        shown: is told each lesson when it is done.
    """
    rendered, made_figures = {}, {}
    told: list[tuple[Context, Errors]] = []
    made: list[tuple[Context, Errors]] = []
    for case in cases:
        streams = streams_of(case.lesson, case.cameras, case.events, case.delay_s)
        for action, figures in _figures(case, case.events).items():
            rendered[case.lesson.name, action] = figures
        twin, tellings = twin_for(case.lesson), []
        for telling in range(TELLINGS):
            observations = twin.retold([s.truth for s in streams], telling, START_NS, np.full(2, case.delay_s))
            events = in_place_of(case.events, observations)
            tellings.append(_figures(case, events))
            made += _errors(streams_of(case.lesson, case.cameras, events, case.delay_s))
        told += _errors(streams)
        for action in tellings[0]:
            means = {name: float(np.mean([telling[action][name] for telling in tellings])) for name in FIGURES}
            made_figures[case.lesson.name, action] = means
        shown(case)
    return Agreement(rendered, made_figures, describe(told), describe(made))


def in_place_of(events: Sequence[Event], observations: Sequence[tuple[float, Observation]]) -> list[Event]:
    """The same ticks, with other observations, each in the place of the one that was of the same picture."""
    made = {(observation.camera, observation.t_mid_ns): observation for _, observation in observations}
    out: list[Event] = []
    for event in events:
        if not isinstance(event, Observation):
            out.append(event)
        elif (event.camera, event.t_mid_ns) in made:
            own = made[event.camera, event.t_mid_ns]
            out.append(msgspec.structs.replace(own, sequence=event.sequence, frame=event.frame))
    return out


def _figures(case: Case, events: Sequence[Event]) -> dict[str, dict[str, float]]:
    lesson = case.lesson
    fused = fuse(lesson.rig.select(case.cameras), events, lesson.length_s)
    out: dict[str, dict[str, float]] = {}
    for kind, found_m in (("smooth", fused.smooth_m), ("live", fused.live_m)):
        judged = judge(lesson.spans, fused.times_s, found_m, lesson.truth_m)
        for action in dict.fromkeys(one.action for one in judged):
            own = [one for one in judged if one.action == action]
            joined: list[Float] = [
                np.concatenate(parts) for parts in zip(*((one.found_m, one.truth_m) for one in own), strict=True)
            ]
            figures = out.setdefault(action, {})
            figures[f"{kind} mpjpe"] = position_error(joined[0], joined[1]).mpjpe_mm
            figures[f"{kind} jitter"] = float(np.mean([jitter_mm(one.found_m) for one in own]))
    return out


def _errors(streams: Sequence[Stream]) -> list[tuple[Context, Errors]]:
    out = []
    for stream in streams:
        frame, context = look(stream.truth)
        out.append((context, errors_of(frame, stream.said)))
    return out


def _sizes(told: Description, made: Description) -> ResultTable:
    columns = {
        f"{100 * share:.0f} %": [100 * each.quantiles[:, index] for each in (told, made)] for index, share in enumerate(SHARES)
    }
    return _by_joints("errors in the picture, quantiles in per cent of the stature", columns)


def _memory(told: Description, made: Description) -> ResultTable:
    columns = {f"{lag} later": [each.memory[:, index] for each in (told, made)] for index, lag in enumerate(LAGS)}
    columns["stream's mean, %"] = [100 * each.steady for each in (told, made)]
    return _by_joints(
        "what stays of errors: correlation so many pictures later; a stream's mean in per cent of the stature", columns
    )


def _habits(told: Description, made: Description) -> ResultTable:
    columns = {
        "crossed, %": [100 * each.crossed for each in (told, made)],
        "lost, %": [np.full(coco.COUNT, 100 * each.lost) for each in (told, made)],
        "score": [each.score for each in (told, made)],
        "score to error": [each.knowing for each in (told, made)],
    }
    return _by_joints("swaps, losses, mean score, and its rank correlation with the error", columns)


def _by_joints(title: str, columns: Mapping[str, Sequence[Float]]) -> ResultTable:
    """A row a group of joints; for each column the network's mean over them and the twin's."""
    rows: list[tuple[Cell, ...]] = [
        (group, *(_mean(values[list(joints)]) for pair in columns.values() for values in pair)) for group, joints in GROUPS.items()
    ]
    return ResultTable(title, ("joints", *(name for column in columns for name in (column, "twin"))), tuple(rows))


def _mean(values: Float) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else float("nan")
