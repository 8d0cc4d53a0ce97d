"""A folder in which everything is right until a test breaks it."""

import hashlib
import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from edge.check import NETWORKS
from tests.integration.box import ROOT, fake_parts, write_site
from tests.ports import free_port
from tests.small_video import write_video

CALIBRATED_PX = (640, 480)
"""As in `CAMERA`."""


@dataclass(frozen=True)
class House:
    """A folder in which everything is right until a test breaks it. The processes that must not start are fake ones."""

    folder: Path
    page_port: int
    bus_port: int

    @property
    def site(self) -> Path:
        return self.folder / "site.toml"

    @property
    def rig(self) -> Path:
        return self.folder / "rig.toml"

    @property
    def data(self) -> Path:
        return self.folder / "data"

    @property
    def videos(self) -> Path:
        return self.data / "footage"

    @property
    def networks(self) -> Path:
        return self.data / "networks"

    def run(self) -> "subprocess.CompletedProcess[str]":
        command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(self.site), "--data", str(self.data)]
        environment = fake_parts(self.folder, check="edge.check:check")
        return subprocess.run(command, env=environment, capture_output=True, text=True, cwd=ROOT, timeout=60, check=False)


def build_house(folder: Path) -> House:
    """A site of two cameras with calibration, videos and (fake) networks."""
    house = House(folder, free_port(), free_port())
    write_site(folder, house.page_port, house.bus_port)
    house.videos.mkdir(parents=True)
    house.networks.mkdir()
    for name in "ab":
        write_video(house.videos / f"{name}.avi", frames=3, size_px=CALIBRATED_PX)
    describe(house)
    entries = {}
    for name in NETWORKS:
        content = name.encode() * 100
        (house.networks / f"{name}.onnx").write_bytes(content)
        entries[name] = {"file": f"{name}.onnx", "sha256": sha256(content), "recipe": "", "sources": {}}
    (house.networks / "installed.json").write_text(json.dumps({"version": 1, "networks": entries}))
    return house


def describe(house: House) -> None:
    """Write the index of the videos as they are now."""
    files = {path.name: path.read_bytes() for path in sorted(house.videos.glob("*.avi"))}
    described = {name: {"bytes": len(content), "sha256": sha256(content)} for name, content in files.items()}
    (house.videos / "installed.json").write_text(json.dumps({"recipe": "test", "files": described}))


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def replace_text(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))
