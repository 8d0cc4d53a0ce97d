"""Everything that can be checked before a process is started, so that nothing is ever half started."""

import socket
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from models.camera.rig import Rig
from models.config.endpoint import split_endpoint
from models.config.site import Site
from models.errors import UserError
from models.process import Check
from services.site_file.reading import read_site
from services.support.listening import NoAddressError, listen

_LAST_PORT = 65535


def check_everything(site_file: Path, data: Path, checks: Iterable[Check]) -> tuple[Site, Rig]:
    """Read the site with its calibration and check what it needs: what the parts say, then the ports.

    Args:
        site_file: the site file.
        data: folder with networks and footage.
        checks: what the parts want checked; each raises UserError.

    Raises:
        UserError: the first fault found.
    """
    site, rig = read_site(site_file)
    for check in checks:
        check(site, rig, data)
    require_ports(site)
    return site, rig


def require_ports(site: Site) -> None:
    """Raise UserError unless the page and the bus can be listened on at the same time, as they will be."""
    bus_host, bus_port = split_endpoint(site.bus.endpoint)
    bus = _Port(bus_host, bus_port, "port of the bus", "bus.endpoint", "bus.endpoint")
    with _Port(site.tablet.host, site.tablet.port, "port of the page", "tablet.port", "tablet.host").hold():
        try:
            bus.hold().close()
        except UserError:
            if bus.number != site.tablet.port:
                raise
        else:
            return
    # Somebody else's, or the page's own?
    bus.hold().close()
    raise UserError(f"port {bus.number} is both the page's and the bus's; change tablet.port or bus.endpoint in the site file")


class _Port(NamedTuple):
    """A port that the box needs; `key` of the site file is what to change, `host_key` if it is the address that is wrong."""

    host: str
    number: int
    what: str
    key: str
    host_key: str

    def hold(self) -> socket.socket:
        """Listen on it; UserError if that cannot be."""
        try:
            return listen(self.host, self.number)
        except NoAddressError as error:
            raise UserError(
                f"{self.what}: '{self.host}' is no address of this machine ({error.strerror}); "
                f"change {self.host_key} in the site file"
            ) from error
        except OSError as error:
            raise UserError(
                f"{self.what}: {self.number} on {self.host} cannot be used ({error.strerror}); stop what uses it, "
                f"perhaps another KineBox, or change {self.key} in the site file ({self._written()})"
            ) from error

    def _written(self) -> str:
        """How another port is written there."""
        table, name = self.key.split(".")
        number = self.number + (1 if self.number < _LAST_PORT else -1)
        value = f'"tcp/{self.host}:{number}"' if name == "endpoint" else str(number)
        return f"[{table}], and below it {name} = {value}"
