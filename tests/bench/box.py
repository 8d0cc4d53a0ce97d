"""Live rate, latency, CPU and memory of the whole box, as `kinebox run` starts it.

Four sources play in real time, all processes run, and a socket client (this process; no rendering browser) receives the
live figure as a tablet would and acknowledges it. Fresh inferences are counted on the bus from the observations themselves,
so that interpolation can't fake them. No figure is measured across a seam of the looping footage, but for
`live_fps.with_seams`. Then the same confined to one core. Whole ticks are counted, so 30 a second is judged to a tenth.
"""

import argparse
import os
import statistics
import sys
import threading
import time
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from models.config.site import Site, decode_site
from models.messages import codec, topics
from models.messages.health import Health
from models.messages.motion import JointState
from models.messages.observation import Observation
from services.bus.zenoh_bus import open_client
from services.tablet import motion_frame
from services.tablet.camera_state import BACKLOG_MS
from tests.acknowledged import Acknowledged
from tests.bench.report import Report
from tests.bench.running_box import CpuMeter, CpuUsed, processes, rss_mb, running_box

WARM_S = 60
MIN_JOINTS_SEEN = 9
FRAME_NS = 33_333_333
SEAM_FRAMES = 10
BARS = {
    "live_fps": (">=", 29.95),
    "fresh_hz.min": (">=", 10.0),
    "latency_ms.p95": ("<=", 250.0),
    "rss_growth_pct": ("<=", 2.0),
}
HALF_BARS = {
    "half_quota.fresh_hz.min": (">=", 5.0),
    "half_quota.fresh_hz.alike_pct": (">=", 90.0),
    "half_quota.backlog_ms.max": ("<=", BACKLOG_MS),
}
"""With half the CPU the rate falls, of all four cameras alike, and nobody's pictures wait."""


@dataclass(frozen=True)
class LiveMotion:
    """One live motion as the client received it; CLOCK_MONOTONIC."""

    received_ns: int
    newest_ns: int
    epoch: int
    t_ns: int
    joints_seen: int

    @property
    def is_pose(self) -> bool:
        """Whether more than half of the joints were seen by two views."""
        return self.joints_seen >= MIN_JOINTS_SEEN


@dataclass
class Heard:
    """Everything that was measured while listening, with the time of receipt in monotonic nanoseconds."""

    motions: list[LiveMotion] = field(default_factory=list)
    frames: dict[str, set[tuple[int, int]]] = field(default_factory=lambda: defaultdict(set))  # (epoch, frame) per camera
    stage_ms: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    edge_total_ms: list[float] = field(default_factory=list)
    plans: list[str] = field(default_factory=list)  # of every camera, each second: "thunder_10hz"
    backlog_ms: list[float] = field(default_factory=list)


@dataclass
class Memory:
    """Resident memory by process over time."""

    samples: list[tuple[float, dict[str, float]]] = field(default_factory=list)

    def take(self, box: psutil.Process, seconds: float) -> None:
        """One sample of every process of the box."""
        self.samples.append((seconds, {name: rss_mb(process) for name, process in processes(box).items()}))

    def growth_pct(self) -> float:
        """Sum over all processes, the last minute over the second."""
        second = [sum(rss.values()) for at, rss in self.samples if 60 <= at < 120]
        last = [sum(rss.values()) for at, rss in self.samples if at >= self.samples[-1][0] - 60]
        return 100 * (statistics.mean(last) / statistics.mean(second) - 1) if second and last else float("nan")


def watch_page(url: str, heard: Heard, stop: threading.Event) -> None:
    """Be a tablet: receive, decode, acknowledge."""
    while not stop.is_set():
        try:
            with connect(url, compression=None, open_timeout=2) as socket:
                acknowledged = Acknowledged()
                while not stop.is_set():
                    message = socket.recv(timeout=5)
                    now_ns = time.monotonic_ns()
                    if isinstance(message, bytes):
                        frame = motion_frame.unpack(message)
                        seen = int((frame.states == JointState.SEEN).sum())
                        heard.motions.append(LiveMotion(now_ns, frame.t_newest_ns, frame.epoch, frame.t_ns, seen))
                    socket.send(acknowledged.after(message))
        except (OSError, TimeoutError, WebSocketException):
            time.sleep(0.2)


def watch_bus(site: Site, heard: Heard, stop: threading.Event) -> None:
    """Count fresh frames from the observations, and take the cameras' stage times from their health."""
    bus = open_client(site.bus.endpoint, stop)
    if bus is None:
        return
    subscription = bus.subscribe(*(topics.observation(camera.name) for camera in site.cameras), topics.ALL_HEALTH, keep=64)
    while not stop.is_set():
        delivery = subscription.receive(0.5)
        if delivery is None:
            continue
        if delivery.topic.endswith("/observation"):
            observation = codec.decode(delivery.payload, Observation)
            heard.frames[observation.camera].add((observation.epoch, observation.frame))
            continue
        camera = codec.decode(delivery.payload, Health).camera
        if camera is not None and camera.stage_ms:
            for stage, value in camera.stage_ms.items():
                heard.stage_ms[stage].append(value)
            heard.edge_total_ms.append(sum(camera.stage_ms.values()))
            heard.plans.append(f"{camera.network}_{camera.target_hz:g}hz")
            heard.backlog_ms.append(camera.backlog_ms)
    bus.close()


def measure(site_path: Path, data: Path, seconds: float, warm_s: float, cpus: set[int] | None) -> dict[str, float]:
    """Run the box, let it warm up, listen for `seconds`."""
    site = decode_site(site_path.read_bytes(), site_path)
    stop, heard, memory = threading.Event(), Heard(), Memory()
    with running_box(site_path, data, cpus) as box:
        listeners = [
            threading.Thread(target=watch_page, args=(f"ws://127.0.0.1:{site.tablet.port}/ws", heard, stop)),
            threading.Thread(target=watch_bus, args=(site, heard, stop)),
        ]
        for listener in listeners:
            listener.start()
        started = time.monotonic()
        try:
            memory_until(box, memory, started, warm_s)
            for collected in (heard.motions, heard.frames, heard.stage_ms, heard.edge_total_ms, heard.plans, heard.backlog_ms):
                collected.clear()
            heard.frames.update({camera.name: set() for camera in site.cameras})  # One that shows nothing counts, too.
            meter = CpuMeter(lambda: processes(box).values())
            memory_until(box, memory, started, warm_s + seconds)
            used = meter.read()
        finally:
            stop.set()
            for listener in listeners:
                listener.join(10)
    return summary(heard, memory, used)


def memory_until(box: psutil.Process, memory: Memory, started: float, end_s: float) -> None:
    """Sample memory every two seconds until `end_s` after `started`."""
    while (at := time.monotonic() - started) < end_s:
        if not box.is_running():
            raise SystemExit("the box ended; see bench/box.log in the data folder")
        memory.take(box, at)
        time.sleep(min(2.0, max(end_s - at, 0.0)))


def summary(heard: Heard, memory: Memory, used: CpuUsed) -> dict[str, float]:
    """Figures under their fixed names."""
    poses = [motion for motion in heard.motions if motion.is_pose]
    latency = np.array([(motion.received_ns - motion.newest_ns) * 1e-6 for motion in poses])
    fresh = {name: len(frames) / used.seconds for name, frames in heard.frames.items()}
    figures = {
        "live_fps": between_seams_hz(heard.motions),
        "live_fps.with_seams": len(poses) / used.seconds,
        "motions_per_s": len(heard.motions) / used.seconds,
        "fresh_hz.min": min(fresh.values(), default=float("nan")),
        "fresh_hz.alike_pct": 100 * min(fresh.values()) / max(fresh.values()) if any(fresh.values()) else float("nan"),
        **{f"fresh_hz.{name}": rate for name, rate in sorted(fresh.items())},
        "cpu_cores": used.cores,
        **{f"edge_ms.{stage}": statistics.mean(values) for stage, values in sorted(heard.stage_ms.items())},
        "edge_ms.total": statistics.mean(heard.edge_total_ms) if heard.edge_total_ms else float("nan"),
        **{f"plan_pct.{plan}": 100 * n / len(heard.plans) for plan, n in sorted(Counter(heard.plans).items())},
        "backlog_ms.max": max(heard.backlog_ms, default=float("nan")),
        **{f"rss_mb.{name}": rss for name, rss in sorted(memory.samples[-1][1].items())},
        "rss_growth_pct": memory.growth_pct(),
    }
    if len(latency):
        figures |= {f"latency_ms.p{q}": float(np.percentile(latency, q)) for q in (50, 95, 99)}
    return figures


def between_seams_hz(motions: list[LiveMotion]) -> float:
    """Fused poses a second where no loop of the footage interferes: the first ten frames of each epoch are left out."""
    by_epoch: dict[int, list[LiveMotion]] = defaultdict(list)
    for motion in motions:
        by_epoch[motion.epoch].append(motion)
    poses, seconds = 0, 0.0
    for epoch in sorted(by_epoch)[1:-1]:
        whole = by_epoch[epoch]
        first_ns = min(motion.t_ns for motion in whole) + SEAM_FRAMES * FRAME_NS
        last_ns = max(motion.t_ns for motion in whole)
        poses += sum(motion.is_pose and motion.t_ns >= first_ns for motion in whole)
        seconds += (last_ns - first_ns + FRAME_NS) * 1e-9
    return poses / seconds if seconds > 0 else float("nan")


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--site", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--half-seconds", type=float, default=60.0)
    arguments = parser.parse_args()
    report = Report("bench-box")
    report.add(measure(arguments.site, arguments.data, arguments.seconds, WARM_S, None))
    if arguments.half_seconds > 0:
        one_core = {min(os.sched_getaffinity(0))}
        report.add(measure(arguments.site, arguments.data, arguments.half_seconds, WARM_S, one_core), prefix="half_quota.")
    return report.conclude(BARS | HALF_BARS if arguments.half_seconds > 0 else BARS, arguments.data)


if __name__ == "__main__":
    sys.exit(main())
