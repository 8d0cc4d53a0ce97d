"""From a lesson plan to what stands before the cameras: the gym, the pupils with what they do, the rig."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final

from msgspec import UNSET

from edge.simulation.gym import furniture
from edge.simulation.gym.hall import make_gym
from edge.simulation.gym.solids import placed
from edge.simulation.gym.things import PlayedThing
from edge.simulation.lesson.attempts import AttemptsByPupil
from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.plan import OccluderPlan, Plan
from edge.simulation.lesson.programme import Programme, programme_of
from edge.simulation.people.avatar import Avatar
from edge.simulation.people.casting import Member, cast
from edge.simulation.picture.scene import Scene
from edge.simulation.surface import Surface
from models.camera.rig import Rig
from models.motions import mat
from models.motions.standpoint import Standpoint

ON_A_MAT: Final = ("forward_roll",)
_PILED_MATS: Final = 8
_FURNITURE: Final[dict[str, Callable[[], Surface]]] = {
    "vaulting_box": furniture.vaulting_box,
    "bench": furniture.bench,
    "mats": lambda: furniture.mat_pile(_PILED_MATS),
    "volleyball_net": lambda: furniture.net("volleyball"),
    "badminton_net": lambda: furniture.net("badminton"),
}
_BIBS: Final = {"red": (0.80, 0.13, 0.12), "yellow": (0.93, 0.80, 0.12), "green": (0.15, 0.55, 0.22), "blue": (0.13, 0.28, 0.70)}


@dataclass(frozen=True, eq=False)
class Stage:
    """What there is to film.

    Attributes:
        scene: all that can be seen.
        rig: the cameras as they are calibrated; where each really is, a plan may change.
        length_s: of the lesson.
        attempts: of each pupil.
    """

    scene: Scene
    rig: Rig
    length_s: float
    attempts: AttemptsByPupil


def set_stage(plan: Plan) -> Stage:
    """Cast the pupils, have them learn what they do, and furnish the gym.

    Raises:
        UserError: a pupil cannot do what the plan says.
    """
    members = [member_of(plan, number) for number in range(len(plan.pupils))]
    programmes = [programme_of(plan, number, member.subject) for number, member in enumerate(members)]
    motions = [programme.motion for programme in programmes]
    gym = make_gym(plan.split, plan.seed if plan.gym is UNSET else plan.gym)
    scene = Scene(
        room=(*gym.room, *_mats(plan, programmes), *map(_occluder, plan.occluders)),
        pupils=tuple(
            Avatar(pupil.name, member.subject, member.look, motion)
            for pupil, member, motion in zip(plan.pupils, members, motions, strict=True)
        ),
        things=tuple(PlayedThing(thing) for motion in motions for thing in motion.things),
        lamps=gym.lamps,
        ambient=gym.ambient,
    )
    length_s = max(motion.duration_s for motion in motions) if plan.length_s is UNSET else plan.length_s
    attempts = {pupil.name: motion.attempts for pupil, motion in zip(plan.pupils, motions, strict=True)}
    return Stage(scene, rig_of(plan), length_s, attempts)


def member_of(plan: Plan, number: int) -> Member:
    """Who plays pupil `number`: his body, as it is cast by the plan and, for tests, off the model; and his looks."""
    wanted = plan.pupils[number]
    looks = plan.lot("looks", number) if wanted.looks is UNSET else wanted.looks
    age_years = None if wanted.age_years is UNSET else wanted.age_years
    member = cast(plan.split, looks, age_years, None if wanted.sex is UNSET else wanted.sex)
    return member if wanted.bib is UNSET else member.in_bib(_BIBS[wanted.bib], member.look.number)


def _mats(plan: Plan, programmes: Sequence[Programme]) -> Iterator[Surface]:
    """A mat wherever somebody rolls."""
    for pupil, programme in zip(plan.pupils, programmes, strict=True):
        for wanted, begin in zip(pupil.performs, programme.begins, strict=True):
            if wanted.action in ON_A_MAT:
                middle = begin.of(Standpoint(mat.FROM_M + mat.LENGTH_M / 2))
                yield placed(furniture.mat(), (middle.x_m, middle.y_m, 0.0), middle.heading_rad)


def _occluder(wanted: OccluderPlan) -> Surface:
    return placed(_FURNITURE[wanted.kind](), (*wanted.place_m, 0.0), math.radians(wanted.facing_deg))
