"""What fusion consumes of a lesson: the real networks over its pictures, once; from then on it is read from a file.

A file in `DATA/keypoints` is found by everything that the keypoints depend on: the lesson's pictures, the networks' files, which
cameras look how often, and the edge's code. Crops are predicted by fusion, too, whose commit is told (`Observed.commit`), but
does not make keypoints anew: a change of fusion moves crops by little, and with every change of it every lesson would cost
minutes. `--fresh` makes all anew.
"""

import hashlib
import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import cv2
import msgspec

from edge.cameras.video import Schedule
from edge.observe import Networks
from edge.perception.detection import load_person_detector
from edge.perception.network_file import read_network_file
from edge.perception.pose import load_pose_network
from edge.process import DETECTION_SCORE_MIN
from models.camera.rig import encode_rig
from models.messages import codec
from models.messages.control import PoseNetwork
from models.messages.observation import Observation
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.pipeline import Tick
from services.fusion.process import CONTROL_EVERY_TICKS
from tests.bench.closed_loop import Event, Pace, watch
from tests.bench.kept import keep
from tests.bench.reconstruct.lesson import START_NS, Lesson
from tests.bench.report import commit

FORMAT: Final = 1
RATE_HZ: Final = 30.0
"""Of fusion's ticks and of its output."""
LIVE_HZ: Final = 15.0
DELAY_NS: Final = 60_000_000
"""From mid-exposure to fusion: what the box takes on two cores at the live rate, in the middle of its 40 to 80 ms."""
FLUSH_TICKS: Final = 10
"""After the last picture, until its smooth output is out."""
CONFIG: Final = PRESETS["default"]
_ROOT: Final = Path(__file__).parents[3]
_EDGE_CODE: Final = ("edge/observe.py", "edge/turns.py", "edge/perception", "edge/cameras/jpeg.py", "models/skeleton/trunk.py",
                     "models/messages/observation.py", "tests/bench/closed_loop.py")  # fmt: skip


@dataclass(frozen=True)
class Looking:
    """How a lesson is looked at.

    Attributes:
        cameras: names, in the rig's order.
        rate_hz: inferences a second of each camera, in turns.
        network: pose network.
    """

    cameras: tuple[str, ...]
    rate_hz: float = LIVE_HZ
    network: PoseNetwork = "thunder"


@dataclass(frozen=True, eq=False)
class Observed:
    """What was consumed.

    Attributes:
        looking: how.
        events: observations and ticks in fusion's order.
        commit: of the code whose fusion predicted the crops.
        edge_cpu_s: CPU seconds of decoding, crops and networks when they ran, and of fusion, which told them where to look.
    """

    looking: Looking
    events: Sequence[Event]
    commit: str
    edge_cpu_s: float


class _File(msgspec.Struct, frozen=True):
    format: int
    commit: str
    edge_cpu_s: float
    events: list[bytes | int]


def observed(lesson: Lesson, looking: Looking, data: Path, *, fresh: bool = False) -> Observed:
    """The events of a lesson, from the cache or by looking.

    Raises:
        UserError: the networks are not installed, or the file cannot be written.
    """
    path = data / "keypoints" / f"{_key(lesson, looking, data)}.msgpack"
    if not fresh and (kept := _read(path)) is not None:
        return Observed(looking, [_event(event) for event in kept.events], kept.commit, kept.edge_cpu_s)
    cv2.setNumThreads(1)
    pose = load_pose_network(looking.network, data)
    detector = load_person_detector(data, "cpu", DETECTION_SCORE_MIN)
    began_s = time.process_time()
    events = look(lesson, looking, Networks(pose, lambda: detector))
    described, spent_s = commit(), time.process_time() - began_s
    raw = [event.t_ns if isinstance(event, Tick) else codec.encode(event) for event in events]
    keep(path, msgspec.msgpack.encode(_File(FORMAT, described, spent_s, raw)))
    return Observed(looking, events, described, spent_s)


def look(lesson: Lesson, looking: Looking, networks: Networks, config: FusionConfig = CONFIG) -> list[Event]:
    """Look at a lesson now."""
    rig = lesson.rig.select(looking.cameras)
    schedule = Schedule(START_NS, 0, RATE_HZ)
    ticks_ns = [schedule.t_ns(k) for k in range(round(lesson.length_s * RATE_HZ) + FLUSH_TICKS)]
    pace = Pace(looking.rate_hz, looking.network, START_NS, DELAY_NS, CONTROL_EVERY_TICKS)
    return watch(rig, lesson.frames(looking.cameras), ticks_ns, networks, pace, config)


def _event(kept: bytes | int) -> Event:
    return Tick(kept) if isinstance(kept, int) else codec.decode(kept, Observation)


def _read(path: Path) -> _File | None:
    """A file that is whole and of this format; a damaged one is as none."""
    try:
        kept = msgspec.msgpack.decode(path.read_bytes(), type=_File)
    except (OSError, msgspec.DecodeError):
        return None
    return kept if kept.format == FORMAT else None


def _key(lesson: Lesson, looking: Looking, data: Path) -> str:
    parts = [
        lesson.identity.encode(),
        encode_rig(lesson.rig.select(looking.cameras), ""),
        json.dumps([FORMAT, looking.rate_hz, looking.network, DELAY_NS, lesson.length_s, DETECTION_SCORE_MIN]).encode(),
        read_network_file(f"movenet-{looking.network}", data),
        read_network_file("nanodet", data),
        *(path.read_bytes() for path in _edge_code()),
    ]
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return digest.hexdigest()[:40]


def _edge_code() -> list[Path]:
    paths = [_ROOT / name for name in _EDGE_CODE]
    return sorted(file for path in paths for file in (path.rglob("*.py") if path.is_dir() else [path]))
