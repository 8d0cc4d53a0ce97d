"""The governor trusts this: a quota or a smaller affinity must be seen, or the box plans for CPU that it does not have."""

import os
from pathlib import Path

import pytest

from services.support.cpu import CpuMeter


def test_a_quota_limits_what_is_granted(tmp_path: Path) -> None:
    (tmp_path / "cpu.max").write_text("50000 100000\n")
    (tmp_path / "cpu.stat").write_text("usage_usec 1000000\n")
    assert CpuMeter(tmp_path).granted_cores == pytest.approx(0.5)


def test_a_quota_of_the_parent_counts(tmp_path: Path) -> None:
    (tmp_path / "cpu.max").write_text("100000 100000\n")
    child = tmp_path / "child"
    child.mkdir()
    (child / "cpu.max").write_text("max 100000\n")
    assert CpuMeter(child).granted_cores == pytest.approx(1.0)


def test_without_a_quota_the_affinity_is_granted(tmp_path: Path) -> None:
    assert CpuMeter(tmp_path).granted_cores == len(os.sched_getaffinity(0))


def test_under_a_quota_what_the_whole_group_uses_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seconds = [100.0]
    monkeypatch.setattr("services.support.cpu.time.monotonic", lambda: seconds[0])
    monkeypatch.setattr("services.support.cpu.psutil.cpu_percent", lambda **_: [0.0] * (os.cpu_count() or 1))
    (tmp_path / "cpu.max").write_text("100000 100000\n")
    (tmp_path / "cpu.stat").write_text("usage_usec 1000000\nuser_usec 1\n")
    child = tmp_path / "child"
    child.mkdir()
    (child / "cpu.stat").write_text("usage_usec 0\n")
    meter = CpuMeter(child)
    seconds[0] += 2.0
    (tmp_path / "cpu.stat").write_text("usage_usec 2500000\nuser_usec 1\n")
    assert meter.used_cores() == pytest.approx(0.75)


def test_without_a_quota_what_others_use_on_the_same_cores_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("services.support.cpu.psutil.cpu_percent", lambda **_: [50.0] * (os.cpu_count() or 1))
    meter = CpuMeter(tmp_path)
    assert meter.used_cores() == pytest.approx(0.5 * meter.granted_cores)
