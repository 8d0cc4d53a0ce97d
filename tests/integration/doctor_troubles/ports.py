"""Ports that somebody else has."""

import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from services.doctor.finding import Examined
from tests.integration.box import Box
from tests.integration.doctor_troubles.trouble import Trouble, examined
from tests.integration.house import build_house, replace_text
from tests.integration.waiting import until


@contextmanager
def port_taken_by_a_program(folder: Path) -> Iterator[Examined]:
    house = build_house(folder)
    command = [sys.executable, "-m", "http.server", str(house.page_port), "--bind", "127.0.0.1", "--directory", str(folder)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as program:
        try:
            until(lambda: _answers(house.page_port), "the program to listen")
            yield examined(house)
        finally:
            program.kill()


def _answers(port: int) -> bool:
    with suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
        return True
    return False


@contextmanager
def port_taken_by_another_box(folder: Path) -> Iterator[Examined]:
    (folder / "other").mkdir()
    (folder / "own").mkdir()
    with Box(folder / "other") as box:
        box.wait_page()
        house = build_house(folder / "own")
        replace_text(house.site, f"port = {house.page_port}", f"port = {box.page_port}")
        yield examined(house)


PORTS: dict[str, Trouble] = {
    "another program has the page's port": Trouble(
        port_taken_by_a_program, "port of the page", r"is taken by .*http\.server .*\(process \d+\)", r"kill \d+"
    ),
    "another KineBox has the page's port": Trouble(
        port_taken_by_another_box, "port of the page", r"is taken by another KineBox, of .*other/site\.toml", r"kill \d+"
    ),
}
