"""The box as it is shipped: real footage, real networks, real sockets, every process; and what is left when one is killed."""

import json
import os
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

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from services.tablet import motion_frame
from services.tablet.motion_frame import MotionFrame
from tests.acknowledged import Acknowledged
from tests.installed import ROOT, require_footage, require_lesson, require_networks
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]

SHIPPED = ROOT / "deploy/sites/footage"
STARTING_S = 120.0
"""A machine that has never compiled the kernels compiles them now."""
POSTS = 8
"""Fusion, four cameras, the page, the evaluation and the recorder."""


@dataclass
class Box:
    """A running box."""

    process: subprocess.Popen[bytes]
    port: int

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
def running(folder: Path, more_site: str = "", shipped: Path = SHIPPED) -> Iterator[Box]:
    data = require_footage() if shipped == SHIPPED else require_lesson()
    require_networks()
    port = free_port()
    (folder / "rig.toml").write_bytes((shipped / "rig.toml").read_bytes())
    more = f'\n[bus]\nendpoint = "tcp/127.0.0.1:{free_port()}"\n[tablet]\nhost = "127.0.0.1"\nport = {port}\n'
    (folder / "site.toml").write_text((shipped / "site.toml").read_text() + more + more_site)
    command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(folder / "site.toml"), "--data", str(data)]
    with (folder / "output").open("wb") as output:
        process = subprocess.Popen(bound(command), cwd=ROOT, stdout=output, stderr=output)
    box = Box(process, port)
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
def shipped_box(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Box]:
    """One box for those who leave it as they found it."""
    with running(tmp_path_factory.mktemp("box")) as box:
        yield box


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


def test_a_camera_that_is_killed_is_seen_the_lesson_goes_on_and_it_comes_back(shipped_box: Box) -> None:
    box = shipped_box
    with tablet(box) as client:
        client.pose()
        until(lambda: box.camera("cam03")["used"] is True, "camera 3 in use", STARTING_S)
        edge = box.child("edge", "--camera", "cam03")
        assert edge is not None
        edge.kill()
        until(lambda: box.camera("cam03")["state"] != "ok", "camera 3 seen to be gone")
        frame = client.pose()
        assert (frame.states == JointState.SEEN).sum() >= 9
        until(lambda: box.camera("cam03")["used"] is True, "camera 3 back", STARTING_S)


def test_the_supervisors_death_leaves_nothing_behind(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        supervisor = psutil.Process(box.process.pid)
        until(lambda: len(supervisor.children()) >= POSTS, "everybody started")
        children = supervisor.children(recursive=True)
        os.kill(box.process.pid, signal.SIGKILL)
        gone, alive = psutil.wait_procs(children, timeout=30)
        assert not alive
        assert len(gone) == len(children)


def test_sigterm_ends_everything_cleanly(tmp_path: Path) -> None:
    with running(tmp_path) as box:
        children = psutil.Process(box.process.pid).children(recursive=True)
        box.process.terminate()
        assert box.process.wait(30) == 0
        assert not [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
