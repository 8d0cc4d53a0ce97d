"""A lesson remembers what its motions depend on, and what has become different since is said."""

from pathlib import Path

import pytest

from services.lesson import origin
from services.support.processor import processor

PI = "processor : 0\nFeatures : fp asimd\nprocessor : 1\nFeatures : fp asimd\nModel : Raspberry Pi 5 Model B\n"
XEON = "processor : 0\nmodel name : Xeon; odd\nflags : fpu avx2 sse\n"


def test_this_machine_is_told_the_same_each_time_with_all_that_matters() -> None:
    told = origin.machine()
    assert told == origin.machine()
    assert [fact.split()[0] for fact in told.split("; ")[1:]] == ["Python", "numpy", "scipy", "numba", "llvmlite", "fusion"]
    assert origin.differences(told, told) == []


def test_a_changed_library_is_named() -> None:
    told = origin.machine()
    older = "; ".join("numba 0.1" if fact.startswith("numba") else fact for fact in told.split("; "))
    (words,) = origin.differences(older, told)
    assert words.startswith("recorded with numba 0.1, this is numba ")


def test_a_record_of_another_form_is_told_as_a_whole() -> None:
    assert origin.differences("an old box", "a; b") == ["recorded on an old box; this is a; b"]


@pytest.mark.parametrize(("text", "name"), [(PI, "Raspberry Pi 5 Model B, "), (XEON, "Xeon, odd, ")])
def test_a_processor_is_its_name_and_its_features(tmp_path: Path, text: str, name: str) -> None:
    file = tmp_path / "cpuinfo"
    file.write_text(text)
    told = origin._told(processor(file))
    assert told.startswith(f"{name}features ")
    file.write_text(text.replace("asimd", "").replace("avx2", ""))
    assert origin._told(processor(file)) != told, "a feature that is hidden changes what is compiled"


def test_any_change_of_the_code_shows(tmp_path: Path) -> None:
    for folder in ("models/camera", "services/fusion"):
        (tmp_path / folder).mkdir(parents=True)
    source = tmp_path / "services/fusion/kernel.py"
    source.write_text("A = 1\n")
    before = origin._code(tmp_path)
    source.write_text("A = 2\n")
    assert origin._code(tmp_path) != before
