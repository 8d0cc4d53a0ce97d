"""The one way in which hot loops are compiled.

Compiled code is kept on disk, so that only the first start of a box compiles. Numba's cache watches the file of the compiled
function and no other: a kernel that called one of another file would stay stale when that other file changed. So a kernel
calls only kernels of its own file, at the price of a few lines of projection that three files repeat
(`tests/unit/test_kernels.py` enforces it).
"""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba
import numpy as np
import numpy.typing as npt

Counts = npt.NDArray[np.int64]
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

_REORDERING = {"reassoc", "contract", "nsz", "arcp"}
"""Sums may be reordered and fused, so that they vectorise; infinities and NaN keep their meaning."""


def compiled(function: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Compile on first call for the types given; divisions by zero give infinities, as in numpy.

    A kernel is part of its callers (`forceinline`). As a function of its own it would be there twice where it is compiled, alone
    and within a caller that optimises it further; the process that compiles could run the one and those that load the other, and
    a lesson that the one recorded would not replay in the other to the last bit.
    """
    compiler = numba.njit(cache=True, error_model="numpy", fastmath=_REORDERING, forceinline=True)
    kernel: Callable[Arguments, Result] = compiler(function)
    return kernel
