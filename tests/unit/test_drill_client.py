"""The tablet of the drills, against the page's server as it is."""

import time

import pytest

from tests.browser.room import Room
from tests.faults.client import Client
from tests.integration.waiting import until
from tests.mutations.samples import feedback

FAULT_S, OVER_S = 100.0, 104.0


def client(*away: tuple[float, float]) -> Client:
    """Has seen a figure every 0.1 s for 40 s but in these times."""
    made = Client(0)
    times = [90.0 + 0.1 * step for step in range(400)]
    made.seen.figures_s = [at for at in times if not any(begin <= at < end for begin, end in away)]
    return made


@pytest.mark.parametrize(
    ("away", "recovery_s"),
    [
        ((), 0.0),
        (((100.0, 102.0),), 2.0),
        (((102.0, 122.0),), 20.1),  # long after the begin of a fault that lasts
        (((105.0, 107.0),), 2.1),  # just after its end
        (((101.0, 102.0), (102.5, 104.0)), 4.0),  # it came back for half a second only
        (((100.0, 101.0), (103.0, 105.0)), 2.1),
        (((107.0, 120.0),), 0.0),  # not the fault's any more
        (((95.0, 99.0),), 0.0),
    ],
)
def test_a_figure_that_a_fault_takes_away_at_any_time_counts_as_long_as_it_is_away(
    away: tuple[tuple[float, float], ...], recovery_s: float
) -> None:
    assert client(*away).recovery_s(FAULT_S, OVER_S) == pytest.approx(recovery_s, abs=0.11)


@pytest.mark.slow
def test_a_list_of_attempts_is_no_status_and_keeps_none_from_coming() -> None:
    with Room() as room, Client(room.port) as client:
        room.attempt(feedback(time.monotonic_ns()))
        until(lambda: len(client.seen.statuses) >= 6, "statuses that go on")
        assert all(status["type"] == "status" for _, status in client.seen.statuses)
        assert client.status()["rejected_client_messages"] == 0
        assert not client.seen.cut_s
