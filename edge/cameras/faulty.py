"""Faults of a camera on demand: what drills, tests, a technician's rehearsal and simulated lessons ask for (`FaultConfig`).

A wrapper around a healthy source does what a sick camera does; whatever is behind it must cope as it would with the real thing.
What befalls pictures (their loss, delay, darkness, wrong time) goes by the pictures' own times, so that it befalls the same ones
in every run; what befalls the camera goes by the clock.
"""

import hashlib
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from edge.cameras.source import Clock, Frame, Source, SourceError
from models.arrays import UInt8
from models.config.site import FaultConfig
from models.messages.trouble import Trouble

SECOND_NS = 1_000_000_000


class Due(NamedTuple):
    """A fault in force, and for how long it has been."""

    fault: FaultConfig
    since_ns: int


@dataclass(frozen=True)
class Script:
    """The faults of one camera in time.

    Attributes:
        faults: of those that end, stall or freeze a camera the first that is due is in force, of all others every one.
        start_ns: CLOCK_MONOTONIC from which their times count.
        seed: of the lot by which pictures are lost or late.
    """

    faults: Sequence[FaultConfig]
    start_ns: int
    seed: int = 0

    def due(self, t_ns: int) -> list[Due]:
        """The faults in force at an instant."""
        found = ((fault, _since_ns(fault, t_ns - self.start_ns)) for fault in self.faults)
        return [Due(fault, since_ns) for fault, since_ns in found if since_ns is not None]

    def state(self, t_ns: int) -> FaultConfig | None:
        """What the camera itself does at an instant: ends, stalls or repeats."""
        return next((due.fault for due in self.due(t_ns) if due.fault.kind in {"end", "stall", "repeat"}), None)

    def is_lost(self, frame: Frame) -> bool:
        """Whether a picture never arrives."""
        return any(due.fault.kind == "drop" and self._hits(due.fault, frame) for due in self.due(frame.t_mid_ns))

    def late_ns(self, frame: Frame) -> int:
        """How long after its time a picture arrives."""
        lates = (due.fault for due in self.due(frame.t_mid_ns) if due.fault.kind == "late")
        return round(SECOND_NS * sum(fault.by_s for fault in lates if self._hits(fault, frame)))

    def altered(self, frame: Frame) -> Frame:
        """A picture as the camera shows it: with the time that its clock says, and black where the lens is covered."""
        error_ns, dark = 0.0, False
        for fault, since_ns in self.due(frame.t_mid_ns):
            error_ns += fault.by_s * SECOND_NS if fault.kind == "jump" else 0.0
            error_ns += fault.ppm * 1e-6 * since_ns if fault.kind == "drift" else 0.0
            dark |= fault.kind == "dark"
        return Altered(frame, round(error_ns), dark) if error_ns or dark else frame

    def _hits(self, fault: FaultConfig, frame: Frame) -> bool:
        if fault.share == 1:
            return True
        lot = f"{self.seed} {fault.kind} {fault.at_s!r} {frame.camera} {frame.epoch} {frame.index}"
        return int.from_bytes(hashlib.blake2b(lot.encode(), digest_size=8).digest()) < fault.share * 2**64


def _since_ns(fault: FaultConfig, t_ns: int) -> int | None:
    at_ns, for_ns, every_ns = (round(seconds * SECOND_NS) for seconds in (fault.at_s, fault.for_s, fault.every_s))
    since_ns = t_ns - at_ns
    if since_ns < 0:
        return None
    since_ns = since_ns % every_ns if every_ns > 0 else since_ns
    return since_ns if since_ns < for_ns else None


@dataclass(frozen=True)
class Altered:
    """A picture of which the camera's clock says a wrong time, or that was taken with the lens covered."""

    frame: Frame
    by_ns: int
    dark: bool

    @property
    def camera(self) -> str:
        """See `Frame.camera`."""
        return self.frame.camera

    @property
    def epoch(self) -> int:
        """See `Frame.epoch`."""
        return self.frame.epoch

    @property
    def index(self) -> int:
        """See `Frame.index`."""
        return self.frame.index

    @property
    def t_mid_ns(self) -> int:
        """See `Frame.t_mid_ns`."""
        return self.frame.t_mid_ns + self.by_ns

    @property
    def size_px(self) -> tuple[int, int]:
        """See `Frame.size_px`."""
        return self.frame.size_px

    def image(self, reduction: int = 1) -> UInt8:
        """See `Frame.image`."""
        if not self.dark:
            return self.frame.image(reduction)
        width, height = (-(-side // reduction) for side in self.size_px)
        return np.zeros((height, width, 3), np.uint8)


class _OnItsWay(NamedTuple):
    frame: Frame
    arrives_ns: int


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
        self._on_its_way: deque[_OnItsWay] = deque()
        self._overtaken = 0
        self._fail_if_ended()

    @property
    def skipped(self) -> int:
        """See `Source.skipped`."""
        return self._source.skipped + self._overtaken

    @property
    def problem(self) -> Trouble | None:
        """See `Source.problem`."""
        return self._source.problem

    def grab(self, timeout_s: float) -> Frame | None:
        """See `Source.grab`."""
        self._fail_if_ended()
        frame = self._arrived(self._clock.now_ns() + round(timeout_s * SECOND_NS))
        state = self._script.state(self._clock.now_ns())
        if frame is None or state is None:
            self._frozen = None
            return None if frame is None else self._script.altered(frame)
        match state.kind:
            case "stall":
                self._show_nothing(timeout_s)
                return None
            case "repeat":
                self._frozen = self._frozen or frame
                return self._frozen
            case _:
                return None  # It has just ended; the next grab says so.

    def close(self) -> None:
        """See `Source.close`."""
        self._source.close()

    def _arrived(self, end_ns: int) -> Frame | None:
        """The newest picture that has arrived, in the order in which they were taken; None if none does until `end_ns`."""
        while True:
            now_ns = self._clock.now_ns()
            arrived = [each for each in self._on_its_way if each.arrives_ns <= now_ns]
            if arrived:
                for _ in arrived:
                    self._on_its_way.popleft()
                self._overtaken += len(arrived) - 1
                return arrived[-1].frame
            until_ns = min([end_ns, *(each.arrives_ns for each in self._on_its_way)])
            frame = self._source.grab(max(0, until_ns - now_ns) / SECOND_NS)
            if frame is not None:
                self._send(frame)
            elif self._clock.now_ns() >= end_ns:
                return None

    def _send(self, frame: Frame) -> None:
        if self._script.is_lost(frame):
            return
        before_ns = self._on_its_way[-1].arrives_ns if self._on_its_way else 0
        late_ns = self._script.late_ns(frame)
        arrives_ns = frame.t_mid_ns + late_ns if late_ns else self._clock.now_ns()
        self._on_its_way.append(_OnItsWay(frame, max(arrives_ns, before_ns)))

    def _show_nothing(self, timeout_s: float) -> None:
        """Take pictures and drop them, since those of a camera that stalls were never there to be skipped."""
        end_ns = self._clock.now_ns() + round(timeout_s * SECOND_NS)
        while (now_ns := self._clock.now_ns()) < end_ns:
            self._source.grab((end_ns - now_ns) / SECOND_NS)

    def _fail_if_ended(self) -> None:
        fault = self._script.state(self._clock.now_ns())
        if fault is not None and fault.kind == "end":
            raise SourceError(f"camera '{fault.camera}' has ended")
