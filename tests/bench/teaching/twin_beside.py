"""What the twin makes of the very lessons that are rendered: whether its attempts, keyframes and cues may be believed."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

from edge.simulation.split import Split
from services.evaluation.track import Track
from tests.bench.table import ResultTable
from tests.bench.teaching import cues
from tests.bench.teaching.cues import Result
from tests.bench.teaching.finding import SIX, Found, attempt_f1, find, keyframe_f1
from tests.bench.teaching.lessons import filmed_lesson
from tests.bench.teaching.twinned import smooth_of, truth_of
from tests.twin.agreement import BAR_PCT

_CUES: Final = ("cue_accuracy_pct", "false_cue_pct", "praised_pct", "fine_pct")


def twins_of_films(split: Split, seeds: Sequence[int], data: Path) -> Iterator[tuple[int, Track, Found]]:
    """The lessons of `tests.bench.teaching.filmed.films`, through the twin and fusion, and what is found in them."""
    for seed in seeds:
        plan = filmed_lesson(split, seed)
        truth = truth_of(plan)
        track = smooth_of(plan, truth, data)
        yield plan.seed, track, find(track, truth.motion.attempts)


def attempt_figures(found: Sequence[Found], said: Sequence[Result]) -> dict[str, float]:
    """What the twin is compared by: attempts, keyframes by action and in the mean, cues."""
    by_action = {f"keyframe_f1.{action}": keyframe_f1(found, action) for action in SIX}
    mean = sum(by_action.values()) / len(by_action)
    spoken = cues.figures(said)
    return {"attempt_f1": attempt_f1(found), "keyframe_f1": mean, **by_action, **{name: spoken[name] for name in _CUES}}


def gaps_pct(rendered: Mapping[str, float], twin: Mapping[str, float]) -> dict[str, float]:
    """By how much the twin's figures are larger, percent of the rendered ones; NaN where these are 0."""
    return {name: 100 * (twin[name] / value - 1) if value else float("nan") for name, value in rendered.items()}


def table(rendered: Mapping[str, float], twin: Mapping[str, float]) -> ResultTable:
    """Side by side."""
    gaps = gaps_pct(rendered, twin)
    rows = tuple((name, value, twin[name], gaps[name]) for name, value in rendered.items())
    title = f"the twin beside the same lessons rendered; it may be believed within {BAR_PCT:g} %"
    return ResultTable(title, ("figure", "rendered", "twin", "gap %"), rows)
