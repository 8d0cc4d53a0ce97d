"""What can be the name or the address of a machine, as far as that can be said without a network."""

from models.errors import UserError

_LONGEST = 253
"""Of a whole name (RFC 1035)."""


def require_host(host: str, key: str) -> None:
    """Raise UserError if nothing could ever be looked up by it: Python and the bus would not even ask.

    Args:
        host: a name, or an IPv4 or IPv6 address.
        key: of the site file, for the message.
    """
    try:
        host.encode("idna")
    except UnicodeError as error:
        raise UserError(f"{key} is no name and no address of a machine: each part has 1 to 63 characters; correct it") from error
    if not 0 < len(host) <= _LONGEST or not host.isprintable():
        raise UserError(f"{key} is no name and no address of a machine: it has 1 to {_LONGEST} characters; correct it")
