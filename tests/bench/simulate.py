"""What rendering a lesson costs: `make bench-simulate`.

`kinebox simulate` renders 24 s of the six actions for four cameras, at 1280x720 and 30 pictures a second; its kernels are compiled.
`render_s`: from the command to the finished lesson; `render_cpu_s`: of all its processes; `render_mb`: the most memory that they
held together, looked at twice a second; what they share counts once.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Final

import msgspec
import psutil

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.plan import encode_plan
from edge.simulation.lesson.presets import six_actions
from edge.simulation.lesson.world_faults import picture_count
from tests.bench.report import Report
from tests.installed import ROOT
from tests.lifeline import bound

SECONDS: Final = 24.0
BARS: Final = {"render_s": ("<=", 360.0), "render_mb": ("<=", 1500.0)}
_LOOK_S: Final = 0.5


def cost(seconds: float, folder: Path, data: Path) -> dict[str, float]:
    """Render so much of the six actions in an empty folder; what that took."""
    plan = msgspec.structs.replace(six_actions(), name="bench", length_s=seconds)
    path = folder / "plan.toml"
    path.write_bytes(encode_plan(plan))
    command = [
        sys.executable,
        "-m",
        "services.cli.main",
        "simulate",
        str(path),
        "--data",
        str(data),
        "--out",
        str(folder / "lesson"),
    ]
    began_s, cpu_before_s = time.monotonic(), _cpu_of_children_s()
    process = subprocess.Popen(bound(command), cwd=ROOT)
    most_mb = 0.0
    while process.poll() is None:
        most_mb = max(most_mb, _together_mb(process.pid))
        time.sleep(_LOOK_S)
    if process.returncode:
        raise SystemExit(process.returncode)
    took_s = time.monotonic() - began_s
    return {
        "render_s": took_s,
        "render_cpu_s": _cpu_of_children_s() - cpu_before_s,
        "render_mb": most_mb,
        "render_pictures_per_s": picture_count(plan, seconds) * len(rig_of(plan)) / took_s,
    }


def _together_mb(pid: int) -> float:
    """Of a process and its descendants; those that end meanwhile count no more."""
    try:
        parent = psutil.Process(pid)
        held = 0.0
        for process in (parent, *parent.children(recursive=True)):
            try:
                held += process.memory_full_info().pss / 2**20
            except psutil.Error:
                continue
    except psutil.Error:
        return 0.0
    return held


def _cpu_of_children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=SECONDS, help="of the lesson; the figures of record are of 24")
    options = parser.parse_args()
    report = Report("bench-simulate")
    with tempfile.TemporaryDirectory(dir=options.data) as folder:
        report.add(cost(options.seconds, Path(folder), options.data))
    return report.conclude(BARS if options.seconds == SECONDS else {}, options.data)


if __name__ == "__main__":
    sys.exit(main())
