"""What a tablet shows of attempts: waited for, and read off."""

import numpy as np

from models.messages.feedback import Colour, Feedback
from tests.browser.room import Room
from tests.browser.test_page import Shown

SHOT, FAULT = "basketball_shot", "no_knee_bend"


def see(shown: Shown, room: Room, made: Feedback) -> int:
    """Let an attempt end and wait for its replay; returns its id."""
    number = room.attempt(made)
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{number}'")
    return number


def levels(shown: Shown) -> list[int]:
    """How many joints are grey, green, yellow and red in the replay's picture."""
    return [int(count) for count in (shown.page.locator(".page").get_attribute("data-levels") or "").split(",")]


def like(shown: Shown, colour: Colour) -> int:
    """Pixels of the canvas that anybody would call green, or red."""
    blue, green, red = np.moveaxis(shown.picture(), -1, 0)
    main, others = (green, np.maximum(red, blue)) if colour == Colour.GREEN else (red, np.maximum(green, blue))
    return int((main > others + 0.15).sum())
