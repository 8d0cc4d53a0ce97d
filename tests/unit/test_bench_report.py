"""What a benchmark writes: names and numbers for programs, tables for people, nothing that was not measured."""

import json
from pathlib import Path

import pytest

from tests.bench.report import Report
from tests.bench.table import ResultTable, Spread, shown, spread, table_of


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
