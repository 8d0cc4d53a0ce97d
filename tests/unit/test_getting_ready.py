"""A first start that compiles for minutes must be told from a process that hangs."""

import threading
import time
from pathlib import Path

import pytest

from models.messages import codec, topics
from models.messages.health import Health
from models.process import ProcessContext
from services.bus import zenoh_bus
from services.bus.memory import MemoryRouter
from services.cli import process
from services.cli.process import ProcessOrder, run_process
from services.supervisor.silence import START_LIMIT_S, Silence
from services.support.getting_ready import getting_ready
from tests.installed import ROOT

DEADLINE_S = 30.0


@pytest.mark.slow
def test_who_takes_long_says_so_again_and_again_and_then_is_silent() -> None:
    router = MemoryRouter()
    heard = router.open().subscribe(topics.health("fusion"), keep=10)
    with getting_ready("fusion", router.open(), quiet_s=0.0):
        first, second = heard.receive(DEADLINE_S), heard.receive(DEADLINE_S)
        assert first is not None
        assert second is not None, "once is not enough: who falls silent has hung"
        health = codec.decode(second.payload, Health)
    assert (health.process, health.state) == ("fusion", "starting")
    assert [trouble.code for trouble in health.troubles] == ["getting_ready"]
    while heard.receive(0.0) is not None:
        pass
    assert heard.receive(1.5) is None


def test_a_usual_start_is_not_worth_a_word() -> None:
    router = MemoryRouter()
    heard = router.open().subscribe(topics.health("fusion"), keep=10)
    with getting_ready("fusion", router.open(), quiet_s=DEADLINE_S):
        pass
    assert heard.receive(0.1) is None


@pytest.mark.slow
def test_who_never_gets_ready_falls_silent_so_that_it_is_found_out() -> None:
    router = MemoryRouter()
    heard = router.open().subscribe(topics.health("fusion"), keep=10)
    with getting_ready("fusion", router.open(), quiet_s=0.0, longest_s=1.0):
        assert heard.receive(DEADLINE_S) is not None
        assert heard.receive(2.5) is None


def test_the_supervisor_waits_for_a_router_that_gets_ready_and_blames_nobody_meanwhile() -> None:
    silence = Silence("fusion")
    for name in ("fusion", "edge-a"):
        silence.start(name, 0.0)
    silence.hear("edge-a", 1.0)
    for second in range(1, 4 * int(START_LIMIT_S), 40):  # its thread may be kept from the CPU for long
        silence.get_ready("fusion", float(second))
        assert silence.hung(second + 39.0) == []
    assert silence.hung(second + START_LIMIT_S + 1.0) == ["fusion"], "who fell silent while getting ready has hung"


@pytest.mark.slow
def test_the_router_can_be_heard_while_its_kernels_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    router = MemoryRouter()
    heard = router.open().subscribe(topics.health("fusion"), keep=1)
    words: list[str] = []

    def compile_for_long(_entry: object) -> object:
        delivery = heard.receive(DEADLINE_S)
        assert delivery is not None, "nothing was heard of a process that compiles"
        words.append(codec.decode(delivery.payload, Health).state)
        return run

    def run(context: ProcessContext) -> None:
        words.append(f"{context.name} runs")

    monkeypatch.setattr(process, "load_process", compile_for_long)
    monkeypatch.setattr(process, "stop_on_signals", threading.Event)
    monkeypatch.setattr(zenoh_bus, "open_router", lambda _endpoint: router.open())
    order = ProcessOrder("fusion", ROOT / "deploy/sites/footage/site.toml", Path("build"), start_ns=time.monotonic_ns())
    run_process(order)
    assert words == ["starting", "fusion runs"]
