"""Angles of limbs against one another and against the trunk.

Directions follow the recommendations of the International Society of Biomechanics where 17 points allow: 0 is the anatomical
position, flexion and abduction are positive. Where they want axes that 17 points do not have (a femur's epicondyles, a pelvis'
spines) the nearest angle that the points do have is taken, and the definition says which.
"""

import numpy as np

from models.arrays import Float
from services.evaluation.signals.posture import Posture, between_deg, dot, turned_deg, unit
from services.evaluation.signals.signal import Signal

_GROOD = "Grood and Suntay, J. Biomechanical Engineering 105, 1983, whose flexion it is for a knee without valgus or rotation"
_WU_2002 = "Wu et al., ISB recommendation part I, J. Biomechanics 35, 2002"
_WU_2005 = "Wu et al., ISB recommendation part II, J. Biomechanics 38, 2005"


def _knee_flexion(body: Posture) -> Float:
    return between_deg(body.own("knee") - body.own("hip"), body.own("ankle") - body.own("knee"))


def _elbow_flexion(body: Posture) -> Float:
    return between_deg(body.own("elbow") - body.own("shoulder"), body.own("wrist") - body.own("elbow"))


def _hip_flexion(body: Posture) -> Float:
    across = unit(body.line("hip"))
    trunk = body.middle("shoulder") - body.middle("hip")
    up = unit(trunk - dot(trunk, across)[..., None] * across)
    front = body.front_of(across, up)
    thigh = body.own("knee") - body.own("hip")
    return turned_deg(dot(thigh, front), -dot(thigh, up))


def _hip_abduction(body: Posture) -> Float:
    thigh = unit(body.own("knee") - body.own("hip"))
    return np.degrees(np.arcsin(np.clip(dot(thigh, unit(body.line("hip"))), -1, 1)))


def _knee_valgus(body: Posture) -> Float:
    _, out = body.level_axes()
    thigh, shank = body.own("knee") - body.own("hip"), body.own("ankle") - body.own("knee")
    (out_thigh, out_shank), (down_thigh, down_shank) = (dot(thigh, out), dot(shank, out)), (-thigh[..., 2], -shank[..., 2])
    return turned_deg(out_shank * down_thigh - down_shank * out_thigh, out_shank * out_thigh + down_shank * down_thigh)


def _upper_arm(body: Posture) -> tuple[Float, Float, Float]:
    """To the front, outwards and up of the trunk."""
    front, out, up = body.trunk_axes()
    arm = body.own("elbow") - body.own("shoulder")
    return dot(arm, front), dot(arm, out), dot(arm, up)


def _shoulder_elevation(body: Posture) -> Float:
    return between_deg(body.own("elbow") - body.own("shoulder"), body.middle("hip") - body.middle("shoulder"))


def _shoulder_abduction(body: Posture) -> Float:
    _, out, up = _upper_arm(body)
    return turned_deg(out, -up)


def _shoulder_flexion(body: Posture) -> Float:
    front, _, up = _upper_arm(body)
    return turned_deg(front, -up)


def _upper_arm_azimuth(body: Posture) -> Float:
    front, out, _ = _upper_arm(body)
    return turned_deg(out, front)


def _head_flexion(body: Posture) -> Float:
    front, _, up = body.trunk_axes()
    face = body.joint("nose") - body.middle("ear")
    return turned_deg(-dot(face, up), dot(face, front))


def _forearm_inclination(body: Posture) -> Float:
    forearm = body.own("wrist") - body.own("elbow")
    return between_deg(forearm, np.broadcast_to((0.0, 0.0, 1.0), forearm.shape))


SIGNALS = (
    Signal(
        "knee_flexion",
        "deg",
        "0 straight, positive bent: angle between thigh (hip to knee) and shank (knee to ankle).",
        _knee_flexion,
        f"eq. 18; {_GROOD}",
        sided=True,
    ),
    Signal(
        "elbow_flexion",
        "deg",
        "0 straight, positive bent: angle between upper arm (shoulder to elbow) and forearm (elbow to wrist).",
        _elbow_flexion,
        f"eq. 18; {_WU_2005}",
        sided=True,
    ),
    Signal(
        "hip_flexion",
        "deg",
        "0 with the thigh in line with the trunk, positive lifted to the front, negative behind: in the plane at right angles "
        "to the line of the hips. The ISB's pelvis is replaced by the line from hips to shoulders, so a bent back counts.",
        _hip_flexion,
        _WU_2002,
        sided=True,
    ),
    Signal(
        "hip_abduction",
        "deg",
        "0 with the thigh at right angles to the line of the hips, positive out to the side.",
        _hip_abduction,
        _WU_2002,
        sided=True,
    ),
    Signal(
        "knee_valgus",
        "deg",
        "0 with hip, knee and ankle in line as seen from the front, positive with the knee fallen in.",
        _knee_valgus,
        "frontal-plane projection angle: Willson and Davis, J. Orthopaedic and Sports Physical Therapy 38(10), 2008",
        sided=True,
    ),
    Signal(
        "shoulder_elevation",
        "deg",
        "0 with the upper arm along the trunk, 90 level, 180 over the head, to whichever side.",
        _shoulder_elevation,
        f"elevation of {_WU_2005}, against the line from hips to shoulders",
        sided=True,
    ),
    Signal(
        "shoulder_abduction",
        "deg",
        "The upper arm as seen from the front of the trunk: 0 down, 90 out to the side, 180 up.",
        _shoulder_abduction,
        sided=True,
    ),
    Signal(
        "shoulder_flexion",
        "deg",
        "The upper arm as seen from the side of the trunk: 0 down, 90 to the front, 180 up, negative behind.",
        _shoulder_flexion,
        sided=True,
    ),
    Signal(
        "upper_arm_azimuth",
        "deg",
        "To which side of the trunk the upper arm points: 0 front, 90 out, 180 behind, -90 across the chest. "
        "Says nothing while the arm hangs or is straight up, which the sigma shows.",
        _upper_arm_azimuth,
        f"90 degrees less the plane of elevation of {_WU_2005}",
        sided=True,
    ),
    Signal(
        "forearm_inclination",
        "deg",
        "0 with the forearm (elbow to wrist) straight up, 90 level, 180 hanging.",
        _forearm_inclination,
        sided=True,
    ),
    Signal(
        "head_flexion",
        "deg",
        "The line from the ears to the nose against the front of the trunk: positive with the chin down. "
        "Somebody who looks straight ahead has about 5.",
        _head_flexion,
    ),
)
