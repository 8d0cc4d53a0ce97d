"""A rendered lesson is found again for as long as it would come out the same, and no longer: what its recipe changes with."""

from collections.abc import Callable
from pathlib import Path

import pytest

from edge.simulation.rendering import recipe as recipes

PROGRAM = '"""What it is."""\n\nRATE = 30  # a second\n\n\ndef double(value: int) -> int:\n    """Twice."""\n    return 2 * value\n'


@pytest.fixture
def recipe_now(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], str]:
    """The recipe of a small tree of the same shape."""
    for folder in (*recipes._CODE, *recipes._DATA):
        (tmp_path / folder).mkdir(parents=True, exist_ok=True)
        (tmp_path / folder / "one.py").write_text(PROGRAM)
    for name in recipes._FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(PROGRAM)
    (tmp_path / recipes._DATA[0] / "body.npz").write_bytes(b"shapes")
    monkeypatch.setattr(recipes, "_ROOT", tmp_path)
    return recipes.recipe.__wrapped__


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("edge/simulation/one.py", PROGRAM.replace("2 *", "3 *")),
        ("models/motions/one.py", PROGRAM.replace("30", "60")),
        ("edge/simulation/people/new.py", PROGRAM),
        ("edge/footage/transcode.py", PROGRAM.replace("RATE", "QUALITY")),
        ("models/body/data/body.npz", "other shapes"),
    ],
)
def test_code_and_data_that_make_pictures_change_it(name: str, text: str, recipe_now: Callable[[], str], tmp_path: Path) -> None:
    before = recipe_now()
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(text)
    assert recipe_now() != before


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "edge/simulation/one.py",
            PROGRAM.replace("Twice", "Two times").replace("What it is", "Another head").replace("a second", "Hz"),
        ),
        ("models/motions/recorded/fit.py", PROGRAM),
        ("edge/simulation/presets.py", PROGRAM),
        ("edge/cameras/video.py", PROGRAM),
    ],
)
def test_words_and_code_that_makes_no_picture_do_not(name: str, text: str, recipe_now: Callable[[], str], tmp_path: Path) -> None:
    before = recipe_now()
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(text)
    assert recipe_now() == before


def test_every_file_that_it_names_is_there() -> None:
    files = {path.relative_to(recipes._ROOT).as_posix() for path in recipes._files()}
    assert {*recipes._FILES, "edge/simulation/picture/sensor.py", "models/motions/motion.py"} <= files
    assert all((recipes._ROOT / name).is_file() for name in files)
