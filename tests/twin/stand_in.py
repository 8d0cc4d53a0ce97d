"""A network that errs by a known law: what the twin must find again when it is fitted to this network's words.

Errors are biased by the view, correlated in time (a first-order autoregression), heavy-tailed and larger where something hides the
joint; arms, legs or everything are swapped and the pupil is lost for a while; the score falls with the error.
"""

from dataclasses import dataclass

import numpy as np

from edge.simulation.picture.shutter import Shutter
from models.arrays import Bool, Float
from models.camera.rig import Rig
from models.skeleton import coco
from services.fusion.pipeline import Tick
from tests.bench.closed_loop import Event
from tests.bench.reconstruct import lesson as rendered_lesson
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person
from tests.twin.context import Context, Frame, look
from tests.twin.errors import Errors, said_of
from tests.twin.lesson import Lesson, PlainPerformer, Sampled, truth_of, turns
from tests.twin.speech import Speaker
from tests.twin.truth import Stream

_ARMS, _LEGS = [7, 8, 9, 10], [13, 14, 15, 16]
DELAY_S = 0.06
_SWAPS = (list(range(1, coco.COUNT)), _ARMS, _LEGS)


@dataclass(frozen=True)
class StandIn:
    """The law.

    Attributes:
        sigma: of the errors, in statures.
        memory: correlation of an error with the one of the picture before.
        freedom: of Student's t that innovations follow.
        doubling: errors of a joint behind the middle of a limb are larger by 1 + this.
        lean: bias in statures to the side from which the camera looks.
        swap: share of time for each of whole body, arms, legs.
        lost: share of time in which the pupil is not found.
        lasting: pictures that a swap or a loss lasts in the mean.
    """

    sigma: float = 0.012
    memory: float = 0.7
    freedom: float = 4.0
    doubling: float = 2.0
    lean: float = 0.01
    swap: float = 0.03
    lost: float = 0.03
    lasting: float = 4.0

    def errors(self, context: Context, random: np.random.Generator) -> Errors:
        """Of a stream."""
        count = len(context)
        steady = self._autoregression(count, random)
        larger = 1.0 + self.doubling * np.maximum(context.hidden, 0.0)
        residual = self.sigma * larger[..., None] * steady
        residual[..., 0] += self.lean * context.view[:, 1:2]
        crossed = np.zeros((count, coco.COUNT), np.bool_)
        for joints in _SWAPS:
            crossed[:, joints] ^= self._spells(count, self.swap, random)[:, None]
        crossed[:, 0] = False
        doubt = np.linalg.norm(residual, axis=-1) / self.sigma
        score = np.clip(0.9 - 0.08 * doubt + random.normal(0.0, 0.03, doubt.shape), 0.02, 0.98)
        found = ~self._spells(count, self.lost, random)
        renewed = np.concatenate(([False], found[1:] & ~found[:-1]))
        return Errors(residual, crossed, score, np.log(0.02) + 1.5 * (1.0 - score), found, renewed)

    def _autoregression(self, count: int, random: np.random.Generator) -> Float:
        """(count, 17, 2) of variance 1."""
        scale = np.sqrt((1.0 - self.memory**2) * (self.freedom - 2.0) / self.freedom)
        innovation = scale * random.standard_t(self.freedom, (count + 50, coco.COUNT, 2))
        values = np.zeros_like(innovation)
        for n in range(1, len(values)):
            values[n] = self.memory * values[n - 1] + innovation[n]
        return np.asarray(values[50:])

    def _spells(self, count: int, share: float, random: np.random.Generator) -> Bool:
        """(count,) on for `lasting` pictures in the mean, and for that share of them in all."""
        on, out = random.uniform() < share, np.zeros(count, np.bool_)
        begins = share / (1.0 - share) / self.lasting
        for n, draw in enumerate(random.uniform(size=count)):
            on = draw > 1.0 / self.lasting if on else draw < begins
            out[n] = on
        return out


def lesson_of(seed: int, seconds: float, rate_hz: float = 15.0) -> Lesson:
    """Somebody who walks in circles and throws, and somebody who stands in the way, before four cameras."""
    random = np.random.default_rng((seed, 77))
    walker = Person(
        height_m=float(random.uniform(1.3, 1.8)), radius_m=float(random.uniform(0.5, 1.5)), phase=float(random.uniform())
    )
    other = Person(centre_m=(float(random.uniform(-2, 2)), 2.0), radius_m=0.0, throws=False, phase=float(random.uniform()))
    rig: Rig = ring_rig(radius_m=float(random.uniform(5.0, 7.0)), height_m=float(random.uniform(1.8, 2.6)), distorted=True)
    pupils = tuple(PlainPerformer(person.height_m, person.joints) for person in (walker, other))
    return Lesson(rig, pupils, turns(rig, rate_hz, seconds), seed, Shutter(readout_s=0.0))


def streams_of(lesson: Lesson, network: StandIn) -> list[Stream]:
    """What the stand-in says of a lesson, by camera."""
    return [stream for stream, _ in _told(lesson, network)]


def rendered(lesson: Lesson, network: StandIn) -> tuple[rendered_lesson.Lesson, list[Event]]:
    """The lesson as if it had been rendered and looked at, and what fusion consumed of it."""
    streams = _told(lesson, network)
    pupil, names = lesson.pupils[0], lesson.rig.names
    half = lesson.seconds / 2
    made = rendered_lesson.Lesson(
        name=streams[0][0].lesson,
        seed=lesson.seed,
        pupil="nobody",
        identity="",
        rig=lesson.rig,
        length_s=lesson.seconds,
        spans=(rendered_lesson.Span("walk", 1.0, half), rendered_lesson.Span("run", half, lesson.seconds - 0.5)),
        frames=lambda _: iter(()),
        truth_m=lambda times_s: np.stack([pupil.coco_m(float(t_s)) for t_s in times_s]),
        stature_m=pupil.stature_m,
        pictures={},
    )
    timed: list[tuple[float, int, Event]] = []
    for index, (stream, frame) in enumerate(streams):
        for arrival_s, observation in Speaker(lesson.start_ns, "stand-in").say(stream.truth, frame, stream.said):
            timed.append((arrival_s, index, observation))
    ticks = np.arange(round(lesson.seconds * 30) + 10) / 30
    timed += [(float(t_s), len(names), Tick(lesson.start_ns + round(t_s * 1e9))) for t_s in ticks]
    return made, [event for _, _, event in sorted(timed, key=lambda one: one[:2])]


def _told(lesson: Lesson, network: StandIn) -> list[tuple[Stream, Frame]]:
    sampled = Sampled(lesson.pupils, 0.0, lesson.seconds)
    told = []
    for index, camera in enumerate(lesson.rig):
        random = np.random.default_rng((lesson.seed, index, 5))
        truth = truth_of(sampled, camera, lesson.times_s[index], lesson.shutter)
        frame, context = look(truth)
        said = said_of(frame, network.errors(context, random), np.full(len(truth), DELAY_S))
        told.append((Stream(f"walk{lesson.seed}", lesson.seed, truth, said), frame))
    return told
