"""Run as a process of its own (`python -m services.doctor.kernels`): which kernels are compiled for this code and this processor.

It prints a line of JSON. Nothing is compiled: numba's index of each kernel is read, which holds for one version of the kernel's
file and one kind of processor. A process of its own, because numba reads when it is imported where the kernels are.
"""

import importlib
import json
import pkgutil
import sys
from collections.abc import Iterator
from types import ModuleType
from typing import Any

from numba.core.dispatcher import Dispatcher

from services import evaluation, fusion


def main() -> None:
    """Print how many kernels there are and which lack compiled code, callees of other kernels left out."""
    kernels = list(_entry_kernels())
    lacking = [f"{kernel.__module__.rsplit('.', 1)[-1]}.{kernel.__name__}" for kernel in kernels if not is_compiled(kernel)]
    sys.stdout.write(json.dumps({"kernels": len(kernels), "lacking": lacking}) + "\n")


def _entry_kernels() -> Iterator[Any]:
    for package in (fusion, evaluation):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not found.name.endswith(".process"):
                yield from _of_module(importlib.import_module(found.name))


def _of_module(module: ModuleType) -> Iterator[Any]:
    kernels: list[Any] = [
        value for value in vars(module).values() if isinstance(value, Dispatcher) and value.__module__ == module.__name__
    ]
    # A kernel that others call becomes part of them, and has code of its own only if it is called from Python too.
    called = {name for kernel in kernels for name in kernel.py_func.__code__.co_names}
    yield from (kernel for kernel in kernels if kernel.__name__ not in called)


def is_compiled(kernel: Any) -> bool:
    """Whether compiled code of a kernel is on disk, for this version of its file and this processor, whatever the types."""
    # Numba offers no public way to ask; tests/unit/test_kernels.py compiles and asks, so that another numba cannot make this wrong.
    index = kernel._cache._cache_file._load_index()
    processor = kernel.targetctx.codegen().magic_tuple()
    return any(key[1] == processor for key in index)


if __name__ == "__main__":
    main()
