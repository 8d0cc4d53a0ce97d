"""What is wrong in a site file, in the words of its file: which key of which table, what was found there, and what is allowed."""

import difflib
import json
import re
from collections.abc import Iterator
from typing import Any

import msgspec
from msgspec import inspect

ALLOWED = "allowed"
"""In the `extra` of a field's `Meta`: what its pattern lets through, for people."""

_BARE = re.compile(r"[A-Za-z0-9_-]{1,60}")
"""A key that TOML, and we, write without quotes."""
_SHOWN = 40
"""Characters of a value by which its writer knows it again."""
_LARGEST = 2**63


def wrong_key(table: Any, schema: type[msgspec.Struct]) -> str:
    """The first thing in a TOML file, or a table of it, that its schema refuses, with what to do; empty if nothing is."""
    return next(_wrong(table, schema, ""), "")


def _wrong(table: Any, schema: type[msgspec.Struct], heading: str) -> Iterator[str]:
    fields = {field.encode_name: field for field in msgspec.structs.fields(schema)}
    for key in table if schema.__struct_config__.forbid_unknown_fields else ():
        if key not in fields:
            yield _in(heading, _unknown(key, list(fields)))
    for key, field in fields.items():
        if key in table:
            yield from _wrong_value(table[key], field.type, heading, key)
        elif field.required:
            yield _in(heading, f"key '{key}' is missing; add it (allowed is {_allowed(inspect.type_info(field.type), key)})")
    try:
        msgspec.convert(table, schema)
    except msgspec.ValidationError as error:  # What two keys say does not go together.
        yield _in(f"{heading}:" if heading else "", str(error) if "; " in str(error) else f"{error}; correct it")


def _wrong_value(value: Any, kind: Any, heading: str, key: str) -> Iterator[str]:
    known = inspect.type_info(kind)
    plain = known.type if isinstance(known, inspect.Metadata) else known
    if isinstance(plain, inspect.StructType) and isinstance(value, dict):
        yield from _wrong(value, plain.cls, f"[{key}]")
    if isinstance(plain, inspect.ListType) and isinstance(plain.item_type, inspect.StructType) and isinstance(value, list):
        for number, each in enumerate(value, 1):
            if isinstance(each, dict):
                yield from _wrong(each, plain.item_type.cls, _numbered(key, number, each))
    try:
        msgspec.convert(value, kind)
    except msgspec.ValidationError:
        yield _in(heading, f"{key}: found {_found(value)}, but allowed is {_allowed(known, key)}; correct it")


def _in(heading: str, words: str) -> str:
    """`words` of the table with that heading; the top level has none."""
    return f"{heading} {words}" if heading else words


def _numbered(key: str, number: int, table: dict[str, Any]) -> str:
    """The heading of one of several tables, which are told apart by their order, and by a name if they have one."""
    name = table.get("name")
    return f"[[{key}]] no. {number}{f' ({_found(name)})' if isinstance(name, str) else ''}"


def _unknown(key: str, known: list[str]) -> str:
    near = difflib.get_close_matches(key, known, n=1)
    hint = f"the nearest is '{near[0]}'" if near else f"there are {', '.join(known)}"
    written = key if _BARE.fullmatch(key) else _found(key)
    return f"{written}: there is no such key ({hint}); correct it, or see docs/configuration.md for every key"


def _found(value: Any) -> str:
    """A value as the file has it, cut off where it is long."""
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, list):
        return f"a list of {len(value)}"
    if isinstance(value, int) and abs(value) >= _LARGEST:
        return "a number of more than 18 digits"  # Python writes none of thousands.
    text = json.dumps(value, ensure_ascii=False) if isinstance(value, str | bool) else str(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def _allowed(kind: inspect.Type, key: str) -> str:  # noqa: PLR0911 - one a kind
    """What a field may be, in words. The schema has only these kinds; a new one is to be described here."""
    match kind:
        case inspect.Metadata(extra=dict() as extra) if ALLOWED in extra:
            return str(extra[ALLOWED])
        case inspect.Metadata(type=plain):
            return _allowed(plain, key)
        case inspect.BoolType():
            return "true or false"
        case inspect.LiteralType(values=values):
            *others, last = (json.dumps(value) for value in values)
            return f"{', '.join(others)} or {last}" if others else last
        case inspect.IntType():
            return f"a whole number{_bounds(kind)}"
        case inspect.FloatType():
            return f"a number{_bounds(kind)}"
        case inspect.StrType(min_length=least, max_length=most):
            return f"text of {least or 0} to {most} characters" if most else "text in quotes" + (", not empty" if least else "")
        case inspect.ListType(min_length=least, max_length=most):
            return f"{least or 0} to {most} tables [[{key}]]"
        case _:
            return f"a table [{key}]"


def _bounds(kind: inspect.IntType | inspect.FloatType) -> str:
    least, most = kind.ge if kind.gt is None else kind.gt, kind.le
    lower = "" if least is None else f"{'of at least' if kind.gt is None else 'of more than'} {least}"
    upper = "" if most is None else f"{'at most' if lower else 'of at most'} {most}"
    return "".join([" " if lower or upper else "", " and ".join(filter(None, (lower, upper)))])
