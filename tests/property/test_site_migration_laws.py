"""What holds for every site file of version 1, however it is written."""

import json
import tomllib
from copy import deepcopy
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.config.migrations import migrate
from models.config.site import SITE_VERSION, decode_site
from models.errors import UserError
from services.site_file.migration import migrated_text

KEYS = st.sampled_from(["name", "kind", "path", "rate_hz", "offset_ms", "version", "cameras", "x-y", "shutter_delay"])
SCALARS = st.booleans() | st.integers(-(2**62), 2**62) | st.floats(allow_nan=False) | st.text(max_size=5)
ANY_TOML = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(KEYS, inner, max_size=4), max_leaves=8)
ANY_SITE = st.dictionaries(KEYS | st.just("bus"), ANY_TOML, max_size=6)

COMMENTS = st.none() | st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=12)
GAPS = st.lists(st.sampled_from(["", "  ", "# between", "\t# indented"]), max_size=2)


@st.composite
def tables(draw: st.DrawFn, pairs: dict[str, Any]) -> str:
    """Lines of a table: its keys in any order, quoted or not, with comments and empty lines anywhere."""
    lines = []
    for key in draw(st.permutations(list(pairs))):
        written = draw(st.sampled_from([key, f'"{key}"', f"'{key}'"]))
        equals = draw(st.sampled_from([" = ", "=", "  =\t"]))
        comment = draw(COMMENTS)
        lines += [f"{written}{equals}{json.dumps(pairs[key])}{'' if comment is None else f' # {comment}'}", *draw(GAPS)]
    return "".join(f"{line}\n" for line in lines)


@st.composite
def camera(draw: st.DrawFn, name: str) -> dict[str, Any]:
    more = draw(st.fixed_dictionaries({}, optional={"rate_hz": st.floats(1, 240), "offset_ms": st.integers(-1000, 1000)}))
    return {"name": name, "kind": "video", "path": f"{name}.avi", **more}


@st.composite
def site_texts(draw: st.DrawFn) -> str:
    """A good site file of version 1; sometimes with a key that no version knows."""
    cameras = [f"[[cameras]]\n{draw(tables(draw(camera(name))))}" for name in draw(st.sampled_from(["ab", "abcd"]))]
    sections = [
        f"[bus]\n{draw(tables({'endpoint': 'tcp/127.0.0.1:7447'}))}",
        f"[supervisor] # who watches\n{draw(tables({'max_restarts': 3, 'window_s': 9.5}))}",
    ]
    rest = draw(st.sampled_from([[*cameras, *sections], [*sections, *cameras], [sections[0], *cameras, sections[1]]]))
    top = {"version": 1, "name": "Gym", "calibration": "rig.toml"} | draw(st.sampled_from([{}, {}, {}, {"tablett": 3}]))
    text = "".join([draw(tables(top)), *rest])
    return text.replace("\n", draw(st.sampled_from(["\n", "\r\n"])))


def values(site: object) -> list[str]:
    """Every scalar in a file, but its version."""
    if isinstance(site, dict):
        return [found for key, value in site.items() if key != "version" for found in values(value)]
    if isinstance(site, list):
        return [found for value in site for found in values(value)]
    return [repr(site)]


@given(ANY_SITE, st.sampled_from([1, 2, 3, True, "1", 1.0]))
def test_whatever_a_file_says_its_migration_loses_no_value_and_the_second_changes_nothing(
    site: dict[str, Any], version: object
) -> None:
    site = site | {"version": version}
    before = deepcopy(site)
    try:
        new = migrate(site)
    except UserError:
        return
    assert site == before
    assert sorted(values(new)) == sorted(values(before))
    assert migrate(new) == new
    assert new["version"] == (SITE_VERSION if type(version) is int and version == 1 else version)


@pytest.mark.slow
@given(site_texts())
def test_a_migrated_file_says_the_same_keeps_its_comments_and_loads_or_names_its_key(text: str) -> None:
    old = tomllib.loads(text)
    if "tablett" in old:
        with pytest.raises(UserError, match="tablett: there is no such key"):
            migrated_text(text.encode(), "site.toml")
        return
    texts = migrated_text(text.encode(), "site.toml")
    new = tomllib.loads(texts.new)
    assert new == migrate(old)
    assert decode_site(texts.new.encode(), "site.toml").version == SITE_VERSION
    # Line by line: only what a migration renames is different, and no line moved.
    for before, after in zip(text.split("\n"), texts.new.split("\n"), strict=True):
        if "offset_ms" not in before and "version" not in before:
            assert after == before
        else:
            assert after.partition("#")[1:] == before.partition("#")[1:]
    assert migrated_text(texts.new.encode(), "site.toml").new == texts.new
