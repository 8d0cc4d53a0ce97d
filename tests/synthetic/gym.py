"""Cameras around the synthetic person, and what a fallible network would report from their pictures."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from models.arrays import Float
from models.camera.pinhole import Camera
from models.camera.rig import Rig
from models.messages.observation import Crop, Observation
from models.messages.observation import Person as Seen
from models.skeleton import coco
from services.fusion.pipeline import Tick
from tests.synthetic.person import Person

T0_NS = 5_000_000_000_000
"""The synthetic clock's start: far from zero, as CLOCK_MONOTONIC is."""
_MIRROR = np.array(coco.MIRROR)
_ARMS = [5, 6, 7, 8, 9, 10]
_LEGS = [11, 12, 13, 14, 15, 16]


def ring_rig(cameras: int = 4, radius_m: float = 6.2, height_m: float = 2.2, *, distorted: bool = False) -> Rig:
    """Cameras on a circle that look at one metre above its centre."""
    made = []
    for index in range(cameras):
        angle = 2 * np.pi * (index + 0.3) / cameras
        centre = np.array((radius_m * np.cos(angle), radius_m * np.sin(angle), height_m + 0.1 * index))
        forward = np.array((0.0, 0.0, 1.0)) - centre
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        rotation = np.stack((right, np.cross(forward, right), forward))
        made.append(
            Camera(
                name=f"cam{index}",
                size_px=(1280, 720),
                matrix_px=np.array(((900.0, 0.0, 640.0), (0.0, 900.0, 360.0), (0.0, 0.0, 1.0))),
                distortion=np.array((-0.1, 0.02, 0.001, -0.001, 0.0)) if distorted else np.zeros(5),
                rotation=rotation,
                translation_m=-rotation @ centre,
                shift_px=np.zeros(2),
            )
        )
    return Rig(tuple(made))


def knocked(rig: Rig, index: int) -> Rig:
    """The calibration of cameras of which one was turned since."""
    camera = rig.cameras[index]
    turn = np.array(((np.cos(0.12), 0.0, np.sin(0.12)), (0.0, 1.0, 0.0), (-np.sin(0.12), 0.0, np.cos(0.12))))
    tilt = np.array(((1.0, 0.0, 0.0), (0.0, np.cos(0.12), -np.sin(0.12)), (0.0, np.sin(0.12), np.cos(0.12))))
    rotation = tilt @ turn @ camera.rotation
    moved = replace(camera, rotation=rotation, translation_m=-rotation @ camera.centre_m)
    return Rig((*rig.cameras[:index], moved, *rig.cameras[index + 1 :]))


@dataclass(frozen=True, kw_only=True)
class Gym:
    """What is filmed, and how well the network sees it.

    Attributes:
        rates_hz: inferences a second of each camera, repeated over the cameras.
        noise_px: sigma of a keypoint.
        reported_px: sigma that the network reports.
        tail: share of keypoints whose error is four times as large.
        occlusion: share of time in which a joint is hidden from a camera: 6 times the noise, score 0.25.
        swap: share of time in which left and right are exchanged (body, arms or legs).
        distractor: share of time in which one camera sees a wrist somewhere else, confidently.
        bystanders: persons, with the cameras that see them, who are not the pupil.
        jitter: share of the time between two inferences by which it varies.
        phases_s: time of each camera's first inference; None draws it within one interval.
        latency_s: mean time from exposure to arrival; varies by a third.
        dead: cameras by index with the (from, to) seconds in which they are silent.
        seed: of the random numbers.
    """

    rig: Rig = field(default_factory=ring_rig)
    pupil: Person = field(default_factory=Person)
    seconds: float = 6.0
    rates_hz: tuple[float, ...] = (15.0, 12.0, 10.0, 14.0)
    noise_px: float = 2.5
    reported_px: float = 2.5
    tail: float = 0.05
    occlusion: float = 0.08
    swap: float = 0.04
    distractor: float = 0.05
    bystanders: tuple[tuple[Person, tuple[int, ...]], ...] = ()
    jitter: float = 0.15
    phases_s: tuple[float, ...] | None = None
    latency_s: float = 0.06
    dead: tuple[tuple[int, float, float], ...] = ()
    seed: int = 0

    def quiet(self) -> "Gym":
        """The same gym with nothing but Gaussian noise."""
        return replace(self, tail=0.0, occlusion=0.0, swap=0.0, distractor=0.0)

    def truth(self, t_ns: int) -> Float:
        """(17, 3) the pupil at an instant."""
        return self.pupil.joints((t_ns - T0_NS) * 1e-9)

    def events(self, tick_hz: float = 30.0) -> list[Observation | Tick]:
        """Observations in order of arrival, and ticks between them."""
        timed: list[tuple[float, int, Observation | Tick]] = []
        for camera in range(len(self.rig)):
            random = np.random.default_rng((self.seed, camera))
            timed += [(arrival, camera, observation) for arrival, observation in self._observations(camera, random)]
        ticks = round(self.seconds * tick_hz)
        timed += [(k / tick_hz, 99, Tick(T0_NS + round(k * 1e9 / tick_hz))) for k in range(1, ticks + 1)]
        timed.sort(key=lambda entry: entry[:2])
        return [event for arrival, _, event in timed if arrival <= self.seconds]

    def _observations(self, camera: int, random: np.random.Generator) -> Iterator[tuple[float, Observation]]:
        rate = self.rates_hz[camera % len(self.rates_hz)]
        faults = _Faults(self, random)
        drawn = random.uniform(0.0, 1.0 / rate)
        t, sequence = drawn if self.phases_s is None else self.phases_s[camera], 0
        while t < self.seconds:
            t_ns = T0_NS + round(t * 1e9)
            faults.advance(1.0 / rate)
            persons = []
            if not any(index == camera and start <= t < stop for index, start, stop in self.dead):
                persons = [faults.apply(self._see(self.pupil, camera, t, random), 1, random)]
                for number, (bystander, cameras) in enumerate(self.bystanders):
                    if camera in cameras:
                        plain = self._see(bystander, camera, t, random)
                        persons.append(_person(plain, np.full(coco.COUNT, self.reported_px), np.full(coco.COUNT, 0.9), 10 + number))
                arrival = t + self.latency_s * random.uniform(0.67, 1.33)
                name = self.rig.names[camera]
                yield arrival, Observation(name, 0, sequence, sequence, t_ns, t_ns, "synthetic", tuple(persons))
            sequence += 1
            t += random.uniform(1.0 - self.jitter, 1.0 + self.jitter) / rate

    def _see(self, person: Person, camera: int, t: float, random: np.random.Generator) -> Float:
        exact = self.rig.cameras[camera].project(person.joints(t))
        noise = random.normal(0.0, self.noise_px, (coco.COUNT, 2))
        noise[random.uniform(size=coco.COUNT) < self.tail] *= 4.0
        return exact + noise


class _Faults:
    """Errors that last: each begins at random and goes on for 0.3 s on average."""

    def __init__(self, gym: Gym, random: np.random.Generator) -> None:
        self._gym = gym
        self._random = random
        self._hidden = np.zeros(coco.COUNT, np.bool_)
        self._swapped: list[int] = []
        self._distracted = -1
        self._place = np.zeros(2)

    def advance(self, dt_s: float) -> None:
        end = dt_s / 0.3
        shares = {"occlusion": self._gym.occlusion, "swap": self._gym.swap, "distractor": self._gym.distractor}
        begin = {name: share / (1.0 - share) * end for name, share in shares.items()}
        draw = self._random.uniform(size=coco.COUNT)
        self._hidden = np.where(self._hidden, draw > end, draw < begin["occlusion"])
        if self._swapped:
            if self._random.uniform() < end:
                self._swapped = []
        elif self._random.uniform() < begin["swap"]:
            self._swapped = [list(range(coco.COUNT)), _ARMS, _LEGS][int(self._random.integers(3))]
        if self._distracted >= 0:
            if self._random.uniform() < end:
                self._distracted = -1
        elif self._random.uniform() < begin["distractor"]:
            self._distracted = int(self._random.choice([9, 10]))
            self._place = self._random.uniform((300, 150), (980, 600))

    def apply(self, exact: Float, track: int, random: np.random.Generator) -> Seen:
        sigma = np.full(coco.COUNT, self._gym.reported_px)
        score = np.full(coco.COUNT, 0.9)
        points = exact.copy()
        points[self._hidden] += random.normal(0.0, 6 * self._gym.noise_px, (int(self._hidden.sum()), 2))
        score[self._hidden] = 0.25
        sigma[self._hidden] *= 2.0
        if self._swapped:
            order = np.arange(coco.COUNT)
            order[self._swapped] = _MIRROR[self._swapped]
            points, sigma, score = points[order], sigma[order], score[order]
        if self._distracted >= 0:
            points[self._distracted] = self._place + random.normal(0.0, self._gym.noise_px, 2)
        return _person(points, sigma, score, track)


def _person(points: Float, sigma: Float, score: Float, track: int) -> Seen:
    centre = points.mean(axis=0)
    crop = Crop(float(centre[0]), float(centre[1]), float(1.25 * np.ptp(points, axis=0).max()))
    return Seen(track, crop, points.astype(np.float32), sigma.astype(np.float32), score.astype(np.float32))
