"""A teaching lesson as the box would have it without being rendered: the twin's keypoints through fusion, beside the truth."""

import hashlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.plan import Plan
from edge.simulation.lesson.programme import programme_of
from edge.simulation.lesson.stage import member_of
from models.arrays import Bool, Float
from models.body.model import Body
from models.messages.motion import Motion as Smooth
from models.motions.figure import figure_of
from models.motions.motion import RATE_HZ, Attempt, Motion
from models.motions.subject import Subject
from models.skeleton import coco, smpl
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track, track_of
from services.fusion.config import PRESETS
from services.fusion.pipeline import Tick, initial_state, step
from tests.bench.kept import keep
from tests.twin.lesson import Lesson, turns
from tests.twin.twin import FILE, Twin

TRACK_HZ: Final = 30.0
_LIVE_HZ: Final = 15.0
_FLUSH_TICKS: Final = 10
_MARGIN_S: Final = 0.6
_MOSTLY: Final = 0.5
_ROOT: Final = Path(__file__).parents[3]


@dataclass(frozen=True, eq=False)
class Truth:
    """What the pupil of a lesson really does.

    Attributes:
        subject: who.
        motion: the whole lesson.
    """

    subject: Subject
    motion: Motion

    @property
    def stature_m(self) -> float:
        """As `tests.twin.lesson.Performer` has it."""
        return self.subject.body.stature_m

    def coco_m(self, t_s: float) -> Float:
        """(23, 3) at a time of the lesson; before its beginning and after its end he stands."""
        return self.subject.body.coco_m(self.motion.pose_at(min(max(t_s, 0.0), self.motion.duration_s)))

    def joints_m(self, t_s: Float) -> Float:
        """(T, 17, 3)."""
        return np.stack([self.coco_m(float(one))[: coco.COUNT] for one in t_s])

    def jump(self, attempt: Attempt) -> "Jump | None":
        """The longest flight of an attempt; None if there is none."""
        first, end = (int(t_s * RATE_HZ) for t_s in (attempt.start_s, attempt.end_s))
        in_air = ~self.motion.contacts[first:end].any(axis=1)
        edges = np.flatnonzero(np.diff(np.concatenate(((0,), in_air.astype(int), (0,)))))
        runs = [(first + a, first + b) for a, b in zip(edges[::2], edges[1::2], strict=True)]
        if not runs:
            return None
        off, on = max(runs, key=lambda run: run[1] - run[0])
        figure, air = figure_of(self.subject), slice(off, on)
        centre_m = figure.centres_of_mass_m(figure.place(self.motion.translations_m[air], self.motion.rotations_rad[air]))
        top = int(np.argmax(centre_m[:, 2]))
        along = (centre_m[-1] - centre_m[0])[:2]
        far = float(np.linalg.norm(along))
        return Jump(
            off / RATE_HZ,
            on / RATE_HZ,
            (off + top) / RATE_HZ,
            float(np.ptp(centre_m[: top + 1, 2])),
            self._reach_m(off, on, along / far),
        )

    def _reach_m(self, off: int, on: int, along: Float) -> float:
        """As by the tape: from the foremost skin of the feet at take-off to where the foot further behind ends at landing."""
        body = self.subject.body
        feet = [_foot(body, side) for side in ("left", "right")]
        at_off, at_on = (body.vertices_m(self.motion.pose_at(frame / RATE_HZ))[:, :2] @ along for frame in (off, on))
        return float(min(at_on[foot].min() for foot in feet) - max(at_off[foot].max() for foot in feet))


@dataclass(frozen=True)
class Jump:
    """What is true of a flight: seconds of the lesson; rise of the centre of mass; reach from the toes to the heels."""

    off_s: float
    on_s: float
    top_s: float
    rise_m: float
    reach_m: float


def _foot(body: Body, side: str) -> Bool:
    """(V,) which vertices are a foot's."""
    joints = [smpl.INDEX[f"{side}_{joint}"] for joint in ("ankle", "foot")]
    skin = body.model.skin
    return np.asarray((np.isin(skin.joints, joints) * skin.weights).sum(axis=1) > _MOSTLY)


def truth_of(plan: Plan) -> Truth:
    """Of the first pupil of a plan."""
    subject = member_of(plan, 0).subject
    return Truth(subject, programme_of(plan, 0, subject).motion)


def smooth_of(plan: Plan, truth: Truth, data: Path) -> Track:
    """The smooth motion of the whole lesson, from a file if it was made before; seconds from the lesson's beginning."""
    path = data / "teaching" / f"{_key(plan)}.npz"
    if path.exists():
        with np.load(path) as file:
            return Track(file["t_s"], file["joints_m"].astype(float), file["covariance_m2"].astype(float), file["states"])
    track = _made(plan, truth)
    content = io.BytesIO()
    np.savez_compressed(
        content,
        t_s=track.t_s,
        joints_m=track.joints_m.astype(np.float32),
        covariance_m2=track.covariance_m2.astype(np.float32),
        states=track.states,
    )
    keep(path, content.getvalue())
    return smooth_of(plan, truth, data)


def attempt_of(true: Attempt) -> FoundAttempt:
    """As if it had been found without an error."""
    return FoundAttempt(true.action, true.handed, (true.start_s, true.exertion_s, true.peak_s, true.end_s))


def around(track: Track, attempt: FoundAttempt) -> Track:
    """The frames of an attempt and some before and after it."""
    first, last = attempt.moments_s[0] - _MARGIN_S, attempt.moments_s[-1] + _MARGIN_S
    return track.part(max(0, int(np.ceil(track.frame_at(first)))), min(len(track), int(track.frame_at(last)) + 1))


def _made(plan: Plan, truth: Truth) -> Track:
    rig = rig_of(plan)
    seconds = truth.motion.duration_s
    lesson = Lesson(rig, (truth,), turns(rig, _LIVE_HZ, seconds), plan.seed)
    ticks = [round(n * 1e9 / TRACK_HZ) for n in range(int(seconds * TRACK_HZ) + _FLUSH_TICKS)]
    state, motions, due = initial_state(rig), list[Smooth](), 0
    config = PRESETS["default"]
    for arrival_s, observation in Twin.load().observations(lesson):
        while due < len(ticks) and ticks[due] * 1e-9 <= arrival_s:
            state, out = step(state, Tick(lesson.start_ns + ticks[due]), config)
            motions += [motion for motion in out.motions if motion.kind == "smooth"]
            due += 1
        state, _ = step(state, observation, config)
    for tick_ns in ticks[due:]:
        state, out = step(state, Tick(lesson.start_ns + tick_ns), config)
        motions += [motion for motion in out.motions if motion.kind == "smooth"]
    track = track_of([motion for motion in motions if motion.epoch == motions[-1].epoch], 1 / TRACK_HZ)
    return Track(track.t_s - lesson.start_ns * 1e-9, track.joints_m, track.covariance_m2, track.states)


def _key(plan: Plan) -> str:
    digest = hashlib.sha256(msgspec.json.encode(plan))
    digest.update(FILE.read_bytes())
    for path in sorted((_ROOT / "services" / "fusion").glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:32]
