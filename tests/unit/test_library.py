"""Networks are there when they are needed, and a switch never stops the pictures."""

import threading
from collections.abc import Callable
from dataclasses import dataclass

import pytest

from edge.library import RETRY_NS, Library
from models.errors import UserError
from models.messages.control import PoseNetwork as PoseNetworkName
from tests.fake_networks import FakeDetector, FakePose


class FailsOnce:
    """Loads every network, but lightning not at the first attempt."""

    def __init__(self, error: Exception) -> None:
        self.attempts: list[PoseNetworkName] = []
        self._error = error

    def __call__(self, name: PoseNetworkName) -> FakePose:
        self.attempts.append(name)
        if name == "lightning" and self.attempts.count(name) == 1:
            raise self._error
        return FakePose(name)


DAMAGED = UserError("network movenet-lightning is damaged")


def test_all_networks_are_loaded_before_the_first_picture_so_that_none_is_when_the_machine_is_busy() -> None:
    loaded: list[PoseNetworkName] = []

    def load(name: PoseNetworkName) -> FakePose:
        loaded.append(name)
        return FakePose(name)

    library = Library(load, FakeDetector, "thunder")
    assert loaded == ["thunder", "lightning"]
    assert [library.pose(name).name for name in ("lightning", "thunder")] == ["lightning", "thunder"]
    assert len(loaded) == 2


def test_a_network_that_could_not_be_loaded_is_loaded_beside_the_one_that_goes_on() -> None:
    gate, once = threading.Event(), FailsOnce(DAMAGED)

    def load(name: PoseNetworkName) -> FakePose:
        loaded = once(name)
        if name == "lightning":
            gate.wait(30)
        return loaded

    clock = StoppedClock()
    library = Library(load, FakeDetector, "thunder", clock)
    clock.t_ns = RETRY_NS
    assert library.pose("lightning").name == "thunder"
    assert library.pose("lightning").name == "thunder"
    gate.set()
    wait_for(lambda: library.pose("lightning").name == "lightning")
    assert library.current == "lightning"
    assert library.problem == ""


def test_a_network_that_cannot_be_loaded_is_reported_and_the_other_goes_on() -> None:
    attempts = []

    def load(name: PoseNetworkName) -> FakePose:
        attempts.append(name)
        if name == "lightning":
            raise DAMAGED
        return FakePose(name)

    library = Library(load, FakeDetector, "thunder")
    assert library.problem == "network movenet-lightning is damaged"
    assert library.pose("lightning").name == "thunder"
    assert attempts == ["thunder", "lightning"]


@dataclass
class StoppedClock:
    t_ns: int = 0

    def now_ns(self) -> int:
        return self.t_ns

    def sleep_until(self, t_ns: int) -> None:
        self.t_ns = t_ns


def test_a_network_that_nobody_asks_for_is_tried_again_too_so_that_its_failure_is_not_reported_for_ever() -> None:
    clock = StoppedClock()
    library = Library(FailsOnce(DAMAGED), FakeDetector, "thunder", clock)
    clock.t_ns = RETRY_NS
    assert library.pose("thunder").name == "thunder"
    wait_for(lambda: library.problem == "")
    assert library.current == "thunder"


def test_any_failure_is_reported_in_one_line_and_tried_again_after_a_while() -> None:
    load, clock = FailsOnce(RuntimeError("no memory\nfor the weights")), StoppedClock()
    library = Library(load, FakeDetector, "thunder", clock)
    assert library.problem.startswith("network lightning cannot be loaded (RuntimeError: no memory for the weights)")
    clock.t_ns = RETRY_NS - 1
    assert library.pose("lightning").name == "thunder"
    assert load.attempts == ["thunder", "lightning"]
    clock.t_ns = RETRY_NS
    library.pose("lightning")
    wait_for(lambda: library.pose("lightning").name == "lightning")
    wait_for(lambda: not loading_threads())
    assert load.attempts == ["thunder", "lightning", "lightning"]
    assert library.problem == ""


def loading_threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "load-lightning"]


def test_without_its_first_network_a_camera_does_not_start() -> None:
    def load(name: PoseNetworkName) -> FakePose:
        raise UserError(f"network movenet-{name}: missing")

    with pytest.raises(UserError, match="movenet-thunder"):
        Library(load, FakeDetector, "thunder")


def test_the_detector_is_loaded_at_its_first_use_and_once() -> None:
    made = []

    def load() -> FakeDetector:
        made.append(FakeDetector())
        return made[-1]

    library = Library(FakePose, load, "thunder")
    assert made == []
    assert library.detector() is library.detector()
    assert len(made) == 1


def wait_for(condition: Callable[[], bool]) -> None:
    pause = threading.Event()
    for _ in range(3000):
        if condition():
            return
        pause.wait(0.01)
    pytest.fail("waited 30 s in vain")
