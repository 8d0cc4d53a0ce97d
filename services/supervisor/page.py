"""The page: whether it answers yet, and at which addresses a tablet finds it."""

import socket

import psutil

from models.config.site import TabletConfig
from services.logs.printable import printable

_ANYWHERE = frozenset({"0.0.0.0", "::"})  # noqa: S104 - compared with, not listened on
_TIMEOUT_S = 0.2


def answers(config: TabletConfig, timeout_s: float = _TIMEOUT_S) -> bool:
    """Whether a request for the page gets an answer."""
    host = "127.0.0.1" if config.host in _ANYWHERE else config.host
    try:
        with socket.create_connection((host, config.port), timeout_s) as connection:
            connection.sendall(b"HEAD / HTTP/1.0\r\nHost: localhost\r\n\r\n")
            return connection.recv(5) == b"HTTP/"
    except OSError:
        return False


def addresses(config: TabletConfig) -> list[str]:
    """Where to open the page: on this machine, then from others."""
    if config.host not in _ANYWHERE:
        host = f"[{config.host}]" if ":" in config.host else config.host
        return [f"http://{host}:{config.port}"]
    hosts = ["localhost"]
    hosts += sorted(
        address.address
        for interface in psutil.net_if_addrs().values()
        for address in interface
        if address.family == socket.AF_INET and not address.address.startswith("127.")
    )
    return [f"http://{host}:{config.port}" for host in hosts]


def welcome(name: str, config: TabletConfig) -> str:
    """What the person who started the box is told once the page answers."""
    here, *elsewhere = addresses(config)
    lines = ["", f"  {printable(name)} is running.", "", f"    on this machine   {here}"]
    lines += [f"    on a tablet       {address}" for address in elsewhere]
    return "\n".join([*lines, "", "  Ctrl-C ends it.", ""])
