"""Cartwheel, sideways: foot, hand, hand, foot, foot on one line, arms and legs straight, upside down in the middle.

Authored to the left, and mirrored for whoever leads with the right. The second half is the first one backwards and mirrored: the
way onto the hands and the way off them are alike.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.motions import palms, posing, rotations, splines
from models.motions.actions.action import Action, Fault
from models.motions.figure import Figure, figure_of
from models.motions.inverse_kinematics import limb_of
from models.motions.mirror import mirror_image, mirrored
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.standing import TOES_OUT_DEG, standing_values
from models.motions.subject import Subject
from models.motions.timeline import snapped
from models.skeleton import smpl

FAULTS: Final = (
    Fault("bent_legs", "the knees are bent by 55 degrees while upside down"),
    Fault("arms_bent", "the elbows give way: upside down, the hips are 7 % of a leg lower"),
    Fault(
        "no_straight_line", "the hands are put down 16 % of a leg in front of the line of the feet, and the hips bend by 35 degrees"
    ),
    Fault("legs_not_apart", "the legs are spread half as far upside down"),
)
_STILL_S: Final = 0.3
_COLUMNS: Final = (
    *("roll", "turn", "bow", "left_out", "right_out", "left_knee", "right_knee", "left_arm", "right_arm", "along", "height"),
)
_KEYS: Final = np.array(
    #  time  roll turn bow  legs out  knees    arms out  along height
    (
        (0.00,   0,  0,  0,  0,   0,  10, 10, 9.65, 9.65, 0.00, 1.00),
        (0.48,  -3,  8, -3, 12,   2,  20, 10, 150, 150, -0.07, 0.99),
        (0.82,   4, 22, -5, 38,   5,  26, 10, 156, 154, 0.29, 0.892),
        (1.04,  28, 37, 10, 42,  24,  44, 8,  152, 160, 0.60, 0.875),
        (1.28,  82, 55, 44, 59,  54,  20,  5, 144, 165, 1.04, 0.96),
        (1.44, 128, 40, 40, 59,  59,   8,  4, 150, 168, 1.31, 1.03),
        (1.58, 160, 12, 17, 59,  59,   4,  4, 160, 166, 1.50, 1.11),
        (1.70, 180,  0,  0, 59,  59,   4,  4, 164, 164, 1.62, 1.14),
    ),
    np.float64,
)  # fmt: skip
"""Seconds; degrees: pelvis to the side, turned to where it goes, trunk bowed to the side, thighs out, knees, arms from hanging to
up; then legs along the line, and the height of the pelvis in its height when standing."""
_ARMS_UP, _FOOT_DOWN, _LUNGE, _FIRST_HAND, _SECOND_HAND, _UPSIDE_DOWN = 1, 2, 3, 4, 5, 7
"""Rows of `_KEYS`."""
_FINGERS_DEG: Final = 135.0
"""Where the fingers point: from straight behind the body to the side of the hand."""
_BACK: Final = 0.46
"""How far behind the trunk a leg swings, tangent."""
_STEP: Final = 0.78
"""How far the first foot steps to the side, legs."""
_SPREAD_DEG: Final = 62.0
"""No leg is spread further to its side; less, if the hips do not give it."""
_BEYOND_DEG: Final = 3.0
"""What is let pass of a hip that is spread beyond its range."""
_TRIES: Final = 4
_TURNED_OUT_DEG: Final = 34.0
"""How much further than in standing the foot that carries alone points to the side."""
_HANDS_APART: Final = 0.46
_KICK_S, _PUSH_S = -0.05, 0.08
"""The second foot leaves so long after the lunge, the first one so long before the second hand bears."""
_REACH_S: Final = (0.055, 0.04)
"""The first and the second hand touch the ground so long after their key poses."""
_SOFT_S, _SOFT_WAY_S = 0.028, 0.075
_YIELD_S: Final = 0.12
_ARM_SPARE: Final = 0.992
"""No arm is stretched further than this share of its length."""
_ROUNDS, _STEADY_S = 2, 0.045
"""How often, and over how long, the pelvis gives way to what the limbs do, so that the centre of mass goes smoothly."""
_LIES_M: Final = 0.007


@dataclass(frozen=True, eq=False)
class _Course:
    """Sampled keys of a cartwheel to the left.

    Attributes:
        times_s: (T,).
        at_s: of each row of `_KEYS`, then of the same rows backwards on the way off the hands.
        column: (T,) of each column.
        inverted: (T,) 1 upside down, 0 on the feet.
        middle: where on the line it is upside down, legs.
    """

    times_s: Float
    at_s: Float
    column: dict[str, Float]
    inverted: Float
    middle: float


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    if performance.handed == "right":
        return mirrored(_left_first(performance, mirror_image(subject)))
    return _left_first(performance, subject)


def _left_first(performance: Performance, subject: Subject) -> Motion:
    """To the left, with the left hand and foot first."""
    spread_deg = _SPREAD_DEG
    for _ in range(_TRIES):
        motion = _wheel(performance, subject, spread_deg)
        beyond = beyond_deg(motion, subject, "hip", 0)
        if beyond < _BEYOND_DEG:
            break
        spread_deg -= 1.3 * beyond
    return motion


def _wheel(performance: Performance, subject: Subject, spread_deg: float) -> Motion:
    """No leg is spread further than so."""
    figure = figure_of(subject)
    course = _course(performance, spread_deg)
    values, contacts = _values(figure, course, performance)
    local = posing.upper_body(figure, values)
    about_x, about_z = np.radians(-course.column["roll"]), np.radians(course.column["turn"])
    local[:, 0] = rotations.about(0, about_x) @ rotations.about(2, about_z)
    _hold_head(course, local)
    home = standing_values(figure)["pelvis"]
    count = len(course.times_s)
    pelvis = np.column_stack((np.zeros(count), course.column["along"] * figure.leg_m, course.column["height"] * home[2]))
    pelvis[:, 2] -= 0.075 * figure.leg_m * performance.severity("arms_bent") * course.inverted
    hands = _hands(figure, course, performance)
    pelvis[:, 2] -= _too_high(figure, hands, pelvis, local)
    for _ in range(_ROUNDS):
        weight = _placed(figure, values, hands, pelvis, local.copy())
        pelvis += splines.softened(weight, _STEADY_S * RATE_HZ) - weight
    _placed(figure, values, hands, pelvis, local)
    placed = figure.place_local(pelvis, local)
    for palm in hands:
        moved = np.linalg.norm((placed.joints_m[:, smpl.INDEX[f"{palm.side}_wrist"]] - palm.wrist_m)[:, :2], axis=1)
        lies = (moved < _LIES_M) & (palms.lowest_m(figure, palm.side, placed) < _LIES_M)
        contacts[:, CONTACTS.index(f"{palm.side}_hand")] = (palm.bears >= 1) & lies
    at_s = course.at_s
    attempt = Attempt(
        "cartwheel", performance.handed, float(at_s[0]), float(at_s[_FIRST_HAND]), float(at_s[_UPSIDE_DOWN]), float(at_s[-1]),
        tuple(performance.faults.items()),
    )  # fmt: skip
    return Motion(pelvis, rotations.vectors(local), contacts, (attempt,))


def _placed(figure: Figure, values: dict[str, Float], hands: tuple[palms.Palm, ...], pelvis: Float, local: Float) -> Float:
    """Put feet and hands where they bear, in place in `local`. Returns (T, 3) the centre of mass."""
    posing.legs(figure, values, pelvis, local)
    for palm in hands:
        palms.bear(figure, palm, pelvis, local)
        palms.settle(figure, palm.side, 0.0, palm.bears >= 1, pelvis, local)
    return figure.centres_of_mass_m(figure.place_local(pelvis, local))


def _course(performance: Performance, spread_deg: float) -> _Course:
    natural, severity = Natural(performance), performance.severity
    first = _KEYS.copy()
    names = dict(zip(_COLUMNS, first[:, 1:].T, strict=True))
    spread = (1 - 0.5 * severity("legs_not_apart")) * min(performance.amplitude, 1.08)
    for side in ("left", "right"):
        names[f"{side}_out"][_SECOND_HAND:] *= spread
        names[f"{side}_out"][_FIRST_HAND:] += float(natural("lean", np.zeros(1))[0])
        np.minimum(names[f"{side}_out"], spread_deg, out=names[f"{side}_out"])
        names[f"{side}_knee"][_SECOND_HAND:] += 55 * severity("bent_legs") + abs(float(natural("bend", np.zeros(1))[0]))
        names[f"{side}_arm"][_ARMS_UP:] += float(natural("lean", np.zeros(1))[0])
    gaps = np.diff(first[:, 0])
    onto = np.array([gap if row >= _FIRST_HAND else natural.seconds(gap) for row, gap in enumerate(gaps)])
    off = np.array([gap if row >= _FIRST_HAND else natural.seconds(gap) for row, gap in enumerate(gaps)])[::-1]
    at_s = np.array(
        [snapped(_STILL_S + float(after)) for after in np.concatenate(((0.0,), np.cumsum(np.concatenate((onto, off)))))]
    )

    middle = float(names["along"][-1])
    back = first[-2::-1].copy()
    again = dict(zip(_COLUMNS, back[:, 1:].T, strict=True))
    again["roll"][:] = 360 - again["roll"]
    again["bow"][:] *= -1
    again["turn"][:] *= -1
    again["along"][:] = 2 * middle - again["along"]
    for part in ("out", "knee", "arm"):
        again[f"left_{part}"][:], again[f"right_{part}"][:] = again[f"right_{part}"].copy(), again[f"left_{part}"].copy()
    keys = np.vstack((first, back))[:, 1:]
    times = np.arange(round((at_s[-1] + _STILL_S) * RATE_HZ) + 1) / RATE_HZ
    sampled = splines.softened(splines.monotone(at_s, keys, times), _SOFT_S * RATE_HZ)
    column = dict(zip(_COLUMNS, sampled.T, strict=True))
    along = _COLUMNS.index("along")
    column["along"] = splines.softened(np.interp(times, at_s, keys[:, along]), _SOFT_WAY_S * RATE_HZ)
    top = at_s[_UPSIDE_DOWN]
    width = at_s[_UPSIDE_DOWN] - at_s[_FIRST_HAND]
    inverted = splines.minimum_jerk(1.35 - np.abs(times - top) / width)
    return _Course(times, at_s, column, inverted, middle)


def _values(figure: Figure, course: _Course, performance: Performance) -> tuple[dict[str, Float], Bool]:
    """The words of `models.motions.vocabulary` at each time, and (T, 5) contacts of the feet."""
    times, at_s, column, leg = course.times_s, course.at_s, course.column, figure.leg_m
    count = len(times)
    home = standing_values(figure)
    values = {name: np.broadcast_to(value, (count, *value.shape)).copy() for name, value in home.items()}
    turn = np.radians(column["turn"])
    values["bow"], values["lean"] = -column["bow"] * np.cos(turn), column["bow"] * np.sin(turn)
    turned_back = rotations.about(2, -turn)
    pike = np.radians(35 * performance.severity("no_straight_line")) * course.inverted
    for side in ("left", "right"):
        arm, out = np.radians(column[f"{side}_arm"]), np.radians(column[f"{side}_out"])
        values[f"{side}_arm.upper"] = np.stack((np.full(count, 0.02), np.sin(arm), -np.cos(arm)), axis=-1)
        thigh = np.stack((np.sin(pike), np.sin(out) * np.cos(pike), -np.cos(out) * np.cos(pike)), axis=-1)
        thigh = rotations.through(turned_back, thigh * posing.OUT[side]) * posing.OUT[side]
        thigh[:, 0] = np.maximum(thigh[:, 0], -_BACK * np.linalg.norm(thigh[:, 1:], axis=1))
        values[f"{side}_leg.thigh"] = thigh
        values[f"{side}_leg.bend"] = column[f"{side}_knee"]
        values[f"{side}_leg.toes"] = 12 + 23 * course.inverted

    # The first foot steps aside, leaves, and lands last; the second leaves first, lands first, and closes up.
    rows = len(_KEYS)
    lunge, hand = at_s[_LUNGE] + _KICK_S, at_s[_SECOND_HAND] - _PUSH_S
    lands, last = at_s[2 * rows - 2 - _SECOND_HAND] + _PUSH_S, at_s[2 * rows - 2 - _LUNGE] - _KICK_S
    far = 2 * course.middle * leg
    ways = {
        "left": ((at_s[_ARMS_UP] - 0.06, at_s[_FOOT_DOWN], _STEP * leg, _TURNED_OUT_DEG), (hand, last, far, 0.0)),
        "right": (
            (lunge, lands, far - _STEP * leg, _TURNED_OUT_DEG),
            (at_s[-1 - _FOOT_DOWN], at_s[-1 - _ARMS_UP] + 0.06, far, 0.0),
        ),
    }
    contacts = np.zeros((count, len(CONTACTS)), bool)
    for side, steps in ways.items():
        contact = np.ones(count, bool)
        place, hold, pitch = values[f"{side}_foot.place"], np.ones(count), np.zeros(count)
        yaw = values[f"{side}_foot.yaw"]
        for number, (lift_s, land_s, target, turned_out) in enumerate(steps):
            lift, land = snapped(lift_s), snapped(land_s)
            walks = (side == "left") == (number == 0)
            share = np.clip((times - lift) / (land - lift), 0.0, 1.0)
            place[:, 1] += splines.minimum_jerk(share) * (home[f"{side}_foot.place"][1] + target - place[-1, 1])
            yaw += splines.minimum_jerk(share) * (home[f"{side}_foot.yaw"] + posing.OUT[side][1] * turned_out - yaw[-1])
            contact &= (times <= lift) | (times >= land)
            if walks:
                place[:, 2] += 0.10 * leg * np.sin(np.pi * share) ** 2
                pitch += 18 * np.sin(np.pi * share) ** 2
            else:
                hold -= splines.minimum_jerk((times - lift) / _YIELD_S) - splines.minimum_jerk((times - land + _YIELD_S) / _YIELD_S)
                pitch += 42 * splines.minimum_jerk((times - lift + 0.16) / 0.16) * (times < (lift + land) / 2)
                pitch += 30 * (1 - splines.minimum_jerk((times - land) / 0.14)) * (times >= (lift + land) / 2)
        values[f"{side}_foot.hold"], values[f"{side}_foot.pitch"] = hold, pitch
        values[f"{side}_leg.turn"] = np.full(count, TOES_OUT_DEG) + 18 * course.inverted
        contacts[:, CONTACTS.index(f"{side}_foot")] = contact
    return values, contacts


def _hold_head(course: _Course, local: Float) -> None:
    """In line with the trunk, and lifted to see the hands."""
    for joint in ("neck", "head"):
        local[:, smpl.INDEX[joint]] = rotations.about(1, np.radians(-14.0) * course.inverted)


def _hands(figure: Figure, course: _Course, performance: Performance) -> tuple[palms.Palm, palms.Palm]:
    """Where and when each hand bears."""
    times, at_s, leg = course.times_s, course.at_s, figure.leg_m
    rows = len(_KEYS)
    count = len(times)
    forward = 0.16 * leg * performance.severity("no_straight_line")
    first, second = _REACH_S
    hands = []
    for side, sign, down, lifts in (
        ("left", -1.0, at_s[_FIRST_HAND] + first, at_s[2 * rows - 2 - _SECOND_HAND] - second),
        ("right", 1.0, at_s[_SECOND_HAND] + second, at_s[2 * rows - 2 - _FIRST_HAND] - first),
    ):
        wrist = np.tile((forward, (course.middle + sign * _HANDS_APART / 2) * leg, palms.wrist_height_m(figure, side)), (count, 1))
        ease = 0.26
        bears = splines.minimum_jerk((times - down + ease) / ease) - splines.minimum_jerk((times - lifts) / ease)
        hands.append(palms.Palm(side, wrist, np.full(count, np.pi + sign * np.radians(_FINGERS_DEG)), bears))
    return hands[0], hands[1]


def _too_high(figure: Figure, hands: tuple[palms.Palm, ...], pelvis: Float, local: Float) -> Float:
    """(T,) how much lower the pelvis must be for the arms to reach the ground."""
    placed = figure.place_local(pelvis, local)
    lower = np.zeros(len(pelvis))
    for palm in hands:
        limb = limb_of(figure, palm.side, "arm")
        to_wrist = palm.wrist_m - placed.joints_m[:, limb.root]
        reach = _ARM_SPARE * float(limb.span_m(np.zeros(())))
        level = np.hypot(to_wrist[:, 0], to_wrist[:, 1])
        down = np.sqrt(np.maximum(reach**2 - level**2, (0.3 * reach) ** 2))
        lower = np.maximum(lower, np.where(palm.bears >= 1, -to_wrist[:, 2] - down, 0.0))
    widest = np.array([lower[max(0, at - 12) : at + 13].max() for at in range(len(lower))])
    return splines.softened(widest, 0.05 * RATE_HZ)


ACTION: Final = Action("cartwheel", "Cartwheel", FAULTS, perform)
