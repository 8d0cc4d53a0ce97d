"""Each peer's own environment, made by `make build/peers/<name>/.ready` from its lock file."""

import os
import subprocess
from collections.abc import Sequence
from pathlib import Path

_ENVIRONMENTS = Path("build/peers")


def environment_of(name: str) -> Path:
    """The folder of a peer's environment."""
    return _ENVIRONMENTS / name


def is_installed(name: str) -> bool:
    """Whether a peer's environment is complete."""
    return (environment_of(name) / ".ready").is_file()


def run_in(name: str, arguments: Sequence[str]) -> str:
    """Run the peer's `run.py` in its environment; the last line that it prints.

    Raises:
        RuntimeError: it failed; with the end of what it wrote.
    """
    # On one thread, as we are, so that CPU and wall time can be compared.
    environment = os.environ | {"MPLBACKEND": "Agg", "QT_QPA_PLATFORM": "offscreen", "OMP_NUM_THREADS": "1", "JAX_PLATFORMS": "cpu"}
    for variable in ("PYTHONPATH", "PYTHONHOME"):
        environment.pop(variable, None)
    python = (environment_of(name) / "bin/python").absolute()
    result = subprocess.run(
        [str(python), str(Path(__file__).parent / name / "run.py"), *arguments],
        capture_output=True, text=True, check=False, env=environment,
    )  # fmt: skip
    if result.returncode != 0:
        raise RuntimeError(f"{name} failed:\n{result.stderr[-3000:]}")
    return result.stdout.strip().splitlines()[-1]
