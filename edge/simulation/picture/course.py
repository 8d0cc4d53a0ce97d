"""Where vertices are while a picture is taken: a polynomial in time for each, so that every row can ask for its own instant."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from edge.simulation.picture.scene import Actor, Pupil
from edge.simulation.picture.shutter import Shutter
from models.arrays import Float

NODES = np.cos((2 * np.arange(4) + 1) * np.pi / 8)[::-1]
"""Chebyshev's of degree 3: an arm of 0.6 m that turns at 30 rad/s through a picture of 30 ms strays by 0.1 mm."""
_TO_POWERS = np.linalg.inv(np.vander(NODES, increasing=True))
_SHORTEST_S = 1e-6


@dataclass(frozen=True, eq=False)
class Course:
    """Places over s = (t - mid_s) / half_s, from -1 to 1.

    Attributes:
        mid_s: time of the picture.
        half_s: half of the time from the first row's beginning to the last row's end.
        powers: (K, V, 3) world, metres: the sum of powers[k] s^k. K is 1 for what stands still.
    """

    mid_s: float
    half_s: float
    powers: Float


def places_at(course: Course, times: Float) -> Float:
    """(V, 3) where each vertex is at an s of its own, (V,)."""
    places = np.zeros(course.powers.shape[1:])
    for power in course.powers[::-1]:
        places = places * times[:, None] + power
    return places


def half_s(shutter: Shutter) -> float:
    """Half of the time that a picture takes."""
    return max((shutter.readout_s + shutter.exposure_s) / 2, _SHORTEST_S)


def course_through(places_m: Callable[[float], Float], t_s: float, shutter: Shutter) -> Course:
    """The course through a picture at `t_s` of points that are always there; `places_m` gives (V, 3) at a time."""
    half = half_s(shutter)
    nodes = np.stack([places_m(t_s + half * float(node)) for node in NODES])
    return Course(t_s, half, np.tensordot(_TO_POWERS, nodes, axes=1))


def course_of(actor: Actor, t_s: float, shutter: Shutter) -> Course | None:
    """The course through a picture at `t_s`.

    Returns:
        None if the actor is not there at the picture's time. One who comes or goes while the picture is taken stands still in it.
    """
    try:
        return course_through(lambda when: _present(actor, when), t_s, shutter)
    except _AbsentError:
        middle = actor.vertices_m(t_s)
        return None if middle is None else Course(t_s, half_s(shutter), middle[None])


class _AbsentError(Exception):
    pass


def _present(actor: Actor, t_s: float) -> Float:
    places = actor.vertices_m(t_s)
    if places is None:
        raise _AbsentError
    return places


class Courses:
    """Courses of some actors, kept until another picture is taken: other cameras expose at the same time, and truth asks, too."""

    def __init__(self, actors: Sequence[Actor]) -> None:
        self._actors = actors
        self._taken: tuple[float, Shutter] | None = None
        self._courses: list[Course | None] = []
        self._points_taken: tuple[float, Shutter] | None = None
        self._points: dict[str, Course] = {}

    def at(self, t_s: float, shutter: Shutter) -> list[Course | None]:
        """Through a picture at `t_s`, in the order of the actors; None for who is not there."""
        if self._taken != (t_s, shutter):
            self._courses = [course_of(actor, t_s, shutter) for actor in self._actors]
            self._taken = t_s, shutter
        return self._courses

    def of_points(self, pupil: Pupil, t_s: float, shutter: Shutter) -> Course:
        """Of a pupil's 24 joints and 23 COCO points, through a picture at `t_s`."""
        if self._points_taken != (t_s, shutter):
            self._points = {}
            self._points_taken = t_s, shutter
        if pupil.name not in self._points:
            self._points[pupil.name] = course_through(lambda when: points_m(pupil, when), t_s, shutter)
        return self._points[pupil.name]


def points_m(pupil: Pupil, t_s: float) -> Float:
    """(47, 3) joints, then COCO points."""
    return np.concatenate((pupil.joints_m(t_s), pupil.coco_m(t_s)))
