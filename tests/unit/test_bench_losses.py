"""How much of a recording a drill is said to have cost: the ruler of `make bench-faults`."""

import numpy as np
import pytest

from tests.bench.losses import lost_s

HZ = 30.0


def seen(*spans: tuple[float, float]) -> list[float]:
    return [float(at) for begin, end in spans for at in np.arange(begin, end, 1 / HZ)]


def test_a_record_without_a_hole_has_lost_nothing() -> None:
    assert lost_s(seen((-5, 40)), seen((-5, 40)), 0.0, 30.0) == 0.0


def test_a_record_that_never_goes_on_has_lost_the_rest_of_the_watch() -> None:
    assert lost_s(seen((-5, 4)), seen((-5, 40)), 0.0, 30.0) == pytest.approx(26.0, abs=2 / HZ)
    assert lost_s([], seen((-5, 40)), 0.0, 30.0) == pytest.approx(30.0)


def test_what_was_recorded_before_a_hole_and_lost_with_its_file_counts() -> None:
    assert lost_s(seen((-5, -2), (8, 40)), seen((-5, 40)), 0.0, 30.0) == pytest.approx(8.0, abs=2 / HZ)


def test_a_pause_of_the_figure_excuses_only_the_hole_that_it_falls_into() -> None:
    record, figure = seen((-5, 4), (5, 40)), seen((-5, 20), (20.4, 40))
    assert lost_s(record, figure, 0.0, 30.0) == pytest.approx(1.0, abs=2 / HZ)


def test_only_the_part_of_a_hole_in_which_there_was_a_figure_is_lost() -> None:
    record, figure = seen((-5, 4), (9, 40)), seen((-5, 4), (7, 40))
    assert lost_s(record, figure, 0.0, 30.0) == pytest.approx(2.0, abs=3 / HZ)


def test_all_holes_count() -> None:
    record = seen((-5, 4), (4.5, 10), (10.6, 40))
    assert lost_s(record, seen((-5, 40)), 0.0, 30.0) == pytest.approx(1.1, abs=4 / HZ)
