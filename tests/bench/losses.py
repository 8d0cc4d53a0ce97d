"""What a recording lacks of the time in which there was a figure."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

MISSED_S = 0.2
"""Fusion ticks and the figure is seen every 33 ms; a busy box is late by some of these without anything being lost."""

Span = tuple[float, float]


def lost_s(ticks_s: Sequence[float], figures_s: Sequence[float], from_s: float, to_s: float) -> float:
    """Seconds of a watch that lie between two ticks of the record and not between two figures; all on one clock.

    Both ends of the watch count as ticks: a record that does not go on before the end lacks everything up to it.

    Args:
        ticks_s: of the record, ascending.
        figures_s: when a figure was seen, ascending.
        from_s, to_s: the watch.
    """
    away = list(_pauses(figures_s, from_s, to_s))
    return sum(end - begin - sum(_overlap((begin, end), pause) for pause in away) for begin, end in _pauses(ticks_s, from_s, to_s))


def _pauses(times_s: Sequence[float], from_s: float, to_s: float) -> Iterator[Span]:
    inside = [at for at in times_s if from_s < at < to_s]
    return (span for span in pairwise([from_s, *inside, to_s]) if span[1] - span[0] > MISSED_S)


def _overlap(one: Span, other: Span) -> float:
    return max(min(one[1], other[1]) - max(one[0], other[0]), 0.0)
