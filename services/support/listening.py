"""Taking hold of a port."""

import socket


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens on `port` at `host`, a name or an IPv4 or IPv6 address of this machine.

    Connections of an earlier owner that are only closing do not count. It listens and is not just bound, since Linux lets two
    such sockets be bound to one port for as long as neither does.

    Raises:
        socket.gaierror: the host is none.
        OSError: the port is taken or forbidden, or the address is none of this machine's.
    """
    family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen()
    except OSError:
        listener.close()
        raise
    return listener
