"""Heartbeats: often enough to be missed, seldom enough to cost nothing."""

import os

from models.messages import topics
from services.bus.memory import MemoryRouter
from services.support.heartbeat import PERIOD_S, Beat, Heartbeat, read_beat


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
    assert {(delivery.topic, read_beat(delivery.payload)) for delivery in heard} == {
        ("gym/beat/fusion", Beat(os.getpid(), last=False))
    }


def test_the_last_beat_says_that_it_is_the_last() -> None:
    router = MemoryRouter()
    beats = router.open().subscribe(topics.ALL_BEATS, keep=1)
    beat = Heartbeat("fusion", router.open())
    beat()
    beat.last()
    delivery = beats.receive(0.0)
    assert delivery is not None
    assert read_beat(delivery.payload) == Beat(os.getpid(), last=True)


def test_what_is_no_beat_is_nobodys() -> None:
    payloads = (b"", b"-1", b"x", b"\xff", b"1" * 5000, "٣".encode(), b" ends", b"1 ends ends", b"ends 1", b"1" * 5000 + b" ends")
    assert [read_beat(payload) for payload in payloads] == [None] * len(payloads)
