"""What a visitor reads first must not lead nowhere."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")])


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_relative_link_leads_somewhere(document: Path) -> None:
    targets = re.findall(r"\]\(([^)#]+)", document.read_text())
    broken = [target for target in targets if "://" not in target and not (document.parent / target).exists()]
    assert broken == []


def test_every_make_target_of_the_documents_exists() -> None:
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = {name for document in DOCUMENTS for name in re.findall(r"`make ([a-z-]+)`", document.read_text())}
    assert named <= targets


def test_no_command_of_the_documents_needs_a_python_on_the_path_which_a_fresh_machine_does_not_have() -> None:
    needs = [document.name for document in DOCUMENTS if re.search(r"(?<!\.venv/bin/)\bpython3? -m", document.read_text())]
    assert needs == []


def test_a_simulated_lesson_is_played_from_the_folder_that_it_is_rendered_into() -> None:
    folders = re.findall(r"build/simulated/([A-Z-]+)", (ROOT / "docs" / "simulation.md").read_text())
    assert set(folders) == {"NAME-FINGERPRINT"}
