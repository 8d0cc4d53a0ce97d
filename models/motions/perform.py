"""From the parameters of a performance to its motion."""

from models.errors import UserError
from models.motions.actions.action import Action
from models.motions.actions.library import ACTIONS
from models.motions.motion import Motion
from models.motions.performance import Performance
from models.motions.subject import Subject


def perform(performance: Performance, subject: Subject) -> Motion:
    """The motion of a performance by a subject: from `stand` to `stand`, at first at the origin and looking along x.

    Raises:
        UserError: an action or a fault that is not known.
    """
    return action_of(performance).perform(performance, subject)


def action_of(performance: Performance) -> Action:
    """The action of a performance. Raises as `perform` does."""
    action = ACTIONS.get(performance.action)
    if action is None:
        raise UserError(f"there is no action '{performance.action}'; there are {', '.join(ACTIONS)}")
    known = {fault.name for fault in action.faults}
    for fault in performance.faults:
        if fault not in known:
            raise UserError(f"{action.name} has no fault '{fault}'; it has {', '.join(sorted(known))}")
    return action
