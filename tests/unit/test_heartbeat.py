"""Heartbeats: often enough to be missed, seldom enough to cost nothing."""

import os

from models.messages import topics
from services.bus.memory import MemoryRouter
from services.support.heartbeat import PERIOD_S, Heartbeat, beating_pid


def test_a_loop_that_goes_round_a_thousand_times_a_second_beats_five_times() -> None:
    router = MemoryRouter()
    beats = router.open().subscribe(topics.ALL_BEATS, keep=1000)
    now_s = 0.0
    beat = Heartbeat("fusion", router.open(), lambda: now_s)
    for millisecond in range(1000):
        now_s = millisecond / 1000
        beat()
    heard = []
    while (delivery := beats.receive(0.0)) is not None:
        heard.append(delivery)
    assert len(heard) == round(1 / PERIOD_S)
    assert {(delivery.topic, beating_pid(delivery.payload)) for delivery in heard} == {("gym/beat/fusion", os.getpid())}


def test_what_is_no_beat_is_nobodys() -> None:
    assert [beating_pid(payload) for payload in (b"", b"-1", b"x", b"\xff", b"1" * 5000, "٣".encode())] == [None] * 6
