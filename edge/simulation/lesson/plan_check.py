"""Whether what a lesson plan names is there, and whether its tables agree with one another."""

from collections.abc import Iterator
from itertools import pairwise

from msgspec import UNSET

from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.plan import Plan
from models.errors import UserError
from models.motions.perform import action_of


def require_sound(plan: Plan, origin: str) -> None:
    """Raise UserError unless it can be rendered; the line names the key. `origin` is the plan's file or preset."""
    try:
        for problem in _problems(plan):
            raise UserError(problem)
    except UserError as error:
        raise UserError(f"lesson plan {origin}: {error}") from error


def _problems(plan: Plan) -> Iterator[str]:
    cameras = rig_of(plan).names
    names = [pupil.name for pupil in plan.pupils]
    for name in names:
        if names.count(name) > 1:
            yield f"pupils: '{name}' occurs twice; give each a name of his own"
    for place, pupil in enumerate(plan.pupils):
        for number in range(len(pupil.performs)):
            try:
                action_of(plan.performance(place, number))
            except UserError as error:
                yield f"pupils[{place}].performs[{number}]: {error}"
        begins_s = [(number, each.begins_s) for number, each in enumerate(pupil.performs) if each.begins_s is not UNSET]
        for (_, before_s), (number, at_s) in pairwise(begins_s):
            if at_s <= before_s:
                yield f"pupils[{place}].performs[{number}].begins_s is {at_s:g}, but what is before it begins at {before_s:g}"
    for key, named in _cameras(plan):
        if named not in cameras:
            yield f"{key}: rig '{plan.rig}' has no camera '{named}'; it has {', '.join(cameras)}"
    for number, swap in enumerate(plan.swaps):
        if len(set(swap.cameras)) == 1:
            yield f"swaps[{number}]: camera '{swap.cameras[0]}' cannot swap names with itself"


def _cameras(plan: Plan) -> Iterator[tuple[str, str]]:
    """Every camera that is named, with the key of who names it."""
    for key in ("bumps", "exposures", "faults"):
        for number, fault in enumerate(getattr(plan, key)):
            yield f"{key}[{number}].camera", fault.camera
    for number, swap in enumerate(plan.swaps):
        for name in swap.cameras:
            yield f"swaps[{number}].cameras", name
