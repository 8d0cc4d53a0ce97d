"""The bench of the fault drills can fail: nothing that went wrong is left out of its figures, its bars and its exit code."""

import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.bench import faults
from tests.bench.faults import GROWTH_RUNS, Played, bars, figures
from tests.bench.report import Report
from tests.faults.drills import Outcome


def good(drill: str, rss_mb: float = 500.0) -> Outcome:
    return Outcome(drill, fault_s=10.0, recovery_s=1.0, pause_s=1.0, said_s=0.5, rss_mb=rss_mb, lost_s=0.2)


def missed(played: Played, names: Sequence[str], runs: int, *, page: bool = False) -> list[str]:
    report = Report("bench-faults")
    report.add(figures(names, played))
    report.show(bars(names, runs, page=page))
    return report.missed


def test_good_runs_miss_nothing() -> None:
    assert missed(Played([[good("kill-fusion")]] * 3), ["kill-fusion"], 3) == []


def test_one_run_is_not_held_against_a_growth_that_it_cannot_show() -> None:
    assert missed(Played([[good("kill-fusion")]]), ["kill-fusion"], 1) == []


def test_a_drill_that_fails_in_every_run_is_missed_and_not_left_out() -> None:
    played = Played([[good("kill-fusion")]] * 2, failed=[("kill-edge", "waited in vain")] * 2)
    assert set(missed(played, ["kill-fusion", "kill-edge"], 2)) == {
        f"kill-edge.{figure}" for figure in ("recovery_s.max", "failed", "lost_s.max", "said_s.max", "never_said")
    }


def test_a_box_whose_memory_grows_or_that_leaves_something_behind_misses_its_bars() -> None:
    growing = [[good("kill-fusion", 500.0 + 10 * number)] for number in range(GROWTH_RUNS + 1)]
    assert missed(Played(growing, left=["process 7"]), ["kill-fusion"], len(growing)) == ["rss_growth_pct", "left_behind"]


def test_a_fault_that_the_box_never_tells_of_is_missed() -> None:
    silent = good("kill-fusion")
    silent.said_s = None
    assert missed(Played([[silent]]), ["kill-fusion"], 1) == ["kill-fusion.said_s.max", "kill-fusion.never_said"]


@pytest.mark.parametrize(("still_s", "misses"), [(0.7, False), (1.6, True), (None, True)])
def test_a_page_whose_figure_stands_still_in_colour_is_missed(still_s: float | None, misses: bool) -> None:
    seen = good("kill-fusion")
    seen.still_s, seen.away_s = still_s, 2.0
    expected = ["kill-fusion.coloured_still_s.max"] if misses else []
    assert missed(Played([[seen]]), ["kill-fusion"], 1, page=True) == expected


def test_a_page_on_which_the_figure_stays_away_is_missed() -> None:
    seen = good("kill-fusion")
    seen.still_s, seen.away_s = 0.5, 3.4
    assert missed(Played([[seen]]), ["kill-fusion"], 1, page=True) == ["kill-fusion.page_away_s.max"]


def test_what_need_not_be_said_is_held_against_nothing() -> None:
    slow = good("slow-tablet")
    slow.said_s = None
    assert missed(Played([[slow]]), ["slow-tablet"], 1) == []


@pytest.mark.parametrize(("failed", "code"), [([], 0), ([("kill-fusion", "waited in vain")], 1)])
def test_the_exit_code_says_whether_a_bar_was_missed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failed: list[tuple[str, str]], code: int
) -> None:
    played = Played([[good("kill-fusion")]], failed=failed)
    monkeypatch.setattr(faults, "DRILLS", {"kill-fusion": None})
    monkeypatch.setattr(faults, "play", lambda *_, **_named: played)
    monkeypatch.setattr(sys, "argv", ["faults", "--data", str(tmp_path), "--runs", "1", "--no-page"])
    assert faults.main() == code
