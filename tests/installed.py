"""What the set-up installs, for tests that need it: a loud skip where it is missing, a failure in CI."""

import os
from pathlib import Path

import pytest

from edge.footage.prepare import is_ready
from edge.footage.sets import ONE_PERSON, Footage
from edge.simulation.picture.graphics import graphics
from edge.simulation.shipped.install import is_installed
from models.errors import UserError

ROOT = Path(__file__).parents[1]
DATA = ROOT / "build"


def require_footage(footage: Footage = ONE_PERSON) -> Path:
    """The data folder, with a built-in footage in it."""
    name = footage.name
    return _require(is_ready(DATA, footage), f"the built-in footage is not in build/{name}; run `make footage SOURCE={name}`")


def require_lesson() -> Path:
    """The data folder, with the built-in simulated lesson in it."""
    return _require(is_installed(DATA), "the built-in lesson is not in build/simulated; run `make simulated`")


def require_networks() -> Path:
    """The data folder, with the converted networks in it."""
    return _require((DATA / "networks/installed.json").is_file(), "the networks are not in build/networks; run `make networks`")


def require_graphics() -> None:
    """OpenGL over EGL, with which simulated pictures are drawn."""
    try:
        graphics()
    except UserError as error:
        _require(False, str(error))


def _require(there: bool, reason: str) -> Path:
    if not there and os.environ.get("CI"):
        pytest.fail(reason)
    if not there:
        pytest.skip(reason)
    return DATA
