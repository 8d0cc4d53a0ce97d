"""All actions by name."""

from typing import Final

from models.motions.actions import (
    badminton_clear,
    basketball_shot,
    cartwheel,
    forward_roll,
    long_jump,
    run,
    soccer_kick,
    squat,
    star_jump,
    volleyball_spike,
)
from models.motions.actions.action import Action

_ALL: Final[tuple[Action, ...]] = (
    basketball_shot.ACTION,
    badminton_clear.ACTION,
    volleyball_spike.ACTION,
    soccer_kick.ACTION,
    long_jump.ACTION,
    forward_roll.ACTION,
    squat.ACTION,
    star_jump.ACTION,
    run.ACTION,
    cartwheel.ACTION,
)

ACTIONS: Final[dict[str, Action]] = {action.name: action for action in _ALL}
