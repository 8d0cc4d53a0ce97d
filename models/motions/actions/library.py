"""All actions by name."""

from typing import Final

from models.motions.actions.action import Action

_ALL: Final[tuple[Action, ...]] = ()

ACTIONS: Final[dict[str, Action]] = {action.name: action for action in _ALL}
