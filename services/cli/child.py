"""The command line of a process that the supervisor starts.

It does as `kinebox process` does and takes the same options, but has no help to offer: importing what `kinebox` needs for that
costs 80 ms of CPU, six times at every start of the box.
"""

import argparse
import sys
from functools import partial
from pathlib import Path

import msgspec

# structlog imports rich wherever that is installed, to colour tracebacks on a terminal: 50 ms of CPU in each process of the box,
# whose log is lines of JSON. None is how Python is told that there is no such module.
if __name__ == "__main__":
    sys.modules["rich"] = None  # type: ignore[assignment]

from models.process import Playback
from services.cli.process import ProcessOrder, run_process
from services.cli.user_error import told_in_one_line
from services.logs import of_process
from services.supervisor.lifeline import end_with_parent


def main() -> None:
    """Run one process until it is told to stop or its parent is gone."""
    parser = argparse.ArgumentParser(add_help=False)
    parser.add_argument("entry")
    parser.add_argument("--site", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--camera")
    parser.add_argument("--start-ns", type=int)
    parser.add_argument("--parent", type=int, required=True)
    parser.add_argument("--spare", action="store_true")
    parser.add_argument("--playback", type=partial(msgspec.json.decode, type=Playback))
    arguments = parser.parse_args()
    if not end_with_parent(arguments.parent):
        return
    order = ProcessOrder(
        arguments.entry,
        arguments.site,
        arguments.data,
        arguments.camera,
        arguments.start_ns,
        arguments.spare,
        arguments.playback,
    )
    of_process.configure(order.name)
    of_process.log_what_ends_us()
    with told_in_one_line():
        run_process(order)


if __name__ == "__main__":
    main()
