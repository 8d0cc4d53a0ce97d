"""Where the bus is: "tcp/127.0.0.1:7447"."""

from models.errors import UserError


def split_endpoint(endpoint: str) -> tuple[str, int]:
    """Host and port of the bus; UserError if the port is none."""
    host, _, port = endpoint.removeprefix("tcp/").rpartition(":")
    if not 0 < int(port) < 2**16:
        raise UserError(f"port of the bus: {port} is no port (1 to 65535); change bus.endpoint in the site file")
    return host.strip("[]"), int(port)
