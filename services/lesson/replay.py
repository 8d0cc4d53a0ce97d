"""A lesson's log through fusion's own `step`: what was taken in gives what was given out, to the last bit.

Pure: parts of a lesson go in, motions come out. What is compared of two motions is everything but `t_published_ns`, which is not
fusion's but the clock's. Live motions are not recorded, since they follow from the same state; they come out of a replay.
"""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import msgspec
import numpy as np

from models.camera.rig import Rig
from models.errors import UserError
from models.messages import codec
from models.messages.lesson import Entry
from models.messages.motion import JointState, Motion
from models.messages.observation import Observation
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.pipeline import FusionState, Tick, initial_state, step
from services.lesson.lesson_reader import LessonPart

_COMPARED = tuple(name for name in Motion.__struct_fields__ if name != "t_published_ns")


@dataclass(frozen=True)
class Replayed:
    """An entry of the log, and what fusion gives out on it.

    Attributes:
        segment: counts the segments of the lesson from 0.
        entry: as recorded.
        motions: live and smooth; empty but at ticks.
    """

    segment: int
    entry: Entry
    motions: tuple[Motion, ...] = ()


@dataclass(frozen=True)
class Difference:
    """A motion that does not come out as it was recorded.

    Attributes:
        segment: counts the segments of the lesson from 0.
        sequence: of the smooth motion within its segment.
        t_ns: CLOCK_MONOTONIC of the instant that it describes.
        what: what differs, in words.
    """

    segment: int
    sequence: int
    t_ns: int
    what: str


@dataclass(frozen=True)
class Comparison:
    """A whole lesson replayed.

    Attributes:
        segments: how many.
        compared: smooth motions that were recorded or should have been.
        equal: of these, those that came out bit for bit.
        first: the first that did not; None if all did.
    """

    segments: int
    compared: int
    equal: int
    first: Difference | None


def configuration(preset: str) -> FusionConfig:
    """Fusion's configuration of that name.

    Raises:
        UserError: this KineBox has none.
    """
    if preset not in PRESETS:
        raise UserError(
            f"the lesson was fused with the preset '{preset}', which this KineBox does not have; update it to replay it"
        )
    return PRESETS[preset]


def replay(parts: Iterable[LessonPart], rig: Rig, config: FusionConfig) -> Iterator[Replayed]:
    """Feed a lesson to fusion.

    Args:
        parts: as the lesson's reader gives them.
        rig: calibration that the lesson was fused with.
        config: likewise.

    Raises:
        UserError: an entry cannot be read, or a segment lacks a part, so that fusion's state is not known.
    """
    state: FusionState | None = None
    segment, due = -1, 0
    for part in parts:
        if part.begins_segment:
            state, segment, due = initial_state(rig), segment + 1, 0
        if state is None or part.sequence != due:
            raise UserError(f"part {due} of the lesson's segment {segment + 1} is missing; what follows cannot be replayed")
        due += 1
        for entry in part.entries:
            event = _event(entry)
            if event is None:
                yield Replayed(segment, entry)
                continue
            state, output = step(state, event, config)
            yield Replayed(segment, entry, output.motions)


def compare(replayed: Iterable[Replayed]) -> Comparison:
    """Hold every recorded motion against the one that came out in its place.

    A log that was cut off may lack the motions of its last tick; those are not compared.

    Raises:
        UserError: as `replay`, or a recorded motion cannot be read.
    """
    tally = _Tally()
    for item in replayed:
        tally.take(item)
    return Comparison(tally.segment + 1, tally.compared, tally.equal, tally.first)


class _Tally:
    def __init__(self) -> None:
        self.segment = -1
        self.compared = self.equal = 0
        self.first: Difference | None = None
        self._due: deque[Motion] = deque()

    def take(self, item: Replayed) -> None:
        if item.segment != self.segment:
            self.segment = item.segment
            self._due.clear()
        if item.entry.kind == "motion":
            recorded = decode(item.entry, Motion)
            self._note(recorded, difference(recorded, self._due.popleft()) if self._due else "it does not come out of the replay")
        elif item.entry.kind == "tick":
            while self._due:
                self._note(self._due.popleft(), "it was not recorded")
        self._due.extend(motion for motion in item.motions if motion.kind == "smooth")

    def _note(self, motion: Motion, what: str) -> None:
        self.compared += 1
        if not what:
            self.equal += 1
        elif self.first is None:
            self.first = Difference(self.segment, motion.sequence, motion.t_ns, what)


def difference(recorded: Motion, replayed: Motion) -> str:
    """What of two motions is not equal bit for bit, in words; empty if everything is. See the module for what is compared."""
    fields = [name for name in _COMPARED if _bits(getattr(recorded, name)) != _bits(getattr(replayed, name))]
    if not fields:
        return ""
    known = (recorded.states != JointState.UNKNOWN) & (replayed.states != JointState.UNKNOWN)
    apart_m = np.linalg.norm(recorded.joints_m.astype(np.float64) - replayed.joints_m.astype(np.float64), axis=1)[known]
    distance = f", joints by up to {1e3 * apart_m.max():.3g} mm" if "joints_m" in fields and apart_m.size else ""
    return f"{', '.join(fields)} {'differs' if len(fields) == 1 else 'differ'}{distance}"


def decode(entry: Entry, kind: type[codec.MessageT]) -> codec.MessageT:
    """The message of an entry.

    Raises:
        UserError: it cannot be read.
    """
    try:
        return codec.decode(entry.payload, kind)
    except codec.CodecError as error:
        raise UserError(f"the lesson holds what this KineBox cannot read: {error}; use the one that recorded it") from error


def _event(entry: Entry) -> Observation | Tick | None:
    """What fusion took in; None for an entry that is no input."""
    if entry.kind == "tick":
        return Tick(entry.t_ns)
    return decode(entry, Observation) if entry.kind == "observation" else None


def _bits(value: object) -> object:
    """Equal for two values exactly if these are the same bits: NaN equals itself, and -0 differs from 0."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    return msgspec.msgpack.encode(value)
