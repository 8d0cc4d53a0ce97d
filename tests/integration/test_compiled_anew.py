"""A kernel gives the same bits in the process that compiled it and in one that found it compiled: a lesson is recorded by the one
and replayed by the other.

A kernel that is called by another one exists twice while it is compiled, alone and within its caller, where it is optimised
further; the process that compiles may run the one and those that load the other. `models.compiled` says what is done about it.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.installed import ROOT

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]

_ASSEMBLE = """
import hashlib
import numpy as np
from services.fusion.smoothing import Equations
from services.fusion.views import Views
from services.fusion.window import assemble
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

random, rig, knots, depth = np.random.default_rng(0), ring_rig(4), 18, 12
x = np.stack([Person().joints(k / 30).T for k in range(knots)]) + random.normal(0, 0.01, (knots, 3, 17))
times = np.sort(random.uniform(0, knots / 30, (len(rig), depth)), axis=1)
pixels = np.array([[camera.project(Person().joints(t)) for t in own] for camera, own in zip(rig, times)])
pixels += random.normal(0, 3, pixels.shape)
sigma = random.uniform(1, 4, pixels.shape[:3])
ends = np.array([[5, 7], [7, 9], [6, 8], [8, 10], [11, 13], [13, 15], [12, 14], [14, 16]])
spread = np.tile(np.eye(3) * 1e-4, (17, 1, 1)) + random.normal(0, 1e-6, (17, 3, 3))
equations = Equations(knots, 17)
assemble(
    x, np.ones((17, knots), np.bool_), 0.0, 1 / 30, Views.of(rig).projections, times, np.full(len(rig), depth), pixels, sigma,
    np.ones(sigma.shape, np.bool_), 3, np.full(17, 1e5), 2.0, np.full(17, 1e3), 9.0, ends, np.full(8, 0.25), np.full(8, 0.007),
    spread, 16.5, *equations.arrays,
)
print(hashlib.sha256(b"".join(array.tobytes() for array in equations.arrays)).hexdigest(), bool(assemble.stats.cache_misses))
"""


def _assembled(kernels: Path) -> list[str]:
    """What came out, and whether it was compiled."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(kernels), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", _ASSEMBLE]
    done = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, check=True, timeout=200)
    return done.stdout.split()


def test_a_kernel_that_was_just_compiled_gives_the_bits_of_one_that_is_loaded(tmp_path: Path) -> None:
    first, second = _assembled(tmp_path), _assembled(tmp_path)
    assert (first[1], second[1]) == ("True", "False")
    assert first[0] == second[0]
