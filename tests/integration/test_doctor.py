"""`kinebox doctor` names the cause of every trouble in the list, each really staged, and finds nothing where nothing is wrong."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from services.doctor.report import as_text
from tests.integration.box import ROOT, Box
from tests.integration.doctor_troubles import TROUBLES
from tests.integration.doctor_troubles.running_box import STANDING
from tests.integration.doctor_troubles.trouble import examined
from tests.integration.house import build_house
from tests.integration.waiting import until

pytestmark = pytest.mark.slow

DOCUMENT = ROOT / "docs" / "doctor.md"


@pytest.fixture(scope="module", autouse=True)
def standing_box() -> Iterator[None]:
    """Ended after the last test of the module."""
    yield
    STANDING.end()


@pytest.mark.parametrize("name", TROUBLES)
def test_the_cause_is_named_with_what_to_do(name: str, tmp_path: Path) -> None:
    trouble = TROUBLES[name]
    with trouble.stage(tmp_path) as found:
        findings = found.findings
    matching = [
        finding
        for finding in findings
        if re.fullmatch(trouble.where, finding.where) and re.search(trouble.what, finding.what) and finding.level == trouble.level
    ]
    assert matching, as_text(found)
    assert all(re.search(trouble.remedy, finding.remedy) for finding in matching), as_text(found)
    assert all(finding.known_by for finding in findings)


def test_a_house_in_which_everything_is_right_is_said_to_be_good(tmp_path: Path) -> None:
    found = examined(build_house(tmp_path))
    assert found.findings == ()
    text = as_text(found)
    assert text.startswith("Everything is good.\n")
    assert "'Test gym', 2 calibrated cameras: a, b" in text


def test_a_box_that_runs_well_is_said_to_be_good(tmp_path: Path) -> None:
    folder = tmp_path / "box"
    for made in (tmp_path / "house", folder):
        made.mkdir()
    (folder / "data").symlink_to(build_house(tmp_path / "house").data)
    with Box(folder) as box:
        box.wait_page()
        until(lambda: examined(box).findings == (), "nothing to be found")
        text = as_text(examined(box))
        assert "held by this box" in text
        assert re.search(r"version \S+, up for \d+ s", text)
        assert box.end() == 0


def command(*arguments: str) -> "subprocess.CompletedProcess[str]":
    words = [sys.executable, "-m", "services.cli.main", "doctor", *arguments]
    return subprocess.run(words, capture_output=True, text=True, cwd=ROOT, timeout=100, check=False)


def test_the_command_tells_a_program_in_json_and_a_shell_by_its_exit_code(tmp_path: Path) -> None:
    house = build_house(tmp_path)
    (house.videos / "b.avi").unlink()
    result = command("--site", str(house.site), "--data", str(house.data), "--json")
    told = json.loads(result.stdout)
    assert (result.returncode, result.stderr, told["good"]) == (1, "", False)
    finding = next(finding for finding in told["findings"] if finding["where"] == "camera 'b'")
    assert finding.keys() == {"level", "where", "what", "known_by", "remedy"}
    assert {fact["where"] for fact in told["facts"]} >= {"processor", "memory", "disk", "packages", "site"}


def command_without(module: str, folder: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    """The command on a machine on which a package is broken."""
    (folder / f"{module}.py").write_text("raise ImportError('libgone.so: cannot open shared object file')")
    words = [sys.executable, "-m", "services.cli.main", "doctor", *arguments]
    environment = dict(os.environ) | {"PYTHONPATH": str(folder)}
    return subprocess.run(words, capture_output=True, text=True, cwd=ROOT, env=environment, timeout=100, check=False)


@pytest.mark.parametrize("module", ["msgspec", "numpy", "packaging", "psutil"])
def test_a_package_that_the_doctor_needs_is_found_broken(module: str, tmp_path: Path) -> None:
    result = command_without(module, tmp_path, "--json")
    assert (result.returncode, result.stderr) == (1, "")
    findings = json.loads(result.stdout)["findings"]
    assert f"package {module}" in [finding["where"] for finding in findings]
    assert all("libgone.so" in finding["what"] and "make setup" in finding["remedy"] for finding in findings)


def test_a_broken_package_of_the_command_line_is_one_line(tmp_path: Path) -> None:
    result = command_without("typer", tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert re.fullmatch(r"kinebox: package typer cannot be imported \(libgone.so.*\); run `make setup`.*\n", result.stderr)


def test_a_wrong_option_is_no_finding() -> None:
    result = command("--speling")
    assert result.returncode == 2
    assert "No such option" in result.stderr


def test_the_page_about_the_doctor_lists_every_trouble_of_these_tests() -> None:
    listed = re.findall(r"^- (.+)$", DOCUMENT.read_text().split("## What it names", 1)[1], re.MULTILINE)
    assert listed == [name[0].upper() + name[1:] for name in TROUBLES]
