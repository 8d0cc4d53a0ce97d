"""Where parts of the body are: heights, reaches, distances, as shares of the pupil's stature, so that small and tall compare."""

from collections.abc import Callable
from typing import Final

from models.arrays import Float
from services.evaluation.signals.mass import COM_SOURCE
from services.evaluation.signals.posture import Formula, Posture, dot, norm
from services.evaluation.signals.signal import Signal

_SHARE: Final = "pct"


def _percent(metres: Callable[[Posture], Float]) -> Formula:
    return lambda body: 100 * metres(body) / body.stature_m


def _height(part: str) -> Formula:
    return _percent(lambda body: body.own(part)[..., 2])


def _ahead(part: str, of: Callable[[Posture], Float]) -> Formula:
    """How far a part is in front of a point, along where the body faces."""
    return _percent(lambda body: dot(body.own(part) - of(body), body.level_axes()[0]))


def _apart(part: str) -> Formula:
    return _percent(lambda body: norm(body.line(part)))


def _hips(body: Posture) -> Float:
    return body.middle("hip")


def _shoulder(body: Posture) -> Float:
    return body.own("shoulder")


def _behind_shoulder(body: Posture) -> Float:
    front = body.trunk_axes()[0]
    return 100 * dot(body.own("shoulder") - body.own("elbow"), front) / body.stature_m


def _knee_over_ankle(body: Posture) -> Float:
    return dot(body.line("knee"), body.level_axes()[1]) - dot(body.line("ankle"), body.level_axes()[1])


def _com_forward(body: Posture) -> Float:
    return dot(body.centre_of_mass() - body.middle("ankle"), body.level_axes()[0])


def _com_aside(body: Posture) -> Float:
    return dot(body.centre_of_mass() - body.middle("ankle"), body.level_axes()[1])


def _hip_drop(body: Posture) -> Float:
    """Against a leg that is straight and upright: thigh and shank as they are now."""
    legs = [body.own, body.other]
    lengths = [norm(leg("hip") - leg("knee")) + norm(leg("knee") - leg("ankle")) for leg in legs]
    return (lengths[0] + lengths[1]) / 2 - (body.middle("hip") - body.middle("ankle"))[..., 2]


_FROM_FLOOR = "Height above the floor"
SIGNALS = (
    *(
        Signal(f"{part}_height", _SHARE, f"{_FROM_FLOOR} of the {part}.", _height(part), sided=True)
        for part in ("wrist", "elbow", "shoulder", "knee", "ankle")
    ),
    Signal("hip_height", _SHARE, f"{_FROM_FLOOR} of the middle of the hips.", _percent(lambda body: _hips(body)[..., 2])),
    Signal("nose_height", _SHARE, f"{_FROM_FLOOR} of the nose.", _percent(lambda body: body.joint("nose")[..., 2])),
    Signal(
        "com_height",
        _SHARE,
        f"{_FROM_FLOOR} of the centre of mass.",
        _percent(lambda body: body.centre_of_mass()[..., 2]),
        COM_SOURCE,
    ),
    Signal(
        "hip_drop",
        _SHARE,
        "How much nearer the hips are to the level of the ankles than with straight, upright legs.",
        _percent(_hip_drop),
    ),
    Signal(
        "wrist_above_head",
        _SHARE,
        "How far the wrist is above the middle between the ears; negative below.",
        _percent(lambda body: (body.own("wrist") - body.middle("ear"))[..., 2]),
        sided=True,
    ),
    Signal(
        "wrist_forward",
        _SHARE,
        "How far the wrist is in front of its shoulder, along where hips and shoulders face.",
        _ahead("wrist", _shoulder),
        sided=True,
    ),
    Signal(
        "wrist_aside",
        _SHARE,
        "How far the wrist is outside of its shoulder, on the level; negative across the body.",
        _percent(lambda body: dot(body.own("wrist") - body.own("shoulder"), body.level_axes()[1])),
        sided=True,
    ),
    Signal("wrist_apart", _SHARE, "Distance of the wrists.", _apart("wrist")),
    Signal(
        "elbow_behind_shoulder",
        _SHARE,
        "How far the elbow is behind its shoulder, along the front of the trunk; negative in front.",
        _behind_shoulder,
        sided=True,
    ),
    Signal(
        "elbow_aside",
        _SHARE,
        "How far the elbow is outside of its shoulder, on the level; negative across the body.",
        _percent(lambda body: dot(body.own("elbow") - body.own("shoulder"), body.level_axes()[1])),
        sided=True,
    ),
    Signal("ankle_forward", _SHARE, "How far the ankle is in front of the middle of the hips.", _ahead("ankle", _hips), sided=True),
    Signal("knee_forward", _SHARE, "How far the knee is in front of the middle of the hips.", _ahead("knee", _hips), sided=True),
    Signal("ankle_apart", _SHARE, "Distance of the ankles.", _apart("ankle")),
    Signal("knee_apart", _SHARE, "Distance of the knees.", _apart("knee")),
    Signal(
        "knee_apart_more",
        _SHARE,
        "How much further apart the knees are than the ankles, from side to side; negative with the knees fallen in.",
        _percent(_knee_over_ankle),
    ),
    Signal(
        "com_forward",
        _SHARE,
        "How far the centre of mass is in front of the middle of the ankles.",
        _percent(_com_forward),
        COM_SOURCE,
    ),
    Signal(
        "com_aside",
        _SHARE,
        "How far the centre of mass is to the side that leads of the middle of the ankles.",
        _percent(_com_aside),
        COM_SOURCE,
    ),
)
