"""What holds for all tests."""

import gc
import signal
from collections.abc import Generator

import pytest
from hypothesis import HealthCheck, settings

# No test is timed: a machine that is busy, or that imports and compiles for the first time, breaks no law.
settings.register_profile("kinebox", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("kinebox")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """What is imported stays to the end: looking through it for garbage again and again took two of each process's five seconds."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What takes longest begins first: begun last, it would be waited for alone. Files, and the tests of each, keep their order."""
    items.sort(key=lambda item: item.path.parent.name != "integration")


# Whatever runs the tests (nohup, a shell's background job) may have left these ignored, which children inherit and keep to.
for _number in (signal.SIGINT, signal.SIGHUP):
    if signal.getsignal(_number) is signal.SIG_IGN:
        signal.signal(_number, signal.default_int_handler if _number is signal.SIGINT else signal.SIG_DFL)
