"""A site as the TOML of its file. Its schema knows only scalars, tables of scalars and lists of such tables."""

import json
from typing import Any

import msgspec

from models.config.site import Site


def render(site: Site) -> str:
    """The site file with every value in it; reading it gives `site` again."""
    top = msgspec.to_builtins(site)
    # Keys of the top level first: after the heading of a table they would belong to that table.
    parts = [_pairs({key: value for key, value in top.items() if not isinstance(value, dict | list)})]
    for key, value in top.items():
        if isinstance(value, dict):
            parts.append(f"[{key}]\n{_pairs(value)}")
        elif isinstance(value, list):
            parts += [f"[[{key}]]\n{_pairs(item)}" for item in value]
    return "\n".join(parts)


def _pairs(table: dict[str, Any]) -> str:
    # JSON writes scalars as TOML does, save that TOML wants DEL escaped and knows no halves of surrogate pairs.
    return "".join(f"{key} = {json.dumps(value, ensure_ascii=False)}\n" for key, value in table.items()).replace("\x7f", "\\u007f")
