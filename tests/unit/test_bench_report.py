"""What a benchmark writes: names and numbers for programs, tables for people, nothing that was not measured; and how it ends."""

import json
import re
from pathlib import Path

import pytest

from tests.bench import lessons
from tests.bench.report import Report
from tests.bench.table import ResultTable, Spread, shown, spread, table_of
from tests.installed import ROOT

BENCHES = {
    str(path.relative_to(ROOT)): path.read_text()
    for path in sorted((ROOT / "tests/bench").rglob("*.py"))
    if path.name != "report.py"
}
WITH_BARS = [name for name, text in BENCHES.items() if re.search(r"""\("(>=|<=|within)", """, text)]


def written(report: Report, data: Path) -> tuple[dict[str, object], str]:
    path = report.write(data)
    return json.loads(path.read_text()), path.with_suffix(".md").read_text()


def test_a_mean_over_seeds_is_written_with_its_deviation_in_both_files(tmp_path: Path) -> None:
    report = Report("bench-toy", seeds=(0, 1, 2))
    report.add_seeds([{"mpjpe_mm.mean": 10.0}, {"mpjpe_mm.mean": 14.0}, {"mpjpe_mm.mean": 12.0}])
    report.show({"mpjpe_mm.mean": ("<=", 11.0)})
    document, text = written(report, tmp_path)
    assert document["figures"] == {"mpjpe_mm.mean": 12.0}
    assert document["deviations"] == {"mpjpe_mm.mean": 2.0}
    assert "| mpjpe_mm.mean | 12 ± 2 | <= 11 | missed |" in text


def test_a_figure_that_one_seed_lacks_is_left_out_and_never_a_mean_of_the_others(tmp_path: Path) -> None:
    report = Report("bench-toy", seeds=(0, 1))
    report.add_seeds([{"a": 1.0, "b": 2.0}, {"a": 3.0, "b": float("nan")}])
    report.add({"c": float("nan"), "d": 0.0})
    document, text = written(report, tmp_path)
    assert document["figures"] == {"a": 2.0, "d": 0.0}
    assert "nan" not in text
    assert "NaN" not in json.dumps(document)


def test_tables_stand_in_both_files_and_what_is_missing_is_empty(tmp_path: Path) -> None:
    report = Report("bench-toy")
    report.tables.append(table_of("by action, mm", "action", {"run": {"ours": Spread(3.0, 0.5, 5)}, "a|b": {"theirs": 1234.5}}))
    document, text = written(report, tmp_path)
    assert (
        "### by action, mm\n\n| action | ours | theirs |\n| --- | ---: | ---: |\n| run | 3 ± 0.5 |  |\n| a\\|b |  | 1234 |" in text
    )
    assert document["tables"] == [
        {
            "title": "by action, mm",
            "columns": ["action", "ours", "theirs"],
            "rows": [["run", {"mean": 3.0, "deviation": 0.5, "seeds": 5}, None], ["a|b", None, 1234.5]],
        }
    ]


def test_a_row_that_does_not_fit_its_table_is_refused() -> None:
    with pytest.raises(ValueError, match="2 columns"):
        ResultTable("toy", ("a", "b"), (("row", 1.0, 2.0),))


def test_a_single_seed_has_no_deviation() -> None:
    assert shown(spread([3.0])) == "3"
    assert spread([]) is None
    assert spread([1.0, float("inf")]) is None
    assert shown(float("nan")) == shown(None) == ""


def test_a_bar_whose_figure_could_not_be_measured_is_missed_and_does_not_vanish(tmp_path: Path) -> None:
    report = Report("bench-toy")
    report.add({"a": 1.0, "b": 1.0, "c": 1.0, "d": float("nan")})
    report.show({"a": (">=", 1.0), "b": (">=", 2.0), "d": ("<=", 0.0), "e": ("within", 5.0)})
    assert report.missed == ["b", "d", "e"]
    _, text = written(report, tmp_path)
    assert "| a | 1 | >= 1 | met |" in text
    assert "| c | 1 |  |  |" in text
    assert "| d |  | <= 0 | missed |" in text
    assert "| e |  | within 5 | missed |" in text


def test_a_missed_bar_is_named_in_the_last_line_and_is_the_exit_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report = Report("bench-toy")
    report.add({"a": 1.0, "b": 1.0})
    assert report.conclude({"a": (">=", 1.0), "b": (">=", 2.0), "c": ("<=", 0.0)}, tmp_path) == 1
    assert capsys.readouterr().out.splitlines()[-1] == "missed: b, c"
    assert "missed" in (tmp_path / "bench/bench-toy.md").read_text()
    assert report.conclude({"a": (">=", 1.0)}, tmp_path) == 0
    assert "missed: " not in capsys.readouterr().out


def test_there_are_benchmarks_with_bars() -> None:
    assert {"tests/bench/lessons.py", "tests/bench/shelf/measure.py", "tests/bench/twin.py"} <= set(WITH_BARS)


@pytest.mark.parametrize("name", WITH_BARS)
def test_no_benchmark_swallows_that_a_bar_was_missed(name: str) -> None:
    text = BENCHES[name]
    if "report.missed" in text:  # it has more to say before its end than the common one
        assert "return 1 if report.missed else 0" in text
    else:
        assert text.count("return report.conclude(") == 1
        assert "report.show(" not in text


@pytest.mark.parametrize("name", [name for name, text in BENCHES.items() if "def main() -> int:" in text])
def test_no_benchmark_swallows_its_own_exit_code(name: str) -> None:
    assert 'if __name__ == "__main__":\n    sys.exit(main())\n' in BENCHES[name]


@pytest.mark.parametrize(
    ("too_large", "code"),
    [("", 0), ("lesson_mb_45min", 1), ("lesson_mb_45min.4x15hz_two_persons", 1), ("lesson_mb_45min.4x30hz", 1)],
)
def test_a_lesson_that_takes_more_than_it_may_fails_the_benchmark_at_every_rate_and_with_two_people(
    too_large: str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def size_mb(figure: str) -> float:
        return 151.0 if figure == too_large else 149.0

    recorded = {"recorder_cpu_pct": 0.5, "lesson_mb_45min": size_mb("lesson_mb_45min")}
    monkeypatch.setattr(lessons, "record", lambda *_: (tmp_path, recorded))
    monkeypatch.setattr(lessons, "rates", lambda _: {})
    monkeypatch.setattr(lessons, "written_again", lambda _lesson, _folder, label, *_: size_mb(f"lesson_mb_45min.{label}"))
    monkeypatch.setattr("sys.argv", ["lessons", "--site", "site.toml", "--data", str(tmp_path)])
    assert lessons.main() == code
    assert ("missed: " in capsys.readouterr().out) == bool(code)
