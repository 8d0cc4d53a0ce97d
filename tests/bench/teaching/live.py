"""What the running box says of a simulated lesson, and how soon: `make bench-feedback`.

The box plays the film over and over, as `make run` does. Of each picture it is known what the pupil does: an attempt's true end is
put on the machine's clock by the picture that shows it, and what is on the bus then is held against it. The shipped film has six
actions without a fault, so that whatever is corrected in it is corrected wrongly.
"""

import argparse
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np

from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME, TRUTH_NAME
from edge.simulation.truth import truth_file
from models.arrays import Float
from models.config.site import Site, decode_site
from models.messages import codec, topics
from models.messages.feedback import Feedback
from models.messages.observation import Observation
from models.motions.motion import Attempt
from services.bus.zenoh_bus import open_client
from tests.bench.report import Report
from tests.bench.running_box import running_box
from tests.bench.table import Cell, ResultTable
from tests.bench.teaching.finding import f1

_WARM_S: Final = 30.0
_LATE_S: Final = 3.0
"""What has not been said so long after an attempt is not said any more."""
_OVERLAP: Final = 0.5
BARS: Final = {"feedback_delay_s.p95": ("<=", 1.0), "attempt_f1": (">=", 0.97), "false_cue_pct": ("<=", 5.0)}


@dataclass
class Heard:
    """What the bus said.

    Attributes:
        zeros_s: by the source's epoch, when the film began, CLOCK_MONOTONIC: of each picture that was looked at.
        said: feedback in its order.
    """

    zeros_s: dict[int, list[float]] = field(default_factory=lambda: defaultdict(list))
    said: list[Feedback] = field(default_factory=list)


@dataclass(frozen=True)
class Performed:
    """A true attempt on the machine's clock, and what was said of it, if anything was."""

    attempt: Attempt
    begin_s: float
    end_s: float
    said: Feedback | None = None

    @property
    def delay_s(self) -> float:
        """From its true end until the feedback was on the bus; NaN if none was."""
        return float("nan") if self.said is None else self.said.t_published_ns * 1e-9 - self.end_s


def listen(site: Site, times_s: Float, heard: Heard, ready: threading.Event, stop: threading.Event) -> None:
    """Take feedback, and from the first camera's observations when the film began."""
    bus = open_client(site.bus.endpoint, stop)
    if bus is None:
        return
    camera = site.cameras[0].name
    subscription = bus.subscribe(topics.observation(camera), topics.feedback(), keep=64)
    ready.set()
    while not stop.is_set():
        delivery = subscription.receive(0.5)
        if delivery is None:
            continue
        if delivery.topic == topics.feedback():
            heard.said.append(codec.decode(delivery.payload, Feedback))
        else:
            seen = codec.decode(delivery.payload, Observation)
            heard.zeros_s[seen.epoch].append(seen.t_mid_ns * 1e-9 - float(times_s[seen.frame]))
    bus.close()


def performed(heard: Heard, attempts: Sequence[Attempt], from_s: float, to_s: float) -> list[Performed]:
    """Every attempt that was begun and could be told of between two instants, with what was said of it."""
    left = list(heard.said)
    found = []
    for epoch in sorted(heard.zeros_s):
        zero_s = median(heard.zeros_s[epoch])
        for true in attempts:
            begin_s, end_s = zero_s + true.start_s, zero_s + true.end_s
            if begin_s < from_s or end_s + _LATE_S > to_s:
                continue
            own = next((one for one in left if one.action == true.action and _overlap(one, begin_s, end_s) >= _OVERLAP), None)
            if own is not None:
                left.remove(own)
            found.append(Performed(true, begin_s, end_s, own))
    return found


def _overlap(said: Feedback, begin_s: float, end_s: float) -> float:
    """Common time over the time that both cover."""
    first_s, last_s = said.keyframes_ns[0] * 1e-9, said.keyframes_ns[-1] * 1e-9
    return (min(last_s, end_s) - max(first_s, begin_s)) / (max(last_s, end_s) - min(first_s, begin_s))


def figures(done: Sequence[Performed], said: int) -> dict[str, float]:
    """Of all attempts; `said` counts what was said in the time of them."""
    told = [one for one in done if one.said is not None]
    delays_s = [one.delay_s for one in told]
    faultless = [one for one in told if not one.attempt.faults]
    wrong = [one for one in faultless if one.said is not None and one.said.cue]
    return {
        "attempts": len(done),
        "attempt_f1": f1(len(told), said, len(done)),
        "false_cue_pct": 100 * len(wrong) / len(faultless) if faultless else float("nan"),
        **{f"feedback_delay_s.p{q}": float(np.percentile(delays_s, q)) for q in (50, 95, 100) if delays_s},
    }


def table(done: Sequence[Performed]) -> ResultTable:
    """By action."""
    return ResultTable(
        "what the running box said", ("action", "n", "found", "corrected", "praised", "fine", "latest, s"), tuple(_rows(done))
    )


def _rows(done: Sequence[Performed]) -> Iterator[tuple[Cell, ...]]:
    for action in dict.fromkeys(one.attempt.action for one in done):
        own = [one for one in done if one.attempt.action == action]
        said = [one.said for one in own if one.said is not None]
        cues = ", ".join(sorted({one.cue for one in said if one.cue}))
        corrected = f"{sum(bool(one.cue) for one in said)}{f' ({cues})' if cues else ''}"
        latest_s = max((one.delay_s for one in own if one.said is not None), default=None)
        praised, fine = sum(bool(one.praise) for one in said), sum(one.fine for one in said)
        yield action, float(len(own)), float(len(said)), corrected, float(praised), float(fine), latest_s


def main() -> int:
    """Run the box, listen, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--site", type=Path, required=True, help="of a simulated lesson")
    parser.add_argument("--seconds", type=float, default=300.0)
    options = parser.parse_args()
    site = decode_site(options.site.read_bytes(), options.site)
    folder = _film(site, options.site, options.data)
    if folder is None:
        sys.stderr.write(f"bench-feedback: {options.site} plays no simulated lesson; name the site.toml of one with --site\n")
        return 2
    attempts = next(iter(read_attempts(folder / ATTEMPTS_NAME).values()))
    times_s = truth_file.read(folder / TRUTH_NAME).cameras[site.cameras[0].name].times_s
    heard, ready, stop = Heard(), threading.Event(), threading.Event()
    report = Report("bench-feedback", ())
    with running_box(options.site, options.data, None):
        listener = threading.Thread(target=listen, args=(site, times_s, heard, ready, stop))
        listener.start()
        ready.wait(_WARM_S)
        time.sleep(_WARM_S)
        from_s = time.monotonic()
        time.sleep(options.seconds)
        to_s = time.monotonic()
        stop.set()
        listener.join(5)
    done = performed(heard, attempts, from_s, to_s)
    if not done:
        sys.stderr.write("bench-feedback: the box performed no whole attempt; see bench/box.log in the data folder\n")
        return 2
    first_s, last_s = min(one.begin_s for one in done), max(one.end_s for one in done)
    said = [one for one in heard.said if first_s <= one.keyframes_ns[1] * 1e-9 <= last_s]
    report.add(figures(done, len(said)))
    report.tables.append(table(done))
    return report.conclude(BARS, options.data)


def _film(site: Site, file: Path, data: Path) -> Path | None:
    """The folder of the simulated lesson that the first camera plays; None if it plays something else."""
    path = Path(site.cameras[0].path or "")
    return next((folder for folder in (file.parent / path, data / path) if (folder / ATTEMPTS_NAME).is_file()), None)


if __name__ == "__main__":
    sys.exit(main())
