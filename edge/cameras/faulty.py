"""Faults of a camera on demand: what drills, tests and a technician's rehearsal ask for in the site file (`[[faults]]`).

A wrapper around a healthy source does what a sick camera does; whatever is behind it must cope as it would with the real thing.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from edge.cameras.source import Clock, Frame, Source, SourceError
from models.arrays import UInt8
from models.config.site import FaultConfig
from models.messages.trouble import Trouble

SECOND_NS = 1_000_000_000


@dataclass(frozen=True)
class Script:
    """The faults of one camera in time.

    Attributes:
        faults: of which the first that is due is in force.
        start_ns: CLOCK_MONOTONIC from which their times count.
    """

    faults: Sequence[FaultConfig]
    start_ns: int

    def at(self, t_ns: int) -> FaultConfig | None:
        """The fault in force at an instant."""
        t_s = (t_ns - self.start_ns) / SECOND_NS
        return next((fault for fault in self.faults if _is_due(fault, t_s)), None)


def _is_due(fault: FaultConfig, t_s: float) -> bool:
    since_s = t_s - fault.at_s
    if since_s < 0:
        return False
    return (since_s % fault.every_s if fault.every_s > 0 else since_s) < fault.for_s


@dataclass(frozen=True)
class _Displaced:
    """A picture of which the camera's clock says a wrong time."""

    frame: Frame
    by_ns: int

    @property
    def camera(self) -> str:
        return self.frame.camera

    @property
    def epoch(self) -> int:
        return self.frame.epoch

    @property
    def index(self) -> int:
        return self.frame.index

    @property
    def t_mid_ns(self) -> int:
        return self.frame.t_mid_ns + self.by_ns

    @property
    def size_px(self) -> tuple[int, int]:
        return self.frame.size_px

    def image(self, reduction: int = 1) -> UInt8:
        return self.frame.image(reduction)


class FaultySource:
    """`Source` that is healthy but for its script.

    Args:
        source: healthy.
        script: when it is not.
        clock: CLOCK_MONOTONIC.

    Raises:
        SourceError: the script says that it cannot be opened now.
    """

    def __init__(self, source: Source, script: Script, clock: Clock) -> None:
        self._source = source
        self._script = script
        self._clock = clock
        self._frozen: Frame | None = None
        self._fail_if_ended()

    @property
    def skipped(self) -> int:
        """See `Source.skipped`."""
        return self._source.skipped

    @property
    def problem(self) -> Trouble | None:
        """See `Source.problem`."""
        return self._source.problem

    def grab(self, timeout_s: float) -> Frame | None:
        """See `Source.grab`."""
        self._fail_if_ended()
        frame = self._source.grab(timeout_s)
        fault = self._script.at(self._clock.now_ns())
        if frame is None or fault is None:
            self._frozen = None
            return frame
        match fault.kind:
            case "stall":
                self._show_nothing(timeout_s)
                return None
            case "repeat":
                self._frozen = self._frozen or frame
                return self._frozen
            case "jump":
                return _Displaced(frame, round(fault.by_s * SECOND_NS))
            case "end":
                return None  # It has just begun; the next grab says so.

    def close(self) -> None:
        """See `Source.close`."""
        self._source.close()

    def _show_nothing(self, timeout_s: float) -> None:
        """Take pictures and drop them, since those of a camera that stalls were never there to be skipped."""
        end_ns = self._clock.now_ns() + round(timeout_s * SECOND_NS)
        while (now_ns := self._clock.now_ns()) < end_ns:
            self._source.grab((end_ns - now_ns) / SECOND_NS)

    def _fail_if_ended(self) -> None:
        fault = self._script.at(self._clock.now_ns())
        if fault is not None and fault.kind == "end":
            raise SourceError(f"camera '{fault.camera}' has ended")
