"""Attempts in a whole track that somebody asks about: as the box would have found them live, or whatever is most like a standard.

Live, what is no attempt must not be taken for one, so all of a performance must be near to the standard, from its start to its end
(`services.evaluation.attempts.FindingConfig.distance`). Who looks through a file for a performance of an action says that it holds
one. Then a technique of another school, or of another game, counts as well: a tennis serve is a badminton clear until the racket
has hit, and ends quite differently. `performances_like` compares only what leads to the peak and a little more, at a looser bound.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Float
from models.motions.motion import Handed
from models.teaching.standard import FRAME_S, Moments, Standard
from services.evaluation.alignment import Spring, align
from services.evaluation.attempt import FoundAttempt
from services.evaluation.attempts import DEFAULT, AttemptFinder
from services.evaluation.features import features_of
from services.evaluation.keyframes import AFTER_S, BEFORE_S, refine
from services.evaluation.normalise import lead_right
from services.evaluation.templates import Template, templates_of
from services.evaluation.track import Track

LIKE: Final = 0.75
"""How far what is most like a standard may be from it until its peak, as a share of how far somebody is who only stands there."""
_PAST_PEAK_S: Final = 0.1
"""What follows the peak so soon belongs to it: a hand that stops has not hit."""
_LATER_S: Final = DEFAULT.patience_s + DEFAULT.wait_s
"""A file may begin and end with the attempt; the finder decides so long after it at the latest."""
_DISTINCTLY: Final = 0.9


@dataclass(frozen=True)
class _Likeness:
    """Something like a performance, up to its peak; `start` and `end` are frames, both of it."""

    template: Template
    start: int
    end: int
    distance: float


def attempts_in(track: Track, standard: Standard) -> tuple[FoundAttempt, ...]:
    """Every attempt at the action of a standard, on the track's clock, as the box finds them live.

    Args:
        track: at 30 frames a second.
        standard: the action's.
    """
    finder = AttemptFinder((standard,), track.frame_s)
    nobody: Float = np.full(track.joints_m.shape[1:], np.nan)
    frames = [nobody, *track.joints_m, *[nobody] * round(_LATER_S / FRAME_S)]
    begin_s, last_s = float(track.t_s[0]), float(track.t_s[-1])
    rough = (finder.push(joints_m, begin_s + (number - 1) * track.frame_s) for number, joints_m in enumerate(frames))
    found = (refine(track, attempt, (standard,)) for attempt in rough if attempt is not None)
    return tuple(attempt for attempt in found if begin_s <= attempt.moments_s[0] and attempt.moments_s[-1] <= last_s)


def performances_like(track: Track, standard: Standard) -> tuple[FoundAttempt, ...]:
    """Whatever is most like a standard until its peak (`LIKE`), in the order of time: for who knows that the track holds it.

    Args:
        track: at 30 frames a second.
        standard: with all of its performances.
    """
    left = sorted(_alike(track, standard), key=lambda one: one.distance)
    found: list[_Likeness] = []
    for one in left:
        if all(one.end < other.start or other.end < one.start for other in found):
            found.append(one)
    return tuple(refine(track, _whole(one, track), (standard,)) for one in sorted(found, key=lambda one: one.start))


def leading_side(track: Track, moments_s: Moments, standard: Standard) -> Handed:
    """With which side the pupil leads between given keyframes: the one with which he is nearer to the standard; right if in doubt.

    Args:
        track: that holds them.
        moments_s: keyframes on the track's clock.
        standard: of what he tries.
    """
    first, last = (track.frame_at(moment_s) for moment_s in (moments_s[0] - BEFORE_S, moments_s[-1] + AFTER_S))
    part = track.part(max(int(first), 0), int(np.ceil(last)) + 1)
    right, left = align(lead_right(part, "right"), standard), align(lead_right(part, "left"), standard)
    if right is None or left is None:
        return "right"
    return "left" if left.alignment.cost < _DISTINCTLY * right.alignment.cost else "right"


def _alike(track: Track, standard: Standard) -> Iterator[_Likeness]:
    """For each frame, and each performance of the standard, the best one that ends there, if it is near enough."""
    templates = tuple(templates_of(standard, 1 + len(standard.exemplars), _PAST_PEAK_S))
    spring = Spring([template.features for template in templates])
    still = np.array([template.still[-1] for template in templates])
    least, most = (tempo * spring.lengths * FRAME_S / track.frame_s for tempo in DEFAULT.tempo)
    features = features_of(track.joints_m, track.frame_s)
    known = np.isfinite(features[..., 0]).mean(axis=1)
    for frame, joints in enumerate(features):
        if known[frame] < DEFAULT.seen:
            spring.skip()
            continue
        spring.push(joints)
        distances, lasts = np.sqrt(spring.costs / still), frame - spring.starts + 1
        for number in np.flatnonzero((distances < LIKE) & (lasts > least) & (lasts < most)):
            start = int(spring.starts[number])
            if known[start : frame + 1].mean() >= DEFAULT.known:
                yield _Likeness(templates[number], start, frame, float(distances[number]))


def _whole(one: _Likeness, track: Track) -> FoundAttempt:
    """The attempt that it begins, roughly: it goes on at the pace that it has had, as far as the track does."""
    template, last = one.template, len(track) - 1
    pace = (one.end - one.start) / (len(template.features) - 1)
    start, exertion, peak, end = (float(frame) for frame in one.start + pace * template.keyframes)
    moments = (track.t_s[0] + track.frame_s * frame for frame in (start, exertion, peak, max(min(end, last), one.end)))
    begins_s, effort_s, peak_s, ends_s = (float(moment_s) for moment_s in moments)
    return FoundAttempt(template.action, template.handed, (begins_s, effort_s, peak_s, ends_s))
