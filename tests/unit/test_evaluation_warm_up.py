"""The first attempt of a day waits for nothing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.installed import ROOT

ASK = """
from services.doctor.kernels import is_compiled
from services.evaluation import alignment, following
from services.evaluation.warm_up import warm_up
from tests.taught import shipped

kernels = (alignment._accumulated, alignment._path, alignment._advance, following._steps, following._backwards)
assert not any(map(is_compiled, kernels)), "another test has compiled for this one"
warm_up(shipped())
print([kernel.__name__ for kernel in kernels if not is_compiled(kernel)])
"""


@pytest.mark.slow
def test_every_kernel_of_the_evaluation_is_compiled_before_the_first_attempt(tmp_path: Path) -> None:
    """On a box on which nothing is compiled: whether it is, is asked of the disk, where earlier runs leave it."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path)}
    words = [sys.executable, "-c", ASK]
    found = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=100, check=False)
    assert (found.stdout, found.returncode) == ("[]\n", 0), found.stderr
