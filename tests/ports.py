"""Ports for the servers of tests: one that is given to a test is no other test's, and no client's."""

import atexit
import itertools
import os
import socket
from pathlib import Path

FIRST = 12_000
BEFORE_CLIENTS = int(Path("/proc/sys/net/ipv4/ip_local_port_range").read_text().split()[0])
"""From here on the system gives ports to whoever connects: one of these can be taken between our look and a server's start."""
if BEFORE_CLIENTS - FIRST < 5_000:
    raise RuntimeError(
        f"clients get ports from {BEFORE_CLIENTS} on (net.ipv4.ip_local_port_range): tests need 12000 to 17000 for servers"
    )

_candidates = itertools.count(os.getpid() * 97)  # processes begin far from each other


def free_port() -> int:
    """A port that nobody listens on, kept from all other tests of this machine for as long as this process lives."""
    for candidate in _candidates:
        port = FIRST + candidate % (BEFORE_CLIENTS - FIRST)
        if _claimed(port) and _unused(port):
            return port
    raise AssertionError("unreachable: there is always another candidate")


def _claimed(port: int) -> bool:
    # A name without a file: it is free again when the process that holds it ends, however it ends.
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(f"\0kinebox-test-port-{port}")
    except OSError:
        claim.close()
        return False
    atexit.register(claim.close)  # until then it is held
    return True


def _unused(port: int) -> bool:
    with socket.socket() as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True
