"""The networks of an edge process: both pose networks are loaded before the first picture.

The smaller is asked for when a machine has too much to do, which is the wrong moment to load it; and 20 MB more by the camera
would look like a leak. The first must be there. Another that cannot be loaded is reported, and it is tried again now and then,
beside the loop, which goes on with the one that it has.
"""

import threading
from collections.abc import Callable
from typing import get_args

from edge.cameras.source import Clock, MonotonicClock
from edge.observe import PersonDetector, PoseEstimator
from models.errors import UserError
from models.messages.control import PoseNetwork as PoseNetworkName

_NAMES: tuple[PoseNetworkName, ...] = get_args(PoseNetworkName)
RETRY_NS = 10_000_000_000
"""Reading and hashing a file costs what a few poses cost; a missing one shall not cost that with every picture."""


class Library:
    """Loads each network once, or until it succeeds; all pose networks when it is made.

    Args:
        load_pose: returns a pose network by its name; raises UserError if its file is missing or damaged.
        load_detector: the same for the person detector.
        first: the pose network to begin with; its failure is raised.
        clock: tells when a failure is long enough ago.
    """

    def __init__(
        self,
        load_pose: Callable[[PoseNetworkName], PoseEstimator],
        load_detector: Callable[[], PersonDetector],
        first: PoseNetworkName,
        clock: Clock | None = None,
    ) -> None:
        self._load_pose = load_pose
        self._load_detector = load_detector
        self._poses: dict[PoseNetworkName, PoseEstimator] = {first: load_pose(first)}
        self._current = first
        self._detector: PersonDetector | None = None
        self._clock = clock or MonotonicClock()
        self._loading: dict[str, threading.Thread] = {}
        self._problems: dict[str, str] = {}
        self._t_failed_ns: dict[str, int] = {}
        for name in _NAMES:
            if name != first:
                self._load(name)

    @property
    def current(self) -> PoseNetworkName:
        """Name of the pose network in use."""
        return self._current

    @property
    def problem(self) -> str:
        """Why a network is not there; empty if all are."""
        return "; ".join(self._problems.values())

    def pose(self, name: PoseNetworkName) -> PoseEstimator:
        """The pose network of that name; until it is loaded, and if it cannot be, the one that ran last."""
        if name in self._poses:
            self._current = name
        for missing in _NAMES:
            if missing not in self._poses and missing not in self._loading and self._may_try(missing):
                thread = threading.Thread(target=self._load_beside, args=(missing,), name=f"load-{missing}", daemon=True)
                self._loading[missing] = thread
                thread.start()
        return self._poses[self._current]

    def detector(self) -> PersonDetector:
        """The detector; the first call loads it."""
        if self._detector is None:
            self._detector = self._load_detector()
        return self._detector

    def _may_try(self, name: PoseNetworkName) -> bool:
        t_failed_ns = self._t_failed_ns.get(name)
        return t_failed_ns is None or self._clock.now_ns() - t_failed_ns >= RETRY_NS

    def _load(self, name: PoseNetworkName) -> None:
        try:
            self._poses[name] = self._load_pose(name)
            self._problems.pop(name, None)
        except UserError as error:
            self._failed(name, str(error))
        except Exception as error:  # noqa: BLE001 - whatever a runtime raises, the camera has another network to go on with
            self._failed(
                name, f"network {name} cannot be loaded ({type(error).__name__}: {error}); if it stays so, start KineBox anew"
            )

    def _load_beside(self, name: PoseNetworkName) -> None:
        self._load(name)
        # Last of all: from here on the loop may start the next attempt.
        del self._loading[name]

    def _failed(self, name: PoseNetworkName, problem: str) -> None:
        self._problems[name] = " ".join(problem.split())
        self._t_failed_ns[name] = self._clock.now_ns()
