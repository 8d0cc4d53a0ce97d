"""What a source of pictures is: a video file, a simulated gym or a camera look the same from behind."""

import time
from dataclasses import dataclass
from typing import Protocol

from models.arrays import UInt8
from models.messages.trouble import Trouble


class Frame(Protocol):
    """A picture that was grabbed but not decoded: decoding costs more than all else but the networks."""

    @property
    def camera(self) -> str:
        """Name of the camera."""

    @property
    def epoch(self) -> int:
        """Counts the loops of the source; nothing may be carried over its change."""

    @property
    def index(self) -> int:
        """Number of the picture in its source within the epoch."""

    @property
    def t_mid_ns(self) -> int:
        """CLOCK_MONOTONIC at mid-exposure."""

    @property
    def size_px(self) -> tuple[int, int]:
        """(width, height) of the whole picture."""

    def image(self, reduction: int = 1) -> UInt8:
        """The picture as RGB (height, width, 3), its sides divided by `reduction` (1, 2, 4 or 8) and rounded up.

        A reduced picture is cheaper and already low-pass filtered: pixel i of it covers the pixels i r to i r + r - 1.

        Raises:
            PictureError: what arrived is no whole picture.
        """


class Source(Protocol):
    """Delivers the newest picture and never keeps a queue."""

    @property
    def skipped(self) -> int:
        """Pictures, since the first grab, that nobody grabbed because a newer one was already there."""

    @property
    def problem(self) -> Trouble | None:
        """What is wrong with the camera now; None if nothing is known to be."""

    def grab(self, timeout_s: float) -> Frame | None:
        """Wait for a picture newer than the last one grabbed and return the newest there is; None after `timeout_s`.

        Raises:
            SourceError: there will be no more.
        """

    def close(self) -> None:
        """Let go of the device or file."""


class SourceError(Exception):
    """The source has ended or is gone: it must be opened again, and that may fail for a while. Says which camera and why."""


class PictureError(Exception):
    """One picture cannot be decoded; the next one may be well."""


class Clock(Protocol):
    """CLOCK_MONOTONIC, or a test's stand-in for it."""

    def now_ns(self) -> int:
        """The time."""

    def sleep_until(self, t_ns: int) -> None:
        """Return at `t_ns` or soon after; at once if it has passed."""


@dataclass(frozen=True)
class MonotonicClock:
    """The machine's CLOCK_MONOTONIC."""

    def now_ns(self) -> int:
        """The time."""
        return time.monotonic_ns()

    def sleep_until(self, t_ns: int) -> None:
        """Return at `t_ns` or soon after; at once if it has passed."""
        remaining_ns = t_ns - time.monotonic_ns()
        if remaining_ns > 0:
            time.sleep(remaining_ns * 1e-9)
