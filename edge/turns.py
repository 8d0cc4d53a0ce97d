"""When a camera's next inference is due: the plan of `ViewControl`, before any has come, and when it is too old."""

from fractions import Fraction

from models.messages.control import ViewControl

SECOND_NS = 1_000_000_000
DEFAULT_RATE_HZ = 10.0
CONTROL_LIFETIME_NS = 3 * SECOND_NS
"""A plan that was not renewed for this long is void: fusion is gone."""


def default_control(camera: str, position: int, cameras: int, start_ns: int, max_rate_hz: float) -> ViewControl:
    """The plan without fusion: everyone is looked at, ten times a second, the cameras of a rig taking turns.

    Args:
        camera: its name.
        position: its place among the `cameras` of the site.
        cameras: how many there are.
        start_ns: common start of the run, from which the turns count.
        max_rate_hz: limit from the site file.
    """
    rate_hz = min(DEFAULT_RATE_HZ, max_rate_hz)
    offset_ns = start_ns + round(position * SECOND_NS / (cameras * rate_hz))
    return ViewControl(camera, 0, start_ns, rate_hz, offset_ns, "thunder", True, None)


def turn(t_ns: int, control: ViewControl) -> int:
    """Number of the turn that an instant falls into, floor((t - offset) rate), exactly."""
    return int((t_ns - control.offset_ns) * Fraction(control.rate_hz) // SECOND_NS)


def is_due(t_mid_ns: int, t_inferred_ns: int | None, control: ViewControl) -> bool:
    """Whether a picture is to be inferred, given the instant of the last one that was."""
    if control.rate_hz <= 0:
        return False
    return t_inferred_ns is None or turn(t_mid_ns, control) != turn(t_inferred_ns, control)


def missed_turns(t_mid_ns: int, t_grabbed_ns: int, pictures_skipped: int, control: ViewControl) -> int:
    """Turns between two grabbed pictures that passed although there were pictures for them."""
    if control.rate_hz <= 0:
        return 0
    return max(0, min(turn(t_mid_ns, control) - turn(t_grabbed_ns, control) - 1, pictures_skipped))
