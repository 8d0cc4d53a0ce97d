from pathlib import Path

from models.config.site import schema
from services.cli.configuration_docs import render

PAGE = Path(__file__).parents[2] / "docs" / "configuration.md"


def test_the_page_about_the_site_file_is_current() -> None:
    assert PAGE.read_text() == render(schema()), "run: python -m services.cli.configuration_docs > docs/configuration.md"


def test_every_key_is_described() -> None:
    for section in schema()["$defs"].values():
        for key, field in section["properties"].items():
            assert "$ref" in field or field["description"], key
