"""`make run` is not silent while the kernels are compiled."""

import time

import pytest

from services.cli import compile_kernels as compiling
from services.evaluation import process as evaluation
from services.fusion import process as fusion


def test_who_waits_for_the_kernels_reads_that_they_are_still_being_compiled(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    prepared: list[str] = []

    def take_long() -> None:
        time.sleep(0.3)
        prepared.append("fusion")

    monkeypatch.setattr(compiling, "_EVERY_S", 0.02)
    monkeypatch.setattr(fusion, "prepare", take_long)
    monkeypatch.setattr(evaluation, "prepare", lambda: prepared.append("evaluation"))
    compiling.compile_kernels()
    assert prepared == ["fusion", "evaluation"]
    told = capsys.readouterr().err.splitlines()
    assert len(told) > 1
    assert all(line.startswith("... still compiling numerical kernels, for ") for line in told)
