"""A tablet that never tires: it comes back whenever the box lets it, and remembers when it saw what."""

import json
import threading
import time
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from models.messages.motion import JointState
from services.tablet import motion_frame
from tests.acknowledged import Acknowledged
from tests.integration.waiting import until

MOST_JOINTS = 9
"""More than half of the joints seen by two views or more: that is a figure."""
AWAY_S = 0.5
"""A pause of the figure that is longer than the seam of the looping footage makes it."""
STAYS_S = 1.5
"""So long a figure must last to be back; and so soon after a fault must a pause begin to be the fault's."""
_AGAIN_S = 0.1


@dataclass(frozen=True)
class Gap:
    """The figure was away from the last time that it was seen until it was seen again; CLOCK_MONOTONIC."""

    from_s: float
    to_s: float


@dataclass
class Seen:
    """What came, with the time of receipt (CLOCK_MONOTONIC).

    Attributes:
        figures_s: when a motion with most joints seen came.
        statuses: what the box said of itself.
        cut_s: when the connection was lost.
    """

    figures_s: list[float] = field(default_factory=list)
    statuses: list[tuple[float, dict[str, Any]]] = field(default_factory=list)
    cut_s: list[float] = field(default_factory=list)


def joined(gaps: list[Gap]) -> list[Gap]:
    """As one, those between which the figure did not stay."""
    whole: list[Gap] = []
    for gap in gaps:
        if whole and gap.from_s < whole[-1].to_s + STAYS_S:
            whole[-1] = Gap(whole[-1].from_s, gap.to_s)
        else:
            whole.append(gap)
    return whole


class Client:
    """A thread that watches the page's socket as a tablet does."""

    def __init__(self, port: int) -> None:
        self._url = f"ws://127.0.0.1:{port}/ws"
        self._stop = threading.Event()
        self.seen = Seen()
        self._thread = threading.Thread(target=self._run, name="client", daemon=True)

    def __enter__(self) -> "Client":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join(10)

    def wait_figure(self, after_s: float, deadline_s: float = 60.0) -> float:
        """When the first figure came that was received after an instant."""
        until(lambda: any(at > after_s for at in reversed(self.seen.figures_s[-50:])), "a figure", deadline_s)
        return next(at for at in self.seen.figures_s if at > after_s)

    def status(self) -> dict[str, Any]:
        """The newest."""
        until(lambda: bool(self.seen.statuses), "a status")
        return self.seen.statuses[-1][1]

    def statuses_since(self, after_s: float) -> list[dict[str, Any]]:
        """Those received after an instant."""
        return [status for at, status in self.seen.statuses if at > after_s]

    def recovery_s(self, fault_s: float, over_s: float) -> float:
        """The longest that the figure was away because of a fault; 0 if it never was.

        A figure that came back for less than `STAYS_S` was not back. One that went soon after the fault's begin has been away
        since then.

        Args:
            fault_s: the fault's begin.
            over_s: its end; a pause that begins within `STAYS_S` after it is still the fault's.
        """
        longest = 0.0
        for away in joined(self.gaps(fault_s)):
            if away.from_s <= over_s + STAYS_S:
                begin_s = fault_s if away.from_s < fault_s + STAYS_S else away.from_s
                longest = max(longest, away.to_s - begin_s)
        return longest

    def gaps(self, fault_s: float) -> list[Gap]:
        """The pauses of the figure that ended after the fault and are longer than those of a healthy box."""
        times = self.seen.figures_s
        begin = max(next((i for i, at in enumerate(times) if at > fault_s), len(times)) - 1, 0)
        return [Gap(earlier, later) for earlier, later in pairwise(times[begin:]) if later - earlier > AWAY_S]

    def longest_pause_s(self, fault_s: float) -> float:
        """The longest time without a figure since the fault, however short."""
        times = self.seen.figures_s
        begin = max(next((i for i, at in enumerate(times) if at > fault_s), len(times)) - 1, 0)
        return max((later - earlier for earlier, later in pairwise(times[begin:])), default=0.0)

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                self._watch()
            except (OSError, TimeoutError, WebSocketException):
                self.seen.cut_s.append(time.monotonic())
                self._stop.wait(_AGAIN_S)

    def _watch(self) -> None:
        with connect(self._url, compression=None, open_timeout=1, close_timeout=1) as socket:
            acknowledged = Acknowledged()
            while not self._stop.is_set():
                try:
                    message = socket.recv(timeout=0.5)
                except TimeoutError:
                    continue  # A server that hangs; the connection ends with it.
                now_s = time.monotonic()
                if isinstance(message, bytes):
                    frame = motion_frame.unpack(message)
                    if int((frame.states == JointState.SEEN).sum()) >= MOST_JOINTS:
                        self.seen.figures_s.append(now_s)
                elif (said := json.loads(message))["type"] == "status":
                    self.seen.statuses.append((now_s, said))
                socket.send(acknowledged.after(message))
