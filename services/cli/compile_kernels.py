"""Compiles the numerical kernels for `make kernels`, and says that it still does: for a minute nothing else is seen of it."""

import sys
import time
from threading import Event, Thread

_EVERY_S = 15.0


def compile_kernels() -> None:
    """Have all kernels in numba's cache."""
    done = Event()
    speaker = Thread(target=_speak, args=(done,))
    speaker.start()
    try:
        from services.evaluation import process as evaluation  # noqa: PLC0415 - importing them takes seconds, too
        from services.fusion import process as fusion  # noqa: PLC0415

        fusion.prepare()
        evaluation.prepare()
    finally:
        done.set()
        speaker.join()


def _speak(done: Event) -> None:
    began_s = time.monotonic()
    while not done.wait(_EVERY_S):
        sys.stderr.write(f"... still compiling numerical kernels, for {time.monotonic() - began_s:.0f} s now\n")
        sys.stderr.flush()


if __name__ == "__main__":
    compile_kernels()
