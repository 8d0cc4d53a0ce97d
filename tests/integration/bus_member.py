"""A process on the bus, for tests that kill it: `python -m tests.integration.bus_member (router|client) ENDPOINT TOKEN`.

It holds a token, echoes what comes on `gym/ask` to `gym/answer`, and says "ready" on stdout.
"""

import sys
import threading

from services.bus.zenoh_bus import open_client, open_router


def main() -> None:
    role, endpoint, token = sys.argv[1:]
    bus = open_router(endpoint) if role == "router" else open_client(endpoint, threading.Event())
    assert bus is not None
    bus.declare_alive(token)
    questions = bus.subscribe("gym/ask", keep=8)
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    while True:
        delivery = questions.receive(1.0)
        if delivery is not None:
            bus.publish("gym/answer", delivery.payload)


if __name__ == "__main__":
    main()
