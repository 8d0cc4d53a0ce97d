"""The tablet of the drills, against the page's server as it is."""

import time

import pytest

from tests.browser.room import Room
from tests.faults.client import Client
from tests.integration.waiting import until
from tests.mutations.samples import feedback


@pytest.mark.slow
def test_a_list_of_attempts_is_no_status_and_keeps_none_from_coming() -> None:
    with Room() as room, Client(room.port) as client:
        room.attempt(feedback(time.monotonic_ns()))
        until(lambda: len(client.seen.statuses) >= 6, "statuses that go on")
        assert all(status["type"] == "status" for _, status in client.seen.statuses)
        assert client.status()["rejected_client_messages"] == 0
        assert not client.seen.cut_s
