"""What a test starts ends with the test runner, also when that is killed and can end nothing.

`python -m tests.lifeline PID COMMAND ...` becomes the command, which the kernel kills when the process PID, its parent, is gone.
The supervisor's processes end with the supervisor by themselves.
"""

import os
import sys
from collections.abc import Sequence

from services.supervisor.lifeline import end_with_parent


def bound(command: Sequence[str]) -> list[str]:
    """The command line by which a command ends with this process; to be started on the main thread, in the project's folder."""
    return [sys.executable, "-m", "tests.lifeline", str(os.getpid()), *command]


if __name__ == "__main__":
    if end_with_parent(int(sys.argv[1])):
        os.execvp(sys.argv[2], sys.argv[2:])  # noqa: S606 - the command is the test's own
