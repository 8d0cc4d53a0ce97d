"""Motions one after the other: what one pupil does in a lesson.

Each motion begins in `models.motions.standing.stand` at its own origin and ends in it somewhere; the next is put where the last
one ended. A lesson of half an hour would be a quarter of a gigabyte of poses, so a `Sequence` keeps only what it was last asked
for and performs the rest again: an act must therefore give the same motion each time.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from models.arrays import Float
from models.body.pose import Pose
from models.motions import rotations
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Motion, Thing, ThingKind
from models.motions.standpoint import Standpoint, standpoint_of
from models.skeleton import smpl

SEAM_M: Final = 0.003
SEAM_RAD: Final = 0.02
"""How much the pose in which one motion ends may differ from the one in which the next begins: nobody would see it."""
KEPT_POSES: Final = 30_000
"""About two minutes, 20 MB."""

Act = Callable[[Standpoint], Motion]
"""What is done next: the motion in its own frame, for a pupil who stands there. Called again, it gives the same."""


@dataclass(frozen=True)
class _Segment:
    act: Act
    first: int
    count: int
    at: Standpoint


class Sequence:
    """Acts, each begun where and when the last one ended. Samples at `RATE_HZ`; a seam's pose is that of both sides.

    Attributes:
        attempts: in their order in time, with their times in the sequence.
        end: where the pupil stands at last.
    """

    def __init__(self, acts: Iterable[Act], start: Standpoint | None = None) -> None:
        """Perform all acts once.

        Raises:
            ValueError: there is none, or one begins in another pose than the last one ended in.
        """
        self.end = start if start is not None else Standpoint()
        self._kept: OrderedDict[int, Motion] = OrderedDict()
        self._segments: list[_Segment] = []
        attempts: list[Attempt] = []
        first, last = 0, None
        for act in acts:
            motion = act(self.end)
            if last is not None:
                _require_seam(last, motion.pose(0), len(self._segments))
            self._segments.append(_Segment(act, first, len(motion.translations_m), self.end))
            self._keep(len(self._segments) - 1, self.end.motion(motion))
            attempts += [_later(attempt, first / RATE_HZ) for attempt in motion.attempts]
            last_pose = motion.pose(len(motion.translations_m) - 1)
            inner = standpoint_of(last_pose)
            last, self.end = Standpoint().within(inner).pose(last_pose), self.end.of(inner)
            first += len(motion.translations_m) - 1
        if not self._segments:
            raise ValueError("a sequence has at least one act")
        self.attempts = tuple(attempts)
        self._count = first + 1

    @property
    def duration_s(self) -> float:
        """From the first pose to the last."""
        return (self._count - 1) / RATE_HZ

    @property
    def seams_s(self) -> tuple[float, ...]:
        """When each act begins."""
        return tuple(segment.first / RATE_HZ for segment in self._segments)

    @property
    def kept_poses(self) -> int:
        """How many are in memory: at most `KEPT_POSES`, or those of one act if it alone has more."""
        return sum(len(kept.translations_m) for kept in self._kept.values())

    def pose_at(self, t_s: float) -> Pose:
        """As `Motion.pose_at`, from 0 to `duration_s`. Raises as it does."""
        number, inner_s = self._at(t_s)
        return self._motion(number).pose_at(inner_s)

    def motion(self) -> Motion:
        """All of it in memory: some 160 kB a second."""
        return self.window(0.0, self.duration_s)

    def window(self, start_s: float, end_s: float) -> Motion:
        """The samples from `start_s` to `end_s`, both rounded to one; the attempts that lie wholly within; things that occur in it.

        Raises:
            ValueError: it is not within the sequence, or holds fewer than two samples.
        """
        first, last = round(start_s * RATE_HZ), round(end_s * RATE_HZ)
        if not 0 <= first < last < self._count:
            raise ValueError(f"a sequence of {self.duration_s:g} s has no window from {start_s:g} to {end_s:g} s")
        count = last - first + 1
        places, turns = np.empty((count, 3)), np.empty((count, smpl.COUNT, 3))
        contacts = np.zeros((count, len(CONTACTS)), np.bool_)
        things: dict[tuple[ThingKind, int], tuple[Float, Float]] = {}
        for number, segment in enumerate(self._segments):
            begin, end = max(first, segment.first), min(last + 1, segment.first + segment.count)
            if begin >= end:
                continue
            motion = self._motion(number)
            ours, theirs = slice(begin - first, end - first), slice(begin - segment.first, end - segment.first)
            places[ours], turns[ours] = motion.translations_m[theirs], motion.rotations_rad[theirs]
            contacts[ours] = motion.contacts[theirs]
            seen: dict[ThingKind, int] = {}
            for thing in motion.things:
                name = (thing.kind, seen.setdefault(thing.kind, 0))
                seen[thing.kind] += 1
                tracks = things.setdefault(name, (np.full((count, 3), np.nan), np.full((count, 3), np.nan)))
                tracks[0][ours], tracks[1][ours] = thing.translations_m[theirs], thing.rotations_rad[theirs]
        begin_s, end_s = first / RATE_HZ, last / RATE_HZ
        within = [attempt for attempt in self.attempts if begin_s <= attempt.start_s and attempt.end_s <= end_s]
        return Motion(
            places,
            turns,
            contacts,
            tuple(_later(attempt, -begin_s) for attempt in within),
            tuple(Thing(kind, *tracks) for (kind, _), tracks in things.items()),
        )

    def _at(self, t_s: float) -> tuple[int, float]:
        """Which segment, and the time within it."""
        if not 0 <= t_s <= self.duration_s:
            raise ValueError(f"the sequence has poses from 0 to {self.duration_s:g} s, none at {t_s:g} s")
        number = int(np.searchsorted(self.seams_s, t_s, side="right")) - 1
        segment = self._segments[number]
        return number, min(t_s - segment.first / RATE_HZ, (segment.count - 1) / RATE_HZ)

    def _motion(self, number: int) -> Motion:
        """The motion of a segment, where it takes place."""
        if number not in self._kept:
            segment = self._segments[number]
            self._keep(number, segment.at.motion(segment.act(segment.at)))
        self._kept.move_to_end(number)
        return self._kept[number]

    def _keep(self, number: int, motion: Motion) -> None:
        self._kept[number] = motion
        while len(self._kept) > 1 and self.kept_poses > KEPT_POSES:
            self._kept.popitem(last=False)


def _later(attempt: Attempt, by_s: float) -> Attempt:
    moments = ("start_s", "exertion_s", "peak_s", "end_s")
    return replace(attempt, **{name: max(getattr(attempt, name) + by_s, 0.0) for name in moments})


def _require_seam(last: Pose, first: Pose, number: int) -> None:
    """Raises ValueError unless the pose in which an act ends, put at the origin, is the one in which the next begins."""
    apart = float(np.linalg.norm(last.translation_m - first.translation_m))
    ended, begins = rotations.matrices(last.rotations_rad), rotations.matrices(first.rotations_rad)
    turned = np.linalg.norm(rotations.vectors(ended.swapaxes(-1, -2) @ begins), axis=-1)
    worst = int(np.argmax(turned))
    if apart > SEAM_M or turned[worst] > SEAM_RAD:
        raise ValueError(
            f"act {number} does not begin as the one before it ends: the pelvis jumps by {1000 * apart:.1f} mm, "
            f"{smpl.NAMES[worst]} by {np.degrees(turned[worst]):.1f} degrees; an act begins and ends in `stand`"
        )
