"""Ports that tests give their servers: two tests with the same one fail each other, seldom and without a reason to be seen."""

import socket
import subprocess
import sys
from pathlib import Path

from tests.ports import BEFORE_CLIENTS, free_port

OTHER_PROCESS = """
import sys
from tests import ports
from itertools import count
ports._candidates = count(int(sys.argv[1]) - ports.FIRST)
print(ports.free_port())
"""


def test_another_test_process_that_looks_at_the_same_port_gets_another() -> None:
    ours = free_port()
    other = subprocess.run(
        [sys.executable, "-c", OTHER_PROCESS, str(ours)], cwd=Path(__file__).parents[2], capture_output=True, text=True, check=True
    )
    assert int(other.stdout) > ours


def test_ports_are_free_to_be_listened_on_and_are_never_a_clients() -> None:
    ports = [free_port() for _ in range(20)]
    assert len(set(ports)) == 20
    for port in ports:
        with socket.create_server(("127.0.0.1", port)):
            assert port < BEFORE_CLIENTS
