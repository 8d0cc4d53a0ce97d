"""Rules of compiled code that no compiler checks."""

import ast
from pathlib import Path

import pytest

import models.body
import services.fusion

FOLDERS = [Path(package.__file__ or "").parent for package in (services.fusion, models.body)]


def _compiled_functions(tree: ast.Module) -> dict[str, ast.FunctionDef]:
    return {
        node.name: node
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and any(isinstance(d, ast.Name) and d.id == "compiled" for d in node.decorator_list)
    }


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_no_kernel_calls_one_of_another_file_whose_change_the_cache_would_not_see(folder: Path) -> None:
    everywhere = {path: _compiled_functions(ast.parse(path.read_text())) for path in folder.glob("*.py")}
    assert sum(map(len, everywhere.values())) > 3
    names = {name for functions in everywhere.values() for name in functions}
    for path, functions in everywhere.items():
        for function in functions.values():
            called = {node.func.id for node in ast.walk(function) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)}
            assert called & names <= set(functions), f"{path.name}: {function.name} calls {called & names - set(functions)}"
