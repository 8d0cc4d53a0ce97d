"""Writes the page about the site file from its schema: `python -m services.cli.configuration_docs > docs/configuration.md`."""

import json
import sys
from collections.abc import Iterator
from typing import Any

from models.config.migrations import FIRST_VERSION, MIGRATIONS
from models.config.site import schema

_OPENING = """\
# The site file

In what follows, `kinebox` is `.venv/bin/kinebox` of the folder in which `make run` was typed.

One TOML file says what a box has and how it shall work. Unknown keys and values out of bounds are refused, in one line that names
the key. `kinebox config check FILE` checks a file and the calibration that it names, `kinebox config show FILE` prints it, as
TOML, with every value that it leaves to its default. What it names in the data folder is looked at by `kinebox doctor --site FILE`.
An example is `deploy/sites/simulated/site.toml`.

A file of an older version is refused by `kinebox run`. `kinebox config migrate FILE` brings it to the newest one: comments stay,
and what it was is kept beside it as `FILE.bak-VERSION-TIME`. `--dry-run` only prints what would become different.

This page is written from the schema by `.venv/bin/python -m services.cli.configuration_docs`; a test keeps it current.
"""
_BOUNDS = {
    "minimum": "at least {}",
    "exclusiveMinimum": "more than {}",
    "maximum": "at most {}",
    "minLength": "{} character or more",
    "maxLength": "at most {} characters",
    "minItems": "at least {}",
    "maxItems": "at most {}",
    "pattern": "matches `{}`",
}
_KINDS = {"string": "text", "integer": "whole number", "number": "number", "boolean": "true or false"}


def render(site_schema: dict[str, Any]) -> str:
    """The page for a JSON schema as `models.config.site.schema` gives it: the keys of the file, then a table a section."""
    definitions: dict[str, Any] = site_schema["$defs"]
    site = definitions[_name(site_schema)]
    return "\n".join([_OPENING, *_section("Top level", site), *_nested(site, definitions), *_history()])


def _nested(site: dict[str, Any], definitions: dict[str, Any]) -> Iterator[str]:
    for key, field in site["properties"].items():
        if "$ref" in field:
            yield from _section(f"`[{key}]`", definitions[_name(field)])
        elif "$ref" in field.get("items", {}):
            yield from _section(f"`[[{key}]]`", definitions[_name(field["items"])])


def _section(title: str, section: dict[str, Any]) -> Iterator[str]:
    yield f"## {title}\n"
    yield f"{section['description']}\n"
    yield "| key | meaning | value | default |"
    yield "| --- | --- | --- | --- |"
    for key, field in section["properties"].items():
        if "$ref" in field:
            continue  # a section of its own
        default = f"`{json.dumps(field['default'])}`" if "default" in field else "must be given"
        cells = (f"`{key}`", field["description"], _value(field), default)
        yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
    yield ""


def _history() -> Iterator[str]:
    yield "## History of versions\n"
    for migration in reversed(MIGRATIONS):
        yield f"- **{migration.version}**: {migration.change}"
    yield f"- **{FIRST_VERSION}**: the first.\n"


def _value(field: dict[str, Any]) -> str:
    if "enum" in field:
        return ", ".join(f"`{json.dumps(value)}`" for value in field["enum"])
    bounds = [text.format(field[bound]) for bound, text in _BOUNDS.items() if bound in field]
    if field["type"] == "array":
        kind = "list of tables" if "$ref" in field["items"] else f"list of {_KINDS[field['items']['type']]}"
    else:
        kind = _KINDS[field["type"]]
    return ", ".join([kind, *bounds])


def _name(reference: dict[str, Any]) -> str:
    return str(reference["$ref"]).rsplit("/", 1)[-1]


if __name__ == "__main__":
    sys.stdout.write(render(schema()))
