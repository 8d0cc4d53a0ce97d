"""How fast parts of the body move: formulas over velocities and accelerations of the joints, and rates of angles."""

from models.arrays import Float
from services.evaluation.signals.angles import SIGNALS as ANGLES
from services.evaluation.signals.mass import COM_SOURCE
from services.evaluation.signals.posture import Formula, Posture, norm
from services.evaluation.signals.signal import Signal

_ANGLES = {signal.name: signal for signal in ANGLES}


def _magnitude(part: str) -> Formula:
    return lambda body: norm(body.own(part))


def _com(body: Posture) -> Float:
    return norm(body.centre_of_mass())


def _rise(body: Posture) -> Float:
    return body.centre_of_mass()[..., 2]


def _hips(body: Posture) -> Float:
    return norm(body.middle("hip"))


SIGNALS = (
    *(
        Signal(f"{part}_speed", "m_s", f"Speed of the {part}.", _magnitude(part), order=1, sided=True)
        for part in ("wrist", "elbow", "knee", "ankle")
    ),
    Signal("hip_speed", "m_s", "Speed of the middle of the hips.", _hips, order=1),
    Signal("com_speed", "m_s", "Speed of the centre of mass.", _com, COM_SOURCE, order=1),
    Signal("com_rise_speed", "m_s", "Speed of the centre of mass upwards; negative down.", _rise, COM_SOURCE, order=1),
    *(
        Signal(
            f"{part}_acceleration", "m_s2", f"Acceleration of the {part}, without gravity.", _magnitude(part), order=2, sided=True
        )
        for part in ("wrist", "ankle")
    ),
    Signal("com_acceleration", "m_s2", "Acceleration of the centre of mass, without gravity.", _com, COM_SOURCE, order=2),
    *(
        Signal(
            f"{joint}_angular_speed",
            "deg_s",
            f"How fast the {joint} straightens; negative while it bends.",
            _ANGLES[f"{joint}_flexion"].formula,
            sided=True,
            rate_of=f"{joint}_flexion",
        )
        for joint in ("knee", "elbow", "hip")
    ),
)
