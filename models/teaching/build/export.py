"""Exports the standards of the simulated library.

    python -m models.teaching.build.export

writes `models/teaching/standards/*.npz`; with `--check` it compares with what is there. See README.md.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Final

import numpy as np

import models.body
import models.teaching
from models.arrays import Float
from models.body import LARGE
from models.body.file import decode as decode_body
from models.body.model import BodyModel
from models.body.prior import SEXES
from models.interpolation import between
from models.motions.actions.library import ACTIONS
from models.motions.motion import Motion
from models.motions.perform import perform
from models.motions.performance import Performance
from models.motions.subject import Subject
from models.skeleton import coco
from models.teaching.standard import AFTER_S, BEFORE_S, FRAME_S, Exemplar, Standard, decode, encode, same_instants

FOLDER: Final = Path(models.teaching.__file__).parent / "standards"
_VERSION: Final = 1
_ORIGIN: Final = "a simulated pupil of 12 years, no fault"
_YEARS: Final = 12.0
_EXEMPLARS: Final = (
    # years, tempo, amplitude, skill
    (7.0, 1.2, 0.95, 0.5),
    (9.0, 0.85, 1.0, 0.5),
    (11.0, 1.1, 1.05, 0.5),
    (14.0, 0.95, 1.0, 0.5),
    (16.0, 1.2, 1.0, 0.5),
    (30.0, 0.9, 0.95, 0.5),
)
_GOOD: Final = 24
"""Performances from which the natural spread is told."""
_GOOD_YEARS: Final = (7.0, 9.0, 11.0, 13.0, 15.0, 17.0, 25.0, 40.0)
_TEMPO, _AMPLITUDE, _SKILL = (0.85, 1.2), (0.9, 1.1), (0.3, 1.0)
_SAME_M: Final = 0.002
_LEFT_HIP, _RIGHT_HIP = coco.INDEX["left_hip"], coco.INDEX["right_hip"]


@dataclass(frozen=True, eq=False)
class Sampled:
    """A performance in the canonical frame.

    Attributes:
        exemplar: itself.
        stature_m: of who performed.
    """

    exemplar: Exemplar
    stature_m: float


def main() -> int:
    """Write or check the standards. Returns the exit code."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="compare with the files that are there and write nothing")
    arguments.add_argument("--action", action="append", choices=tuple(ACTIONS), help="only this one")
    options = arguments.parse_args()
    same = True
    for action in options.action or ACTIONS:
        path = FOLDER / f"{action}.npz"
        standard = standard_of(action)
        if options.check:
            as_exported = path.is_file() and _alike(decode(path.read_bytes(), path.name), standard)
            sys.stdout.write(f"{path.name}: {'as exported' if as_exported else 'differs from a fresh export'}\n")
            same &= as_exported
        else:
            FOLDER.mkdir(exist_ok=True)
            path.write_bytes(encode(standard))
            sys.stdout.write(f"written: {path.name}, {path.stat().st_size / 1024:.0f} KB\n")
    return 0 if same else 1


def standard_of(action: str) -> Standard:
    """The standard of an action, performed anew."""
    main_one = performed(Performance(action), _YEARS)
    exemplars = [
        performed(Performance(action, tempo=tempo, amplitude=amplitude, skill=skill, seed=number), years).exemplar
        for number, (years, tempo, amplitude, skill) in enumerate(_EXEMPLARS)
    ]
    random = np.random.default_rng(0x600D)
    good = []
    for number in range(_GOOD):
        tempo, amplitude, skill = (float(random.uniform(*bounds)) for bounds in (_TEMPO, _AMPLITUDE, _SKILL))
        how = Performance(action, tempo=tempo, amplitude=amplitude, skill=skill, seed=1000 + number)
        good.append(performed(how, _GOOD_YEARS[number % len(_GOOD_YEARS)]))
    spread = _spread_m(main_one, good)
    return Standard(action, _VERSION, _ORIGIN, main_one.exemplar, spread, main_one.stature_m, tuple(exemplars))


@cache
def _model() -> BodyModel:
    return decode_body(files(models.body).joinpath(LARGE).read_bytes(), LARGE)


@cache
def _subject(years: float) -> Subject:
    """The mean of boys and girls, or of women and men, of this age."""
    model = _model()
    if model.prior is None:
        raise ValueError(f"{LARGE} has no shape prior")
    sex = SEXES[round(years) % 2]
    return Subject(model.shaped(model.prior.likely(years, sex).mean), years, sex)


def performed(how: Performance, years: float) -> Sampled:
    """A performance by a pupil of mean build and this age."""
    subject = _subject(years)
    return Sampled(_cut(perform(how, subject), subject), subject.body.stature_m)


def _cut(motion: Motion, subject: Subject) -> Exemplar:
    """A performance, from shortly before its start to shortly after its end, in the canonical frame."""
    (attempt,) = motion.attempts
    first_s = max(attempt.start_s - BEFORE_S, 0.0)
    count = int((min(attempt.end_s + AFTER_S, motion.duration_s) - first_s) / FRAME_S + 1e-9) + 1
    times_s = first_s + FRAME_S * np.arange(count)
    joints = np.stack([subject.body.coco_m(motion.pose_at(min(float(t_s), motion.duration_s)))[: coco.COUNT] for t_s in times_s])
    joints -= _middle(joints)[0]
    moments = (attempt.start_s, attempt.exertion_s, attempt.peak_s, attempt.end_s)
    start, exertion, peak, end = (moment - first_s for moment in moments)
    return Exemplar(joints, (start, exertion, peak, end))


def _middle(joints_m: Float) -> Float:
    """(T, 3) the middle of the hips, on the floor."""
    return np.asarray((joints_m[:, _LEFT_HIP] + joints_m[:, _RIGHT_HIP]) / 2 * np.array((1.0, 1.0, 0.0)))


def _spread_m(standard: Sampled, good: Sequence[Sampled]) -> Float:
    """(S, 17) see `Standard.spread_m`; performances are aligned by their keyframes, which are known, evenly in between."""
    ours = _centred(standard.exemplar)
    times_s = np.arange(len(ours), dtype=np.float64) * FRAME_S
    squared = np.zeros(ours.shape[:2])
    for one in good:
        theirs = _centred(one.exemplar) * standard.stature_m / one.stature_m
        frames = same_instants(times_s, standard.exemplar.moments_s, one.exemplar.moments_s) / FRAME_S
        squared += ((ours - between(theirs, frames)) ** 2).sum(axis=2)
    return np.asarray(np.sqrt(squared / len(good)))


def _centred(exemplar: Exemplar) -> Float:
    return exemplar.joints_m - _middle(exemplar.joints_m)[:, None]


def _alike(there: Standard, fresh: Standard) -> bool:
    """Whether two standards are the same, but for what another processor rounds differently."""
    if (there.action, there.version, there.origin, len(there.exemplars)) != (
        fresh.action,
        fresh.version,
        fresh.origin,
        len(_EXEMPLARS),
    ):
        return False
    pairs = zip((there.performance, *there.exemplars), (fresh.performance, *fresh.exemplars), strict=True)
    return _near(there.spread_m, fresh.spread_m) and all(
        _near(one.joints_m, other.joints_m) and np.allclose(one.moments_s, other.moments_s, atol=1e-6) for one, other in pairs
    )


def _near(one: Float, other: Float) -> bool:
    return one.shape == other.shape and bool((np.abs(one - other) <= _SAME_M).all())


if __name__ == "__main__":
    sys.exit(main())
