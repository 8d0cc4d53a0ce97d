"""Taking hold of a port."""

import errno
import socket


class NoAddressError(OSError):
    """The host is no address of this machine, so that no other port would help."""


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens on `port` at `host`, a name or an IPv4 or IPv6 address of this machine.

    Connections of an earlier owner that are only closing do not count. It listens and is not just bound, since Linux lets two
    such sockets be bound to one port for as long as neither does.

    Raises:
        NoAddressError: the host is none, or none of this machine's.
        OSError: the port is taken or forbidden.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    except UnicodeError as error:
        raise NoAddressError(errno.EINVAL, "each part of a name has 1 to 63 characters") from error
    except socket.gaierror as error:
        raise NoAddressError(error.errno, error.strerror) from error
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen()
    except OSError as error:
        listener.close()
        if error.errno == errno.EADDRNOTAVAIL:
            raise NoAddressError(error.errno, error.strerror) from error
        raise
    return listener
