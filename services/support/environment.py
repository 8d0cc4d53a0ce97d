"""What the environment of every process of the box says."""

from pathlib import Path


def process_environment(data: Path) -> dict[str, str]:
    """One thread each, and the compiled kernels where `make` has put them. The libraries read it when they are imported.

    Args:
        data: folder with networks, footage and kernels.
    """
    return {
        "MKL_NUM_THREADS": "1",
        "NUMBA_CACHE_DIR": str(data.resolve() / "kernels"),
        "NUMBA_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "PYTHONUNBUFFERED": "1",
    }
