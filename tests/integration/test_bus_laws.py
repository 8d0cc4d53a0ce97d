"""What a process may rely on, whichever bus it is given: every law runs over Zenoh's sockets and over the in-memory twin."""

import threading
from collections.abc import Callable, Iterator

import pytest

from models.process import Bus, Subscription
from services.bus.memory import MemoryRouter
from services.bus.zenoh_bus import open_client, open_router
from tests.integration.waiting import heard, until
from tests.ports import free_port

Open = Callable[[], Bus]


@pytest.fixture(params=["memory", "zenoh"])
def open_bus(request: pytest.FixtureRequest) -> Iterator[Open]:
    """Opens one more bus, as of one more process; the first is the router's."""
    buses: list[Bus] = []
    memory = MemoryRouter()
    endpoint = f"tcp/127.0.0.1:{free_port()}"

    def open_one() -> Bus:
        bus: Bus | None
        if request.param == "memory":
            bus = memory.open()
        elif not buses:
            bus = open_router(endpoint)
        else:
            bus = open_client(endpoint, threading.Event())
        assert bus is not None
        buses.append(bus)
        return bus

    yield open_one
    for bus in reversed(buses):
        bus.close()


def unread(subscription: Subscription) -> list[tuple[str, bytes]]:
    found = []
    while (delivery := subscription.receive(0.0)) is not None:
        found.append((delivery.topic, delivery.payload))
    return found


def test_messages_of_a_topic_keep_their_order(open_bus: Open) -> None:
    receiver, sender = open_bus(), open_bus()
    subscription = receiver.subscribe("gym/a", keep=100)
    heard(sender, subscription, "gym/a")
    for number in range(100):
        sender.publish("gym/a", b"%d" % number)
    received = [subscription.receive(10.0) for _ in range(100)]
    assert [int(delivery.payload) for delivery in received if delivery] == list(range(100))


def test_between_two_clients_messages_pass_the_router(open_bus: Open) -> None:
    open_bus()
    receiver, sender = open_bus(), open_bus()
    subscription = receiver.subscribe("gym/a", keep=2)
    heard(sender, subscription, "gym/a")


def test_a_process_hears_itself(open_bus: Open) -> None:
    bus = open_bus()
    subscription = bus.subscribe("gym/a", keep=2)
    bus.publish("gym/a", b"x")
    delivery = subscription.receive(10.0)
    assert delivery is not None
    assert (delivery.topic, delivery.payload) == ("gym/a", b"x")


def test_a_slow_reader_finds_the_newest_of_each_topic_and_no_more(open_bus: Open) -> None:
    receiver, sender = open_bus(), open_bus()
    slow = receiver.subscribe("gym/camera/*", keep=2)
    witness = receiver.subscribe("gym/camera/*", "gym/end", keep=2000)
    heard(sender, witness, "gym/end")
    sender.publish("gym/camera/rare", b"only")
    for number in range(1000):
        sender.publish("gym/camera/busy", b"%d" % number)
    sender.publish("gym/end", b"")
    until(lambda: (delivery := witness.receive(1.0)) is not None and delivery.topic == "gym/end", "the end of the flood")
    found = unread(slow)
    assert [payload for topic, payload in found if topic == "gym/camera/rare"] == [b"only"]
    assert [payload for topic, payload in found if topic == "gym/camera/busy"] == [b"998", b"999"]


def test_topics_take_turns(open_bus: Open) -> None:
    receiver, sender = open_bus(), open_bus()
    subscription = receiver.subscribe("gym/camera/*", keep=3)
    witness = receiver.subscribe("gym/end", keep=2)
    heard(sender, witness, "gym/end")
    heard(sender, subscription, "gym/camera/a")
    for topic in ("gym/camera/a", "gym/camera/b"):
        for number in range(3):
            sender.publish(topic, b"%d" % number)
    sender.publish("gym/end", b"")
    assert witness.receive(10.0) is not None
    assert [(topic[-1], int(payload)) for topic, payload in unread(subscription)] == [
        ("a", 0),
        ("b", 0),
        ("a", 1),
        ("b", 1),
        ("a", 2),
        ("b", 2),
    ]


def test_a_wildcard_means_one_level_and_nothing_beside_it(open_bus: Open) -> None:
    receiver, sender = open_bus(), open_bus()
    subscription = receiver.subscribe("gym/camera/*/observation", "gym/end", keep=10)
    heard(sender, subscription, "gym/end")
    for topic in ("gym/camera/a/control", "gym/camera/a/b/observation", "gym/camera/observation", "gym/camera/a/observation"):
        sender.publish(topic, b"")
    sender.publish("gym/end", b"")
    topics: list[str] = []
    while not topics or topics[-1] != "gym/end":
        delivery = subscription.receive(10.0)
        assert delivery is not None
        topics.append(delivery.topic)
    assert topics == ["gym/camera/a/observation", "gym/end"]


def test_who_subscribes_late_gets_what_comes_and_nothing_old(open_bus: Open) -> None:
    receiver, sender = open_bus(), open_bus()
    witness = receiver.subscribe("gym/a", keep=2)
    heard(sender, witness, "gym/a")
    sender.publish("gym/a", b"old")
    assert witness.receive(10.0) is not None
    late = receiver.subscribe("gym/a", keep=10)
    sender.publish("gym/a", b"new")
    delivery = late.receive(10.0)
    assert delivery is not None
    assert delivery.payload == b"new"


def test_receiving_ends_with_its_timeout_and_with_close(open_bus: Open) -> None:
    bus = open_bus()
    subscription = bus.subscribe("gym/a", keep=1)
    assert subscription.receive(0.0) is None
    assert subscription.receive(0.02) is None
    waiting = threading.Thread(target=subscription.receive, args=(3600.0,))
    waiting.start()
    subscription.close()
    waiting.join(30.0)
    assert not waiting.is_alive()


def test_a_closed_subscription_receives_nothing_more(open_bus: Open) -> None:
    bus = open_bus()
    closed, other = bus.subscribe("gym/a", keep=1), bus.subscribe("gym/a", keep=1)
    closed.close()
    bus.publish("gym/a", b"x")
    assert other.receive(10.0) is not None
    assert closed.receive(0.0) is None


def test_keeping_nothing_is_refused(open_bus: Open) -> None:
    with pytest.raises(ValueError, match="at least 1"):
        open_bus().subscribe("gym/a", keep=0)


def test_tokens_appear_to_early_and_late_watchers_and_go_with_their_bus(open_bus: Open) -> None:
    early, member = open_bus(), open_bus()
    seen_early: list[tuple[str, bool]] = []
    early.watch_alive("gym/alive/*", lambda topic, alive: seen_early.append((topic, alive)))
    member.declare_alive("gym/alive/edge-a")
    until(lambda: seen_early == [("gym/alive/edge-a", True)], "the token")

    late = open_bus()
    seen_late: list[tuple[str, bool]] = []
    late.watch_alive("gym/alive/*", lambda topic, alive: seen_late.append((topic, alive)))
    until(lambda: seen_late == [("gym/alive/edge-a", True)], "the token that was there before")

    member.close()
    gone = [("gym/alive/edge-a", True), ("gym/alive/edge-a", False)]
    until(lambda: seen_early == gone and seen_late == gone, "the token to go")


def test_watching_one_part_of_the_room_is_not_told_of_another(open_bus: Open) -> None:
    watcher, member = open_bus(), open_bus()
    seen: list[tuple[str, bool]] = []
    watcher.watch_alive("gym/alive/*", lambda topic, alive: seen.append((topic, alive)))
    member.declare_alive("gym/elsewhere/edge-a")
    member.declare_alive("gym/alive/edge-b")
    until(lambda: bool(seen), "a token")
    assert seen == [("gym/alive/edge-b", True)]
