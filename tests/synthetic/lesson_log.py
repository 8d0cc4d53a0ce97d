"""The log of a lesson in a synthetic gym, without a clock: what fusion's process would have published, part by part."""

from collections.abc import Iterable, Iterator

import msgspec

from models.camera.rig import Rig
from models.messages import codec
from models.messages.lesson import Entry, FusionLog
from models.messages.observation import Observation
from services.fusion.config import PRESETS, FusionConfig
from services.fusion.pipeline import Tick, initial_state, step

PART_NS = 500_000_000


def entries(events: Iterable[Observation | Tick], rig: Rig, config: FusionConfig = PRESETS["default"]) -> Iterator[Entry]:
    """What fusion takes in and gives out, in its order."""
    state, now_ns = initial_state(rig), 0
    for event in events:
        if isinstance(event, Tick):
            now_ns = event.t_ns
            state, output = step(state, event, config)
            yield Entry("tick", event.t_ns, b"")
            for motion in output.motions:
                if motion.kind == "smooth":
                    yield Entry("motion", now_ns, codec.encode(msgspec.structs.replace(motion, t_published_ns=now_ns + 70_000)))
        else:
            # As the process takes it in: through the wire.
            payload = codec.encode(event)
            yield Entry("observation", max(now_ns, event.t_mid_ns), payload)
            state, _ = step(state, codec.decode(payload, Observation), config)


def parts(log: Iterable[Entry], segment_ns: int) -> Iterator[FusionLog]:
    """A segment of these entries in parts of half a second."""
    waiting: list[Entry] = []
    sequence, until_ns = 0, 0
    for entry in log:
        if entry.kind == "observation" and entry.t_ns >= until_ns:
            if waiting:
                yield FusionLog(segment_ns, sequence, tuple(waiting))
                sequence, waiting = sequence + 1, []
            until_ns = entry.t_ns + PART_NS
        waiting.append(entry)
    yield FusionLog(segment_ns, sequence, tuple(waiting))
