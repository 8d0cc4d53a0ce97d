"""The first attempt of a day waits for nothing."""

from services.doctor.kernels import is_compiled
from services.evaluation import alignment
from services.evaluation.warm_up import warm_up
from tests.taught import shipped


def test_every_kernel_of_the_evaluation_is_compiled_before_the_first_attempt() -> None:
    warm_up(shipped())
    kernels = (alignment._accumulated, alignment._path, alignment._advance)
    assert [kernel.__name__ for kernel in kernels if not is_compiled(kernel)] == []
