"""A room on a real bus, of which the test says what its processes say; the doctor listens to it as to a box."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from models.camera.rig import Rig
from models.config.site import SITE_VERSION, BusConfig, CameraConfig, Site, TabletConfig
from models.messages import codec, topics
from models.messages.health import CameraHealth, Health, MachineHealth, SupervisorHealth
from models.messages.motion import JointState, Motion
from models.messages.observation import Crop, Observation, Person
from models.messages.trouble import TroubleCode
from models.process import Bus, ProcessContext, Resources
from services.bus.zenoh_bus import open_client, open_router
from services.doctor.box import BoxFacts, judge_box
from services.doctor.finding import Examined
from services.doctor.listen import listen
from services.doctor.processes import RunningBox
from services.fusion.process import FusionLoop
from services.support.cpu import CpuMeter
from services.support.machine import MachineMeter, Sensors
from services.support.version import kinebox_version
from tests.integration.waiting import DEADLINE_S, until
from tests.ports import free_port
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person as Pupil

RIG = ring_rig(4)
OTHERS = ("tablet", "supervisor")
_SAY_S = 0.3
_FILM_S = 1 / 15


@dataclass
class Room:
    """A bus with a router, and voices on it.

    Attributes:
        bus: the router's.
        voices: what each process says, asked three times a second.
    """

    folder: Path
    site: Site
    bus: Bus
    voices: dict[str, Callable[[], Health | bytes]] = field(default_factory=dict)

    def health(self, process: str) -> Health:
        """A process that is well."""
        name = process.removeprefix("edge-")
        camera = CameraHealth(name, 30.0, 15.0, 15.0, 0, 20.0, "thunder", {}) if process.startswith("edge-") else None
        return Health(process, 1, time.monotonic_ns(), "ok", (), 0.1, 50.0, camera=camera)

    def supervisor(self, machine: MachineHealth) -> Health:
        """A supervisor that is well and measured that machine."""
        told = SupervisorHealth(kinebox_version(), time.monotonic_ns(), ())
        return Health("supervisor", 1, time.monotonic_ns(), "ok", (), 0.1, 50.0, machine=machine, supervisor=told)

    def measured(self, sensors: Sensors) -> Callable[[], MachineHealth]:
        """The real measuring, with a few sensors of the test's."""
        return MachineMeter(self.folder, sensors)

    def wait_until_said(self, process: str, code: TroubleCode) -> None:
        """Until a process that runs has told of a trouble."""
        heard = self.bus.subscribe(topics.health(process), keep=4)

        def said() -> bool:
            delivery = heard.receive(0.1)
            return delivery is not None and code in {each.code for each in codec.decode(delivery.payload, Health).troubles}

        until(said, f"{process} to say {code}")
        heard.close()

    def judged(self) -> Examined:
        """What the doctor finds."""
        stop = threading.Event()
        speaking = threading.Thread(target=self._speak, args=(stop,), daemon=True)
        speaking.start()
        try:
            expected = ("fusion", *(f"edge-{camera.name}" for camera in self.site.cameras), *OTHERS)
            heard = listen(self.site, frozenset(expected))
        finally:
            stop.set()
            speaking.join()
        running = RunningBox(self.folder / "site.toml")
        return judge_box(BoxFacts(self.site, self.folder, running, expected, heard, kinebox_version(), time.monotonic_ns()))

    def _speak(self, stop: threading.Event) -> None:
        while not stop.wait(_SAY_S):
            for process, voice in self.voices.items():
                said = voice()
                self.bus.publish(topics.health(process), said if isinstance(said, bytes) else codec.encode(said))


@contextmanager
def room(folder: Path, *, fusion: bool = False) -> Iterator[Room]:
    """A room in which everybody is well; with `fusion` that voice is left to the real process."""
    endpoint = f"tcp/127.0.0.1:{free_port()}"
    site = Site(
        version=SITE_VERSION,
        name="Synthetic gym",
        calibration="rig.toml",
        cameras=[CameraConfig(name=name, kind="video", path="none.avi") for name in RIG.names],
        bus=BusConfig(endpoint=endpoint),
        tablet=TabletConfig(host="127.0.0.1", port=free_port()),
    )
    bus = open_router(endpoint)
    try:
        made = Room(folder, site, bus)
        names = [f"edge-{name}" for name in RIG.names] + ["tablet"] + ([] if fusion else ["fusion"])
        made.voices = {name: lambda name=name: made.health(name) for name in names}  # type: ignore[misc]
        measure = made.measured(Sensors())
        made.voices["supervisor"] = lambda: made.supervisor(measure())
        for name in made.voices:
            bus.declare_alive(topics.alive(name))
        yield made
    finally:
        bus.close()


@contextmanager
def filmed(folder: Path, calibration: Rig = RIG, late: str = "", age_ms: int = 0) -> Iterator[Room]:
    """A room with the real fusion, and cameras that film a pupil who walks and throws.

    Args:
        folder: for data.
        calibration: what fusion believes of the cameras, which are where `RIG` has them.
        late: a camera that counts one loop of its film less than the others.
        age_ms: of the pictures when they reach fusion; with old ones no figure is waited for that is sure, as there may be none.
    """
    stop = threading.Event()
    with room(folder, fusion=True) as made:
        context = ProcessContext(
            name="fusion",
            camera=None,
            site=made.site,
            rig=calibration,
            data=folder,
            start_ns=time.monotonic_ns(),
            bus=made.bus,
            stop=stop,
            resources=lambda: Resources(0.1, 100.0),
        )
        cameras = open_client(made.site.bus.endpoint, stop)
        assert cameras is not None
        threads = [
            threading.Thread(target=FusionLoop(context, CpuMeter()).run, daemon=True),
            threading.Thread(target=_film, args=(cameras, stop, late, age_ms), daemon=True),
        ]
        for thread in threads:
            thread.start()
        try:
            figures = cameras.subscribe(topics.motion("live"), keep=1)
            until(lambda: (came := figures.receive(0.1)) is not None and (age_ms > 0 or _is_sure(came.payload)), "a figure")
            yield made
        finally:
            stop.set()
            for thread in threads:
                thread.join(DEADLINE_S)
            cameras.close()


def _is_sure(payload: bytes) -> bool:
    return bool((codec.decode(payload, Motion).states == JointState.SEEN).all())


def _film(bus: Bus, stop: threading.Event, late: str, age_ms: int) -> None:
    random = np.random.default_rng(7)
    pupil = Pupil()
    sequence = 0
    while not stop.wait(_FILM_S / len(RIG)):
        camera = RIG.cameras[sequence % len(RIG)]
        t_ns = time.monotonic_ns() - age_ms * 1_000_000
        pixels = camera.project(pupil.joints(t_ns * 1e-9 % 1000)) + random.normal(0.0, 2.0, (17, 2))
        crop = Crop(float(pixels[:, 0].mean()), float(pixels[:, 1].mean()), 400.0)
        person = Person(1, crop, pixels.astype(np.float32), np.full(17, 2, np.float32), np.full(17, 0.8, np.float32))
        epoch = 1 if camera.name == late else 2
        observation = Observation(camera.name, epoch, sequence, sequence, t_ns, t_ns, "thunder", (person,))
        bus.publish(topics.observation(camera.name), codec.encode(observation))
        sequence += 1


def turned(name: str, degrees: float) -> Rig:
    """The calibration of `RIG` with one camera turned about its vertical axis."""
    angle = np.deg2rad(degrees)
    turn = np.array(((np.cos(angle), 0.0, np.sin(angle)), (0.0, 1.0, 0.0), (-np.sin(angle), 0.0, np.cos(angle))))
    return Rig(
        tuple(
            replace(camera, rotation=turn @ camera.rotation, translation_m=turn @ camera.translation_m)
            if camera.name == name
            else camera
            for camera in RIG
        )
    )
