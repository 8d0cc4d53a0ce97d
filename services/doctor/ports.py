"""The ports that a site needs: free, held by its own running box, or by whom."""

import errno
from dataclasses import dataclass

import psutil

from models.config.endpoint import split_endpoint
from models.config.site import Site
from models.errors import UserError
from services.doctor.finding import Examined, Fact, Finding, fault_of
from services.doctor.processes import RunningBox
from services.supervisor.preflight import require_ports
from services.support.listening import listen


@dataclass(frozen=True)
class Port:
    """One port of a site.

    Attributes:
        what: "page" or "bus".
        key: of the site file.
        taken: somebody listens there.
        pid: who, if that can be seen.
        program: that process's command line, or its name.
        ours: it is the box of this site.
        other_site: it is the box of another site, of this file.
    """

    what: str
    key: str
    number: int
    taken: bool = False
    pid: int | None = None
    program: str = ""
    ours: bool = False
    other_site: str = ""


@dataclass(frozen=True)
class Ports:
    """What was gathered. `error` is why they could not be had although nobody has taken one."""

    ports: tuple[Port, ...]
    error: str = ""


def gather_ports(site: Site, own: RunningBox | None, boxes: list[RunningBox]) -> Ports:
    """Try both ports, and look up who has those that are taken."""
    try:
        bus_host, bus_port = split_endpoint(site.bus.endpoint)
    except UserError as error:
        return Ports((), str(error))
    wanted = (("page", "tablet.port", site.tablet.host, site.tablet.port), ("bus", "bus.endpoint", bus_host, bus_port))
    ports = tuple(_look_up(what, key, host, number, own, boxes) for what, key, host, number in wanted)
    if any(port.taken for port in ports):
        return Ports(ports)
    try:
        require_ports(site)
    except UserError as error:
        return Ports(ports, str(error))
    return Ports(ports)


def judge_ports(ports: Ports) -> Examined:
    """What is wrong with them, and who has them."""
    findings = [fault_of("ports", ports.error, "listening on them as a start of the box does")] if ports.error else []
    findings += [_taken(port) for port in ports.ports if port.taken and not port.ours]
    words = "; ".join(f"{port.what} {port.number} {_state(port)}" for port in ports.ports)
    return Examined(tuple(findings), (Fact("ports", words),) if words else ())


def _taken(port: Port) -> Finding:
    if port.other_site:
        words = f"port {port.number} of the {port.what} is taken by another KineBox, of {port.other_site} (process {port.pid})"
        remedy = f"end that box (kill {port.pid}), or change {port.key} in one of the two site files"
    elif port.pid is not None:
        words = f"port {port.number} of the {port.what} is taken by {port.program} (process {port.pid})"
        remedy = f"end that program (kill {port.pid}), or change {port.key} in the site file"
    else:
        words = f"port {port.number} of the {port.what} is taken by a program of another user"
        remedy = f"find it with `sudo ss -ltnp 'sport = :{port.number}'` and end it, or change {port.key} in the site file"
    return Finding("fault", f"port of the {port.what}", words, "listening on it, and looking up its owner", remedy)


def _state(port: Port) -> str:
    if not port.taken:
        return "free"
    return f"held by this box (process {port.pid})" if port.ours else "taken"


def _look_up(what: str, key: str, host: str, number: int, own: RunningBox | None, boxes: list[RunningBox]) -> Port:
    if not _is_taken(host, number):
        return Port(what, key, number)
    pid = _listener(number)
    owner = next((box for box in boxes if pid is not None and box.owns(pid)), None)
    ours = owner is not None and owner is own
    other = str(owner.site) if owner is not None and not ours else ""
    return Port(what, key, number, taken=True, pid=pid, program=_program(pid), ours=ours, other_site=other)


def _is_taken(host: str, number: int) -> bool:
    try:
        listen(host, number).close()
    except OSError as error:
        return error.errno == errno.EADDRINUSE  # Of a wrong address `require_ports` says so.
    return False


def _listener(number: int) -> int | None:
    """Process that listens on a TCP port; None if that cannot be seen."""
    try:
        connections = psutil.net_connections("tcp")
    except psutil.Error:
        return None
    listeners = [one for one in connections if one.status == psutil.CONN_LISTEN and one.laddr and one.laddr.port == number]
    return next((one.pid for one in listeners if one.pid is not None), None)


def _program(pid: int | None) -> str:
    try:
        process = psutil.Process(pid) if pid is not None else None
        return (" ".join(process.cmdline())[:80] or process.name()) if process is not None else ""
    except psutil.Error:
        return "a program that has just ended"
