"""What recording costs: CPU of the recorder beside four cameras, and megabytes of a lesson of 45 minutes.

The box runs as it is shipped and records; a minute of it is measured. Then what was recorded is written again at fixed rates, so
that the size does not hang on the machine's speed: every picture's own observation, at the given rate of every camera, by the
writer that the recorder uses. With a second person in every picture, that person is taken from a picture of another time. Every
nine seconds an attempt ends, as in a class of thirty of whom everybody has ten.
"""

import argparse
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from itertools import cycle
from pathlib import Path

import msgspec

from models.messages import codec
from models.messages.lesson import Entry, FusionLog
from models.messages.observation import Observation
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import LessonPart, open_lesson
from tests.bench.report import Report
from tests.bench.running_box import CpuMeter, processes, rss_mb, running_box
from tests.browser.attempts import tried
from tests.integration.waiting import until
from tests.ports import free_port

BARS = {
    "recorder_cpu_pct": ("<=", 1.0),
    "lesson_mb_45min": ("<=", 150.0),
    "lesson_mb_45min.4x15hz": ("<=", 150.0),
    "lesson_mb_45min.4x15hz_two_persons": ("<=", 150.0),
    "lesson_mb_45min.4x30hz": ("<=", 150.0),
}
LESSON_S = 45 * 60
PARTS_A_SECOND = 2
A_SECOND = {"tick": 30, "motion": 30, "health": 8}
ATTEMPT_EVERY_S = 9
WRITTEN_S = 60
STARTING_S = 180.0
CAMERAS = 4


def record(site: Path, data: Path, folder: Path, seconds: float, warm_s: float) -> tuple[Path, dict[str, float]]:
    """A lesson that the box recorded, and what that cost over the last `seconds`."""
    (folder / "rig.toml").write_bytes((site.parent / "rig.toml").read_bytes())
    ports = f'[bus]\nendpoint = "tcp/127.0.0.1:{free_port()}"\n[tablet]\nhost = "127.0.0.1"\nport = {free_port()}\n'
    own = folder / "site.toml"
    own.write_text(f'{site.read_text()}\n{ports}[lessons]\nautomatic = true\nfolder = "{folder}"\n')
    with running_box(own, data, None) as box:
        until(lambda: "recorder" in processes(box) and bool(list(folder.glob(f"*{PART_SUFFIX}"))), "a lesson to begin", STARTING_S)
        time.sleep(warm_s)
        (part,) = folder.glob(f"*{PART_SUFFIX}")
        recorder = processes(box)["recorder"]
        meter, size = CpuMeter(lambda: [recorder]), part.stat().st_size
        time.sleep(seconds)
        used = meter.read()
        figures = {
            "recorder_cpu_pct": 100 * used.cores,
            "recorder_rss_mb": rss_mb(recorder),
            "lesson_mb_45min": (part.stat().st_size - size) / used.seconds * LESSON_S / 1e6,
        }
    (lesson,) = folder.glob(f"*{SUFFIX}")
    return lesson, figures


def rates(lesson: Path) -> dict[str, float]:
    """Entries a second, by kind."""
    with open_lesson(lesson) as opened:
        summary = opened.summary()
    return {f"{kind}_hz": count / summary.seconds for kind, count in sorted(summary.entries.items())}


def written_again(lesson: Path, folder: Path, name: str, observation_hz: float, persons: int) -> float:
    """MB of 45 minutes at a rate of every camera's observations, with so many persons in each."""
    with open_lesson(lesson) as opened:
        header, parts = opened.header, list(opened.parts())
    kinds = {kind: cycle(payloads) for kind, payloads in _payloads(parts, persons).items()}
    a_second = A_SECOND | {"observation": round(CAMERAS * observation_hz)}
    attempt = codec.encode(tried("basketball_shot", "no_knee_bend"))
    writer = LessonWriter.create(folder, name, header)
    for sequence in range(WRITTEN_S * PARTS_A_SECOND):
        begin_ns = sequence * 10**9 // PARTS_A_SECOND
        counts = {kind: count // PARTS_A_SECOND for kind, count in a_second.items()}
        entries = [
            Entry(kind, begin_ns + k * 10**9 // PARTS_A_SECOND // count, next(kinds[kind]))  # type: ignore[arg-type]
            for kind, count in counts.items()
            for k in range(count)
        ]
        if sequence % (ATTEMPT_EVERY_S * PARTS_A_SECOND) == 0:
            entries.append(Entry("feedback", begin_ns, attempt))
        writer.append(FusionLog(1, sequence, tuple(sorted(entries, key=lambda entry: entry.t_ns))))
    return writer.finish().stat().st_size / WRITTEN_S * LESSON_S / 1e6


def _payloads(parts: list[LessonPart], persons: int) -> dict[str, list[bytes]]:
    found: dict[str, list[bytes]] = defaultdict(list)
    for part in parts:
        for entry in part.entries:
            found[entry.kind].append(entry.payload)
    found["observation"] = list(_with_persons(found["observation"], persons))
    missing = [kind for kind in ("observation", *A_SECOND) if not found[kind]]
    if missing:
        raise SystemExit(f"the lesson has no {missing[0]}: did the cameras run? See bench/box.log in the data folder")
    return found


def _with_persons(payloads: list[bytes], persons: int) -> Iterator[bytes]:
    """Every observation of somebody, with exactly so many persons."""
    known: list[Observation] = [seen for payload in payloads if (seen := codec.decode(payload, Observation)).persons]
    for index, seen in enumerate(known):
        others = [known[index - step * len(known) // (persons + 1)].persons[0] for step in range(1, persons)]
        yield codec.encode(msgspec.structs.replace(seen, persons=(seen.persons[0], *others)))


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--site", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--warm", type=float, default=20.0)
    arguments = parser.parse_args()
    report = Report("bench-lessons")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lesson, figures = record(arguments.site, arguments.data, folder, arguments.seconds, arguments.warm)
        report.add(figures)
        report.add(rates(lesson), "recorded.")
        for label, hz, persons in (("4x15hz", 15, 1), ("4x15hz_two_persons", 15, 2), ("4x30hz", 30, 1)):
            report.add({f"lesson_mb_45min.{label}": written_again(lesson, folder, label, hz, persons)})
    return report.conclude(BARS, arguments.data)


if __name__ == "__main__":
    sys.exit(main())
