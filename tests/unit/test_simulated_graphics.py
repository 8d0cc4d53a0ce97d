"""Without a graphics library, whoever wants to render is told what to install; everybody else does not notice."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OPEN = """
from edge.simulation.picture.graphics import graphics
from models.errors import UserError
try:
    graphics()
except UserError as error:
    print(error)
"""
BLOCKED = "import sys; sys.modules['moderngl'] = None\n"
WITHOUT_GRAPHICS = """
import edge.simulation.truth.witness, edge.simulation.truth.truth_file
import edge.simulation.picture.sensor, edge.simulation.picture.renderer
import edge.simulation.rigs.arrangements
print("all there")
"""


def run(code: str, **environment: str) -> str:
    finished = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout.strip()


def test_without_moderngl_the_package_to_install_is_named() -> None:
    said = run(BLOCKED + OPEN)
    assert said.startswith("rendering needs moderngl")
    assert ".venv/bin/pip install 'moderngl>=5.12'" in said


@pytest.mark.slow
@pytest.mark.parametrize("variable", ["GLCONTEXT_LINUX_LIBEGL", "GLCONTEXT_LINUX_LIBGL"])
def test_without_the_drivers_their_packages_are_named(variable: str) -> None:
    said = run(OPEN, **{variable: "libNotThere.so"})
    assert said.startswith("OpenGL 4.3 over EGL could not be opened")
    assert "apt-get install libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri" in said


@pytest.mark.slow
def test_truth_is_taken_down_and_pictures_are_developed_without_moderngl() -> None:
    assert run(BLOCKED + WITHOUT_GRAPHICS) == "all there"
