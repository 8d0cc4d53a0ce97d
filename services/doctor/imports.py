"""Run as a process of its own (`python -m services.doctor.imports MODULE...`): imports each module and says how that went.

One line a module: "try NAME" before, and "ok NAME" or "bad NAME: why" after. A library that is built for another processor ends the
process with a signal; then the last line says which it was.
"""

import importlib
import sys


def main() -> None:
    """Import what the arguments name."""
    for name in sys.argv[1:]:
        _say(f"try {name}")
        try:
            importlib.import_module(name)
        except Exception as error:  # noqa: BLE001 - whatever a broken package raises is what is to be told
            _say(f"bad {name}: {type(error).__name__}: {' '.join(str(error).split())}")
        else:
            _say(f"ok {name}")


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
