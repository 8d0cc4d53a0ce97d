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


def test_what_is_used_never_exceeds_what_is_granted_without_a_quota(tmp_path: Path) -> None:
    meter = CpuMeter(tmp_path)
    assert 0 <= meter.used_cores() <= meter.granted_cores
