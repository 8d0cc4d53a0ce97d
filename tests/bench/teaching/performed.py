"""Cases as they are truly performed: every frame's joints and the true keyframes; pupils of all ages, right- and left-handed."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np

from edge.simulation.people.casting import cast
from edge.simulation.split import Split, generator
from models.arrays import Float
from models.motions.motion import Handed
from models.motions.perform import perform
from models.motions.standpoint import Standpoint
from models.motions.subject import Subject
from models.skeleton import coco
from services.evaluation.attempt import FoundAttempt
from tests.bench.kept import keep
from tests.bench.seeds import COUNT
from tests.bench.teaching.cases import Case
from tests.bench.teaching.lessons import lesson_of

RATE_HZ: Final = 30.0
_FIRST_S: Final = 0.01
_YEARS: Final = (7.0, 50.0)


@dataclass(frozen=True, eq=False)
class Performed:
    """One case.

    Attributes:
        case: what was asked for.
        years: age of the pupil.
        stature_m: his.
        joints_m: (T, 17, 3) true COCO points in the world at `RATE_HZ`, from some tenths of a second before the attempt on.
        attempt: as it is truly timed, seconds from the first frame.
    """

    case: Case
    years: float
    stature_m: float
    joints_m: Float
    attempt: FoundAttempt


@cache
def pupil_of(split: Split, seed: int) -> tuple[Subject, Handed]:
    """Who performs the cases of a seed: the bench's pupils first, then others of all ages, every other one left-handed."""
    if seed % 100 < COUNT:
        plan = lesson_of("teaching", split, seed, [Case(split, seed, "squat")]).pupils[0]
        years, handed = float(plan.age_years), plan.performs[0].handed  # type: ignore[arg-type]
        return cast(split, seed, years).subject, handed
    years = float(np.exp(generator(split, "teaching pupil", seed).uniform(*np.log(_YEARS))))
    return cast(split, seed, years).subject, "left" if seed % 2 else "right"


def performed(case: Case) -> Performed:
    """Perform it, somewhere in the room."""
    subject, handed = pupil_of(case.split, case.seed)
    random = generator(case.split, f"teaching place {case.action}", case.seed + case.number)
    place = Standpoint(float(random.uniform(-2, 2)), float(random.uniform(-2, 2)), float(random.uniform(-np.pi, np.pi)))
    motion = place.motion(perform(case.performance(handed), subject))
    first_s = _FIRST_S + float(random.uniform(0, 1 / RATE_HZ))
    times_s = np.arange(first_s, motion.duration_s, 1 / RATE_HZ)
    joints_m = np.stack([subject.body.coco_m(motion.pose_at(float(t_s)))[: coco.COUNT] for t_s in times_s])
    (true,) = motion.attempts
    moments_s = (true.start_s - first_s, true.exertion_s - first_s, true.peak_s - first_s, true.end_s - first_s)
    attempt = FoundAttempt(case.action, handed, moments_s)
    return Performed(case, subject.age_years, subject.body.stature_m, joints_m, attempt)


def kept(cases: Sequence[Case], path: Path) -> list[Performed]:
    """Perform cases, or read them from a file that was made of the same ones."""
    names = msgspec.json.encode(cases).decode()
    if path.exists():
        with np.load(path) as file:
            if str(file["cases"]) == names:
                return _read(cases, dict(file))
    done = [performed(case) for case in cases]
    arrays = {
        "cases": np.array(names),
        "joints_m": np.concatenate([one.joints_m for one in done]).astype(np.float32),
        "ends": np.cumsum([len(one.joints_m) for one in done]),
        "moments_s": np.array([one.attempt.moments_s for one in done]),
        "left": np.array([one.attempt.handed == "left" for one in done]),
        "years": np.array([one.years for one in done]),
        "stature_m": np.array([one.stature_m for one in done]),
    }
    file_bytes = io.BytesIO()
    np.savez_compressed(file_bytes, allow_pickle=False, **arrays)
    keep(path, file_bytes.getvalue())
    return done


def _read(cases: Sequence[Case], file: dict[str, Any]) -> list[Performed]:
    joints = np.split(file["joints_m"].astype(np.float64), file["ends"][:-1])
    return [
        Performed(
            case,
            float(file["years"][number]),
            float(file["stature_m"][number]),
            joints[number],
            _attempt(case.action, bool(file["left"][number]), file["moments_s"][number]),
        )
        for number, case in enumerate(cases)
    ]


def _attempt(action: str, left: bool, moments_s: Float) -> FoundAttempt:
    start, exertion, peak, end = map(float, moments_s)
    return FoundAttempt(action, "left" if left else "right", (start, exertion, peak, end))
