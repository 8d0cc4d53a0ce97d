"""Attempts and keyframes as they are found in a lesson, beside the true ones."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np

import models.teaching
from models.motions.actions.library import ACTIONS
from models.motions.motion import Attempt
from models.teaching.standard import Standard, decode
from services.evaluation.attempt import PHASES, FoundAttempt
from services.evaluation.attempts import AttemptFinder
from services.evaluation.energy import keyframes_of_energy
from services.evaluation.track import Track

SIX: Final = ("basketball_shot", "long_jump", "forward_roll", "badminton_clear", "volleyball_spike", "soccer_kick")
"""The paper's actions."""
NEAR_S: Final = 3 / 30
"""A keyframe is found if it is at most three frames beside the true one."""
_ROUNDED_S: Final = 1e-6
_OVERLAP: Final = 0.5
"""An attempt is found if what is common to it and the true one is at least this share of both together."""
_AROUND_S: Final = 0.1
SETTLED_S: Final = 0.65
"""An attempt is to be decided on so soon after its true end."""


@cache
def shipped() -> tuple[Standard, ...]:
    """The standards of the repository."""
    folder = files(models.teaching) / "standards"
    return tuple(decode((folder / f"{action}.npz").read_bytes(), f"{action}.npz") for action in ACTIONS)


@dataclass(frozen=True)
class Decided:
    """An attempt, and when it was decided on: the instant of the newest frame."""

    attempt: FoundAttempt
    decided_s: float


@dataclass(frozen=True)
class Found:
    """What was found in a lesson.

    Attributes:
        true: the attempts that there were.
        decided: those that were found, in their order.
        energy_s: maxima of the motion's energy during the true attempts, by attempt.
        seconds: of the lesson.
    """

    true: tuple[Attempt, ...]
    decided: tuple[Decided, ...]
    energy_s: tuple[tuple[float, ...], ...]
    seconds: float

    @property
    def pairs(self) -> list[tuple[Attempt, Decided]]:
        """True attempts that were found, with what was found."""
        left = list(self.decided)
        pairs = []
        for true in self.true:
            own = [one for one in left if one.attempt.action == true.action and _overlap(true, one.attempt) >= _OVERLAP]
            if own:
                best = max(own, key=lambda one, true=true: _overlap(true, one.attempt))  # type: ignore[misc]
                left.remove(best)
                pairs.append((true, best))
        return pairs

    @property
    def false(self) -> list[Decided]:
        """What was found and was no such attempt."""
        found = [one for _, one in self.pairs]
        return [one for one in self.decided if one not in found]


def find(track: Track, true: Sequence[Attempt]) -> Found:
    """Feed a track of a whole lesson to the finder, frame by frame, all actions being looked for.

    A lesson that is over before its last attempt could be decided on ends where that attempt begins.
    """
    if true and true[-1].end_s > track.t_s[-1] - SETTLED_S:
        return find(track.part(0, int(track.frame_at(true[-1].start_s))), true[:-1])
    finder = AttemptFinder(shipped(), track.frame_s)
    decided = []
    for t_s, joints in zip(track.t_s.tolist(), track.joints_m, strict=True):
        attempt = finder.push(joints, t_s)
        if attempt is not None:
            decided.append(Decided(attempt, t_s))
    energy = tuple(_energy_s(track, one) for one in true)
    return Found(tuple(true), tuple(decided), energy, len(track) * track.frame_s)


def moments_s(true: Attempt) -> tuple[float, float, float, float]:
    """Of the keyframes."""
    return (true.start_s, true.exertion_s, true.peak_s, true.end_s)


def f1(hits: int, found: int, true: int) -> float:
    """Harmonic mean of precision and recall; NaN if there was nothing to find and nothing was."""
    return 2 * hits / (found + true) if found + true else float("nan")


def attempt_f1(lessons: Sequence[Found], action: str | None = None) -> float:
    """Of the attempts at an action, or at all."""
    hits = sum(action in {None, true.action} for one in lessons for true, _ in one.pairs)
    found = sum(action in {None, decided.attempt.action} for one in lessons for decided in one.decided)
    return f1(hits, found, sum(action in {None, true.action} for one in lessons for true in one.true))


def keyframe_f1(lessons: Sequence[Found], action: str, phase: int | None = None) -> float:
    """Of the keyframes of an action; those of attempts that are not found are missed, those of false ones are false."""
    hits, chosen = 0, range(len(PHASES)) if phase is None else (phase,)
    for one in lessons:
        for true, decided in one.pairs:
            if true.action == action:
                apart = np.abs(np.array(decided.attempt.moments_s) - moments_s(true))
                hits += int((apart[list(chosen)] <= NEAR_S + _ROUNDED_S).sum())
    found = len(chosen) * sum(decided.attempt.action == action for one in lessons for decided in one.decided)
    true_ones = len(chosen) * sum(true.action == action for one in lessons for true in one.true)
    return f1(hits, found, true_ones)


def energy_f1(lessons: Sequence[Found], action: str) -> float:
    """Of equation 17 alone: its maxima during an attempt against the keyframes, whichever each is taken for."""
    hits = found = true_ones = 0
    for one in lessons:
        for true, maxima in zip(one.true, one.energy_s, strict=True):
            if true.action != action:
                continue
            left = list(maxima)
            for moment in moments_s(true):
                near = [maximum for maximum in left if abs(maximum - moment) <= NEAR_S + _ROUNDED_S]
                if near:
                    left.remove(min(near, key=lambda maximum, moment=moment: abs(maximum - moment)))  # type: ignore[misc]
                    hits += 1
            found += len(maxima)
            true_ones += len(PHASES)
    return f1(hits, found, true_ones)


def delays_s(lessons: Sequence[Found]) -> list[float]:
    """From the true end of each attempt that was found to the frame with which it was decided on."""
    return [decided.decided_s - true.end_s for one in lessons for true, decided in one.pairs]


def _overlap(true: Attempt, found: FoundAttempt) -> float:
    common = min(true.end_s, found.moments_s[-1]) - max(true.start_s, found.moments_s[0])
    return common / (max(true.end_s, found.moments_s[-1]) - min(true.start_s, found.moments_s[0]))


def _energy_s(track: Track, true: Attempt) -> tuple[float, ...]:
    first = max(int(np.floor(track.frame_at(true.start_s - _AROUND_S))), 0)
    last = min(int(np.ceil(track.frame_at(true.end_s + _AROUND_S))), len(track) - 1)
    part = track.part(first, last + 1)
    return tuple(float(part.t_s[frame]) for frame in keyframes_of_energy(part.joints_m))
