"""The networks of an edge process: the first is loaded at once, the others when they are first asked for.

A pose network that is asked for is loaded beside the loop, which goes on with the one that it has.
"""

import threading
from collections.abc import Callable

from edge.observe import PersonDetector, PoseEstimator
from models.errors import UserError
from models.messages.control import PoseNetwork as PoseNetworkName


class Library:
    """Loads each network once.

    Args:
        load_pose: returns a pose network by its name; raises UserError if its file is missing or damaged.
        load_detector: the same for the person detector.
        first: the pose network to begin with.
    """

    def __init__(
        self,
        load_pose: Callable[[PoseNetworkName], PoseEstimator],
        load_detector: Callable[[], PersonDetector],
        first: PoseNetworkName,
    ) -> None:
        self._load_pose = load_pose
        self._load_detector = load_detector
        self._poses: dict[PoseNetworkName, PoseEstimator] = {first: load_pose(first)}
        self._current = first
        self._detector: PersonDetector | None = None
        self._loading: dict[str, threading.Thread] = {}
        self._problems: dict[str, str] = {}

    @property
    def current(self) -> PoseNetworkName:
        """Name of the pose network in use."""
        return self._current

    @property
    def problem(self) -> str:
        """Why a network that was asked for is not there; empty if all is well."""
        return "; ".join(self._problems.values())

    def pose(self, name: PoseNetworkName) -> PoseEstimator:
        """The pose network of that name; until it is loaded, and if it cannot be, the one that ran last."""
        if name in self._poses:
            self._current = name
        elif name not in self._loading:
            self._loading[name] = threading.Thread(target=self._load, args=(name,), name=f"load-{name}", daemon=True)
            self._loading[name].start()
        return self._poses[self._current]

    def detector(self) -> PersonDetector:
        """The detector; the first call loads it."""
        if self._detector is None:
            self._detector = self._load_detector()
        return self._detector

    def _load(self, name: PoseNetworkName) -> None:
        try:
            self._poses[name] = self._load_pose(name)
        except UserError as error:
            self._problems[name] = str(error)
