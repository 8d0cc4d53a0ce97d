"""What the doctor says of a running box whose site file it cannot use."""

from pathlib import Path

import pytest

from services.doctor import examine as examination
from services.doctor.configuration import gather_configuration, judge_configuration
from services.doctor.examine import Order, examine
from services.doctor.processes import RunningBox
from tests.installed import ROOT


@pytest.fixture
def old(tmp_path: Path) -> Path:
    file = tmp_path / "site.toml"
    file.write_bytes((ROOT / "tests/golden/sites/every-key-1.toml").read_bytes())
    return file


def told_of_the_box(order: Order, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr(examination, "gather_boxes", lambda: (RunningBox(Path("/srv/gym/site.toml")),))
    (fact,) = (fact for fact in examine(order).facts if fact.where == "running box")
    return fact.words


def test_a_site_file_that_was_named_is_not_asked_for(old: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    words = told_of_the_box(Order(old, tmp_path), monkeypatch)
    assert words == "not examined, since the site file that was named cannot be used; first do what is found of it"


def test_one_that_was_not_named_is_asked_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert (
        told_of_the_box(Order(None, tmp_path), monkeypatch) == "not examined; name its site file with --site (/srv/gym/site.toml)"
    )


def test_an_older_site_file_is_a_fault_with_the_command_that_mends_it(old: Path) -> None:
    (finding,) = judge_configuration(gather_configuration(old)).findings
    assert finding.remedy == f"run 'kinebox config migrate {old}', which keeps a backup"
