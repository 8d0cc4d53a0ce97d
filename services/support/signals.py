"""Being told to stop, and the names of signals."""

import os
import signal
import socket
import threading
import time

SAME_WISH_S = 0.5
"""Signals that come so soon after the first are no second wish: `timeout` and a closed terminal send one to the process and one to
its group."""
_STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def stop_on_signals() -> threading.Event:
    """An event that the first SIGINT, SIGTERM or SIGHUP sets; one that comes `SAME_WISH_S` later ends the process at once.

    Call it on the main thread. Python's own handlers run there between two instructions: they wait for long calls into
    compiled code, and setting an event in one can wait for ever for a lock that the interrupted instruction holds. So the
    signal's number goes through a socket to a thread, which Python does without the main thread. A signal that the
    caller has this process ignore (nohup) stays ignored.
    """
    stop = threading.Event()
    receiver, sender = socket.socketpair()
    sender.setblocking(False)
    signal.set_wakeup_fd(sender.fileno(), warn_on_full_buffer=False)
    for number in _STOP_SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _leave_to_thread)

    def wait() -> None:
        with sender:  # Kept open for as long as the process lives.
            receiver.recv(1)
            stop.set()
            first_s = time.monotonic()
            number = receiver.recv(1)[0]
            while time.monotonic() - first_s < SAME_WISH_S:
                number = receiver.recv(1)[0]
            os._exit(128 + number)

    threading.Thread(target=wait, name="signals", daemon=True).start()
    return stop


def signal_name(number: int) -> str:
    """What a signal is called: SIGKILL; "signal 40" if it has no name, as those for real time."""
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def _leave_to_thread(_number: int, _frame: object) -> None:
    pass
