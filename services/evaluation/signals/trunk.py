"""How the trunk leans, bends and turns."""

import numpy as np

from models.arrays import Float
from services.evaluation.signals.posture import UP, Posture, between_deg, dot, norm, turned_deg
from services.evaluation.signals.signal import Signal


def _trunk(body: Posture) -> Float:
    return body.middle("shoulder") - body.middle("hip")


def _inclination(body: Posture) -> Float:
    trunk = _trunk(body)
    return between_deg(trunk, np.broadcast_to(UP, trunk.shape))


def _forward(body: Posture) -> Float:
    trunk, (front, _) = _trunk(body), body.level_axes()
    return turned_deg(dot(trunk, front), trunk[..., 2])


def _side(body: Posture) -> Float:
    trunk, (_, out) = _trunk(body), body.level_axes()
    return turned_deg(dot(trunk, out), trunk[..., 2])


def _twist(body: Posture) -> Float:
    shoulders, hips = body.line("shoulder"), body.line("hip")
    return body.backwards * _turn_deg(hips, shoulders)


def _heading(body: Posture) -> Float:
    across = body.line("shoulder") + body.line("hip")
    return body.backwards * turned_deg(across[..., 1], across[..., 0])


def _turn_deg(first: Float, second: Float) -> Float:
    """From one level direction to another, positive to the left."""
    sine = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return turned_deg(sine, first[..., 0] * second[..., 0] + first[..., 1] * second[..., 1])


def _length(body: Posture) -> Float:
    return 100 * norm(_trunk(body)) / body.stature_m


SIGNALS = (
    Signal(
        "trunk_inclination",
        "deg",
        "0 upright: the line from hips to shoulders against the vertical, to whichever side.",
        _inclination,
        "eq. 18",
    ),
    Signal(
        "trunk_forward",
        "deg",
        "0 upright, positive bent to where hips and shoulders face, negative leant back.",
        _forward,
    ),
    Signal("trunk_side", "deg", "0 upright, positive leant to the side that leads.", _side),
    Signal(
        "trunk_twist",
        "deg",
        "The line of the shoulders against the line of the hips, as seen from above: "
        "positive with the shoulder of the side that leads drawn back.",
        _twist,
    ),
    Signal(
        "heading",
        "deg",
        "Where hips and shoulders face, as seen from above, against the start of the attempt: "
        "positive with the side that leads turned backwards.",
        _heading,
        from_start=True,
    ),
    Signal(
        "trunk_length",
        "pct",
        "Distance from the middle of the hips to the middle of the shoulders: shorter with a round back.",
        _length,
    ),
)
