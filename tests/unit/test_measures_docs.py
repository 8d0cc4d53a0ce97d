from pathlib import Path

from services.cli.measures_docs import render
from services.evaluation.measures.catalogue import FUNCTIONS
from services.evaluation.signals.catalogue import CATALOGUE, FAMILIES

PAGE = Path(__file__).parents[2] / "docs" / "measures.md"


def test_the_page_about_measures_is_current() -> None:
    assert PAGE.read_text() == render(), "run: python -m services.cli.measures_docs > docs/measures.md"


def test_no_name_is_given_twice() -> None:
    names = [signal.name for family in FAMILIES.values() for signal in family] + list(FUNCTIONS)
    assert len(names) == len(set(names)) == len(CATALOGUE) + len(FUNCTIONS)


def test_everything_that_is_measured_is_defined() -> None:
    said = {name: (signal.definition, signal.source) for name, signal in CATALOGUE.items()}
    said |= {name: (function.definition, function.source) for name, function in FUNCTIONS.items()}
    for name, (definition, source) in said.items():
        assert definition.endswith("."), name
        assert "|" not in definition + source, f"{name}: breaks the page's table"
