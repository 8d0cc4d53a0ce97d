"""The core must run where there is no bus, no camera, no network session and no clock."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BLOCKED = ("zenoh", "cv2", "av", "onnxruntime", "fastapi", "uvicorn", "openvino", "depthai", "websockets", "onnx", "psutil")
CLOCKS = {
    "time",
    "perf_counter",
    "perf_counter_ns",
    "monotonic",
    "monotonic_ns",
    "time_ns",
    "process_time",
    "now",
    "utcnow",
    "today",
}


OUTSIDE = {"time", "os", "io", "socket", "subprocess", "threading", "random", "datetime", "shutil", "tempfile", "logging"}
"""Modules of the standard library by which a pure module could reach the world."""
TYPES_ONLY = {
    "models/process.py": {"threading"},
    "models/regular_file.py": {"os"},
    "models/body/file.py": {"io"},
    "models/teaching/standard.py": {"io"},
    "services/evaluation/report/csv_file.py": {"datetime", "io"},
    "services/evaluation/report/page.py": {"datetime"},
    "services/evaluation/report/sheet.py": {"datetime"},
    "services/lesson/export/c3d.py": {"io"},
    "services/lesson/imports/c3d.py": {"io"},
}
"""What does not reach the world: annotations; `io.BytesIO` and `io.StringIO`, by which libraries read and write what was given; and
dates that were given."""


def pure_files() -> list[Path]:
    packages = [ROOT / "models", ROOT / "services/fusion", ROOT / "services/calibration", ROOT / "services/evaluation"]
    packages += [ROOT / "services/lesson/export", ROOT / "services/lesson/imports"]
    files = [file for package in packages for file in sorted(package.rglob("*.py"))]
    reading = ROOT / "services/lesson/imports/file.py"
    return [file for file in files if (file.name != "process.py" or file.parent.name == "models") and file != reading]


def is_build_time(file: Path) -> bool:
    return "build" in file.relative_to(ROOT).parts


PURE = [file for file in pure_files() if not is_build_time(file)]


def test_every_pure_module_imports_with_the_outside_world_blocked() -> None:
    modules = [".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for file in PURE]
    program = (
        "import sys, importlib\n"
        f"for name in {BLOCKED!r}: sys.modules[name] = None\n"
        f"for name in {modules!r}: importlib.import_module(name)\n"
    )
    result = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr


@pytest.mark.parametrize("file", PURE, ids=lambda file: str(file.relative_to(ROOT)))
def test_pure_module_reads_no_clock_and_opens_no_file(file: Path) -> None:
    offences = []
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Call):
            called = node.func
            if isinstance(called, ast.Name) and called.id in {"open", "print", "input"}:
                offences.append(f"line {node.lineno}: {called.id}()")
            if isinstance(called, ast.Attribute) and called.attr in CLOCKS | {
                "read_bytes",
                "read_text",
                "write_bytes",
                "write_text",
            }:
                offences.append(f"line {node.lineno}: .{called.attr}()")
    assert offences == []


def imported(file: Path) -> set[str]:
    names = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        if isinstance(node, ast.ImportFrom):
            names.add((node.module or "").split(".")[0])
    return names


@pytest.mark.parametrize("file", PURE, ids=lambda file: str(file.relative_to(ROOT)))
def test_pure_module_imports_nothing_that_reaches_the_world(file: Path) -> None:
    allowed = TYPES_ONLY.get(str(file.relative_to(ROOT)), set())
    assert imported(file) & OUTSIDE <= allowed


@pytest.mark.parametrize("file", [f for f in PURE if "models" in f.parts], ids=lambda file: str(file.relative_to(ROOT)))
def test_models_import_only_numpy_numba_msgspec_and_the_standard_library(file: Path) -> None:
    allowed = {"models", "numpy", "numba", "msgspec"} | set(sys.stdlib_module_names)
    assert imported(file) <= allowed
