"""No process outlives the supervisor that started it."""

import ctypes
import os
import signal

_PR_SET_PDEATHSIG = 1


def end_with_parent(parent_pid: int) -> bool:
    """Have the kernel kill this process when its parent dies, however that dies and whatever this process is doing.

    SIGKILL, because a process that hangs would not hear anything milder. Call it first thing: the check that follows
    covers the time before.

    Returns:
        False if the parent is gone already; then leave at once.
    """
    # Linux only; the signal belongs to the parent's thread that forked, so a supervisor must start processes on its main thread.
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    return os.getppid() == parent_pid
