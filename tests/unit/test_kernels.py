"""Rules of compiled code that no compiler checks."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

import models.body
import services.evaluation
import services.fusion
from tests.installed import ROOT

KERNEL = """
from models.compiled import compiled

@compiled
def double(value):
    return 2 * value
"""
ASK = "import kernel; from services.doctor.kernels import is_compiled; print(is_compiled(kernel.double))"
FOLDERS = [Path(package.__file__ or "").parent for package in (services.fusion, services.evaluation, models.body)]


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


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_no_kernel_calls_lapack_or_blas_which_copy_small_matrices_and_come_through_scipy(folder: Path) -> None:
    for path in folder.glob("*.py"):
        for function in _compiled_functions(ast.parse(path.read_text())).values():
            nodes = list(ast.walk(function))
            called = {node.attr for node in nodes if isinstance(node, ast.Attribute)} & {"linalg", "dot", "vdot", "inner", "outer"}
            product = any(isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, ast.MatMult) for node in nodes)
            assert not called, f"{path.name}: {function.name} uses np.{called.pop()}"
            assert not product, f"{path.name}: {function.name} multiplies matrices with @"


@pytest.mark.slow
def test_the_doctor_knows_what_numba_has_compiled_for_this_code_and_this_processor(tmp_path: Path) -> None:
    def run(program: str, **more: str) -> str:
        paths = {"NUMBA_CACHE_DIR": str(tmp_path / "kernels"), "PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}"}
        environment = os.environ | paths | more
        return subprocess.run(
            [sys.executable, "-c", program], env=environment, cwd=tmp_path, capture_output=True, text=True, check=True
        ).stdout.strip()

    (tmp_path / "kernel.py").write_text(KERNEL)
    assert run(ASK) == "False"
    assert run("import kernel; print(kernel.double(2.0))") == "4.0"
    assert run(ASK) == "True"
    assert run(ASK, NUMBA_CPU_NAME="generic", NUMBA_CPU_FEATURES="") == "False"
    (tmp_path / "kernel.py").write_text(f"{KERNEL}# of another version\n")
    assert run(ASK) == "False"
