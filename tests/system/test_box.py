"""The box as it is shipped: real footage, real networks, real sockets, every process; and what is left when one is killed.

Tests share one box of each footage, since a start costs more than most of what is looked at: those that end it come last.
"""

import json
import os
import re
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import psutil
import pytest
from websockets.sync.client import ClientConnection, connect

from edge.footage.sets import FOOTAGES, ONE_PERSON, TWO_PEOPLE
from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from services.tablet import motion_frame
from services.tablet.motion_frame import MotionFrame
from tests.acknowledged import Acknowledged
from tests.bench.running_box import processes
from tests.installed import DATA, ROOT, require_footage, require_lesson, require_networks
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]

SITES = ROOT / "deploy/sites"
STARTING_S = 120.0
"""A machine that has never compiled the kernels compiles them now."""
POSTS = 8
"""Fusion, four cameras, the page, the evaluation and the recorder."""


@dataclass
class Box:
    """A running box; its folder has its site file."""

    process: subprocess.Popen[bytes]
    port: int
    folder: Path

    @property
    def site(self) -> Path:
        return self.folder / "site.toml"

    def status(self) -> dict[str, object]:
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/api/status", timeout=5) as answer:
            status: dict[str, object] = json.load(answer)
            return status

    def camera(self, name: str) -> dict[str, object]:
        cameras = self.status()["cameras"]
        assert isinstance(cameras, list)
        return next(camera for camera in cameras if camera["name"] == name)

    def answers(self) -> bool:
        try:
            return bool(self.status())
        except OSError:
            return False

    def child(self, *words: str) -> psutil.Process | None:
        for child in psutil.Process(self.process.pid).children(recursive=True):
            if set(words) <= set(child.cmdline()):
                return child
        return None


@contextmanager
def running(folder: Path, shipped: Path, more_site: str = "") -> Iterator[Box]:
    data = require_footage(FOOTAGES[shipped.name]) if shipped.name in FOOTAGES else require_lesson()
    require_networks()
    port = free_port()
    (folder / "rig.toml").write_bytes((shipped / "rig.toml").read_bytes())
    more = f'\n[bus]\nendpoint = "tcp/127.0.0.1:{free_port()}"\n[tablet]\nhost = "127.0.0.1"\nport = {port}\n'
    (folder / "site.toml").write_text((shipped / "site.toml").read_text() + more + more_site)
    command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(folder / "site.toml"), "--data", str(data)]
    with (folder / "output").open("wb") as output:
        process = subprocess.Popen(bound(command), cwd=ROOT, stdout=output, stderr=output)
    box = Box(process, port, folder)
    try:
        until(lambda: box.answers() or process.poll() is not None, "the page's server", STARTING_S)
        assert process.poll() is None, (folder / "output").read_text()
        yield box
    finally:
        if process.poll() is None:
            process.terminate()
        process.wait(30)


class Tablet:
    """A client that acknowledges what it gets."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._acknowledged = Acknowledged()

    def motion(self) -> MotionFrame:
        """The next motion."""
        while True:
            message = self._socket.recv(timeout=30)
            self._socket.send(self._acknowledged.after(message))
            if isinstance(message, bytes):
                return motion_frame.unpack(message)

    def call(self, pupil: str) -> None:
        """Say who is up, by his code."""
        self._socket.send(json.dumps({"type": "turn", "pupil": pupil}))

    def pose(self) -> MotionFrame:
        """The next motion in which every limb was seen; a lesson goes on for long enough to have one."""
        limbs = sorted({joint for limb in coco.LIMBS.values() for joint in limb})
        for _ in range(2000):
            frame = self.motion()
            if (frame.states[limbs] == JointState.SEEN).all():
                return frame
        raise AssertionError("no whole figure in 2000 motions")


@contextmanager
def tablet(box: Box) -> Iterator[Tablet]:
    with connect(f"ws://127.0.0.1:{box.port}/ws", compression=None) as socket:
        yield Tablet(socket)


def limb_lengths_m(frame: MotionFrame) -> Float:
    joints = frame.positions_mm / 1000.0
    return np.array([np.linalg.norm(joints[a] - joints[b]) for a, b in coco.LIMBS.values()])


def heights_mm(frame: MotionFrame, name: str) -> Float:
    """(2,) heights of the left and the right joint; they are limbs' ends, so `pose` waits until they are seen."""
    heights: Float = frame.positions_mm[[coco.INDEX[f"left_{name}"], coco.INDEX[f"right_{name}"]], 2].astype(np.float64)
    return heights


@pytest.fixture(scope="module")
def shipped_box(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Box]:
    """The box that plays a footage; pytest calls together those who name the same."""
    folder = tmp_path_factory.mktemp("box")
    with running(folder, SITES / request.param, f'[lessons]\nfolder = "{folder / "lessons"}"\n') as box:
        yield box


def plays(*footages: str) -> pytest.MarkDecorator:
    """The test is of the box that plays each of these."""
    return pytest.mark.parametrize("shipped_box", footages, indirect=True)


def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "services.cli.main", *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=120, check=False)


@plays(ONE_PERSON.name)
def test_footage_becomes_a_figure_of_human_proportions_that_moves(shipped_box: Box) -> None:
    with tablet(shipped_box) as client:
        frames = [client.pose() for _ in range(20)]
    lengths = np.median([limb_lengths_m(frame) for frame in frames], axis=0)
    assert (lengths > 0.15).all()
    assert (lengths < 0.65).all()
    left, right = lengths[0::2], lengths[1::2]
    assert np.abs(left / right - 1).max() < 0.2
    for above, below in [("shoulder", "hip"), ("hip", "knee"), ("knee", "ankle")]:
        assert all((heights_mm(frame, above) > heights_mm(frame, below)).all() for frame in frames)
    travelled = np.ptp([frame.positions_mm for frame in frames], axis=0)
    assert travelled.max() > 20


@plays(ONE_PERSON.name)
def test_a_camera_that_is_killed_is_seen_the_lesson_goes_on_and_it_comes_back(shipped_box: Box) -> None:
    box = shipped_box
    with tablet(box) as client:
        client.pose()
        until(lambda: box.camera("cam03")["used"] is True, "camera 3 in use", STARTING_S)
        edge = box.child("edge", "--camera", "cam03")
        assert edge is not None
        edge.kill()
        until(lambda: box.camera("cam03")["state"] == "lost", "camera 3 seen to be gone")
        frame = client.pose()
        assert (frame.states == JointState.SEEN).sum() >= 9
        until(lambda: box.camera("cam03")["used"] is True, "camera 3 back", STARTING_S)


@plays(*FOOTAGES)
def test_fusion_killed_in_a_lesson_costs_a_gap_and_both_segments_replay_bit_for_bit(shipped_box: Box) -> None:
    box, site = shipped_box, ("--site", str(shipped_box.site))

    def recorded(seconds: float, gaps: int) -> bool:
        recording = box.status()["recording"]
        return isinstance(recording, dict) and recording["recorded_s"] >= seconds and recording["gaps"] == gaps

    with tablet(box) as client:
        client.pose()
    begun = kinebox("record", *site, "--detach", "--title", "With a fault")
    assert begun.returncode == 0, begun.stderr
    until(lambda: recorded(2.0, 0), "two seconds of the lesson", STARTING_S)
    processes(psutil.Process(box.process.pid))["fusion"].kill()
    until(lambda: recorded(5.0, 1), "the lesson to go on after a gap", STARTING_S)
    ended = kinebox("record", *site, "--stop")
    assert ended.returncode == 0, ended.stderr
    assert "1 gap" in ended.stdout
    (listed,) = json.loads(kinebox("lessons", *site, "--json").stdout)
    assert (listed["state"], listed["segments"], listed["gaps"], listed["problem"]) == ("finished", 2, 1, "")
    checked = kinebox("replay", listed["file"], "--check", "--data", str(DATA))
    assert checked.returncode == 0, checked.stdout + checked.stderr
    found = re.match(r"all (\d+) motions are equal bit for bit \(2 segments", checked.stdout)
    assert found is not None, checked.stdout
    assert int(found[1]) > 30, "a busy box gives out fewer"


@plays(TWO_PEOPLE.name)
def test_the_supervisors_death_leaves_nothing_behind(shipped_box: Box) -> None:
    supervisor = psutil.Process(shipped_box.process.pid)
    until(lambda: len(supervisor.children()) >= POSTS, "everybody started")
    children = supervisor.children(recursive=True)
    os.kill(supervisor.pid, signal.SIGKILL)
    gone, alive = psutil.wait_procs(children, timeout=30)
    assert not alive
    assert len(gone) == len(children)


@plays(ONE_PERSON.name)
def test_sigterm_ends_everything_cleanly(shipped_box: Box) -> None:
    children = psutil.Process(shipped_box.process.pid).children(recursive=True)
    shipped_box.process.terminate()
    assert shipped_box.process.wait(30) == 0
    assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
