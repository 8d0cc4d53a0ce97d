"""Who listens to what, read from the code itself, so that nothing that is received can stay without mutants.

A module that calls `subscribe` is taken to receive every topic that it names, but for those that it only publishes or watches.
"""

import ast
import inspect
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

from models.messages import topics
from services.bus.keys import matches
from tests.installed import ROOT
from tests.mutations.samples import by_topic

PACKAGES = ("edge", "services")
NO_MESSAGES = frozenset({"alive", "ALL_ALIVE"})
"""Tokens of the bus's own, which carry nothing."""
ASKED: set[str] = set()
"""The modules whose topics the tests have asked for."""
_NOT_RECEIVED = frozenset({"publish", "declare_alive", "watch_alive"})


@lru_cache(maxsize=1)
def patterns() -> dict[str, str]:
    """A key expression for everything that `models.messages.topics` names, `*` standing for any process, camera or kind."""
    found: dict[str, str] = {}
    for name, value in vars(topics).items():
        if inspect.isfunction(value):
            made = value(*("*" for _ in inspect.signature(value).parameters))
        elif isinstance(value, str) and not name.startswith("_"):
            made = value
        else:
            continue
        if made.startswith(f"{topics.ROOM}/") and name not in NO_MESSAGES:
            found[name] = made
    return found


@lru_cache(maxsize=1)
def received() -> dict[str, frozenset[str]]:
    """Key expressions by the module that receives them."""
    found = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            text = path.read_text()
            tree = ast.parse(text if "subscribe" in text else "")
            if any(_is_call_of(node, {"subscribe"}) for node in ast.walk(tree)):
                found[_module(path)] = frozenset(_received(tree))
    return found


def topics_of(module: str, *, every: bool = False) -> list[str]:
    """Topics that a module receives, of which there are samples: one for each of its key expressions, or all of them."""
    ASKED.add(module)
    found: list[str] = []
    for pattern in sorted(received()[module]):
        fitting = [topic for topic in by_topic() if matches(pattern, topic)]
        found += fitting if every else fitting[:1]
    return found


def _received(tree: ast.AST) -> Iterator[str]:
    if _is_call_of(tree, _NOT_RECEIVED):
        return
    if isinstance(tree, ast.Call) and (name := _topic_name(tree.func)) in patterns():
        words = [argument.value if isinstance(argument, ast.Constant) else "*" for argument in tree.args]
        yield getattr(topics, name)(*words)
        return
    if (name := _topic_name(tree)) in patterns():
        yield patterns()[name]
    for child in ast.iter_child_nodes(tree):
        yield from _received(child)


def _topic_name(node: ast.AST) -> str:
    """NAME of `topics.NAME`; empty if it is something else."""
    of_topics = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "topics"
    return node.attr if of_topics and isinstance(node, ast.Attribute) else ""


def _is_call_of(node: ast.AST, names: frozenset[str] | set[str]) -> bool:
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in names


def _module(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)
