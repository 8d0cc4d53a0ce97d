"""Gymnastics' forward roll: squat, hands on the mat, chin to the chest, over nape, back and seat to the feet, and up.

The feet, then the back, then the feet again carry the body. Whatever carries it stays where it is on the ground: the pelvis' way
follows from that. The pupil begins on the floor before the mat (`models.motions.mat`) and steps off it at the other end.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import limits_rad
from models.motions import mat, posing, rotations, splines
from models.motions.actions.action import Action, Fault
from models.motions.actions.roll_hands import Support, bear
from models.motions.carrying import carried, over_foot, shares, smooth
from models.motions.figure import Figure, figure_of
from models.motions.mirror import mirror_image, mirrored
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
from models.motions.ranges import beyond_deg
from models.motions.rolling import roll
from models.motions.standing import standing_values
from models.motions.subject import Subject
from models.motions.timeline import snapped
from models.motions.walking_off import Walk, walk_off
from models.skeleton import smpl

_STILL_S: Final = 0.3
_COLUMNS: Final = ("tip", "lean", "neck", "hip", "knee", "heel", "toes", "arm", "bend", "wrist")
_KEYS: Final = np.array(
    #  time   tip lean neck   hip knee heel toes  arm bend wrist
    (
        (0.00,   0,  0,  0,   -6,  12,   0,   0,   0,  14,   4),
        (0.42,  30, 22,  0,  -80,  95,   6,   0,  75,  14, -20),
        (0.80,  60, 58, 12, -120, 122,  26,   0, 132,  12, -40),
        (1.06,  90, 66, 50, -114,  88,  42, -20, 125,  20, -60),
        (1.27, 124, 80, 78, -108,  46,  58,  -6, 128,  60, -60),
        (1.50, 160, 88, 82,  -92,  64,  60,  15, 118, 115, -70),
        (1.72, 214, 90, 82, -112,  48,  20,  35,  95, 115, -60),
        (1.89, 266, 90, 70, -122,  92,   0,  20,  98,  80, -20),
        (2.03, 302, 86, 58, -123, 127,   4,   0, 117,  25,   0),
        (2.13, 322, 86, 42, -123, 129,  12, -12, 134,  10,   0),
        (2.38, 349, 90,  4, -120, 130,  18, -30, 150,  10,   0),
        (2.68, 374, 34,  6,  -80,  90,   6,   0, 122,  12,   0),
        (3.04, 360,  0,  0,   -6,  12,   0,   0,   0,  14,   4),
    ),
    np.float64,
)  # fmt: skip
"""Seconds; degrees: pelvis and back to the front, chin to the chest, hip, knee, heels up, toes, arms from hanging to up, elbow."""
_HANDS_DOWN, _PUSH, _FEET_OFF, _NAPE_ON, _HANDS_OFF, _BACK, _SEAT, _FEET_ON, _UP = 2, 3, 4, 5, 6, 7, 8, 9, 10
"""Rows of `_KEYS`."""
_SOFT_S: Final = 0.025
_SOFT_ROLL_S: Final = 0.008
_SEAT_STAYS_S: Final = 0.03
"""The seat stays on the mat so long after the feet have landed."""
_LEG_OF_KEYS_M: Final = 0.64
_SUPPLE_DEG: Final = 150.0
"""Whose hips bend less gets up with the pelvis tipped less far over the thighs: by this share of what they bend less, as the feet
land and as he is up on them."""
_STIFF_SHARES: Final = (0.3, 0.9)
_HIP_SPARE_DEG: Final = 4.0
"""No leg is opened further than to so much from where the hip ends."""
_SIDES: Final = ("left", "right")
_NECK_SHARE: Final = 0.46
_OUT, _OUT_BEHIND = (0.6, 0.9, 0.2), (-0.8, 0.6, 0.2)
"""(front, out, up) where the elbows point while the hands bear: before the roll and after it."""
_NEARER_ARMS: Final = (0.0, 0.06, 0.12, 0.18, 0.24, 0.3)
"""How much nearer to the feet the hands are put, arms: the first that the arms allow."""
_BEYOND_DEG: Final = 2.5
"""What is let pass of hips that bend beyond their range."""
_ROUNDS: Final = 4
"""How often hips that would bend too far are asked for less."""
_FAR_UP_M: Final = 9.0
"""Where no floor is in the way of legs that go by their angles."""
_CORNER_M: Final = 0.002
_TOUCHES_M: Final = 0.003


@dataclass(frozen=True, eq=False)
class _Course:
    """Sampled keys.

    Attributes:
        times_s: (T,).
        at_s: time of each row of `_KEYS`.
        column: (T,) of each column.
        open_deg: (T,) of each leg to the side.
        propped: how far the hands help in getting up, 0 to 1.
    """

    times_s: Float
    at_s: Float
    column: dict[str, Float]
    open_deg: Float
    propped: float


@dataclass(frozen=True, eq=False)
class _Way:
    """Of the body.

    Attributes:
        pelvis_m: (T, 3).
        on_back: (T,) whether the back or the head touches the mat.
        lands_s: when the feet land.
        landed_m: (3,) their prints' middle, on the mat or, of who is tall, on the floor behind it.
    """

    pelvis_m: Float
    on_back: Bool
    lands_s: float
    landed_m: Float


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    if performance.handed == "left":
        return mirrored(_right_first(performance, mirror_image(subject)))
    return _right_first(performance, subject)


def _right_first(performance: Performance, subject: Subject) -> Motion:
    """The right foot steps off the mat first."""
    limits = limits_rad(subject.age_years)
    bend_deg = -float(np.degrees(limits[smpl.INDEX["left_hip"], 1, 0]))
    for _ in range(_ROUNDS):
        motion, lands_s = _with_hips(performance, subject, limits, bend_deg)
        beyond = beyond_deg(motion, subject, "hip", 1, lands_s)
        if beyond < _BEYOND_DEG:
            break
        bend_deg -= 2 * beyond
    return motion


def _with_hips(performance: Performance, subject: Subject, limits: Float, bend_deg: float) -> tuple[Motion, float]:
    """The roll of somebody who asks so much of his hips to get up, and when his feet land."""
    figure = figure_of(subject)
    course = _course(performance, figure, limits, bend_deg)
    values = _values(figure, course)
    local = posing.upper_body(figure, values)
    _tuck(course, limits, local)
    way = _way(figure, course, values, local)
    x_m, _, ground_m = way.landed_m
    walk = walk_off(figure, float(course.at_s[-1]) + 0.1, x_m, mat.FROM_M + mat.LENGTH_M, len(course.times_s), ground_m)
    contacts = _stand_on_feet(figure, course, values, walk, way)
    pelvis = way.pelvis_m + walk.shift_m
    posing.legs(figure, values, pelvis, local)
    hands = [CONTACTS.index(f"{side}_hand") for side in _SIDES]
    contacts[:, hands] = bear(figure, course.times_s, _supports(course, way), pelvis, local)
    contacts[:, CONTACTS.index("trunk")] = way.on_back
    end = round(walk.end_s * RATE_HZ) + round(_STILL_S * RATE_HZ) + 1
    at_s = course.at_s
    attempt = Attempt(
        "forward_roll", performance.handed, float(at_s[0]), float(at_s[_PUSH]), float(at_s[_BACK]), float(at_s[-1]),
        tuple(performance.faults.items()),
    )  # fmt: skip
    return Motion(pelvis[:end], rotations.vectors(local[:end]), contacts[:end], (attempt,)), way.lands_s


def _course(performance: Performance, figure: Figure, limits: Float, hips_bend_deg: float) -> _Course:
    natural, severity = Natural(performance), performance.severity
    untucked, apart, hands = severity("head_not_tucked"), severity("legs_open"), severity("hands_to_get_up")
    keys = _KEYS.copy()
    names = dict(zip(_COLUMNS, keys[:, 1:].T, strict=True))
    names["neck"][_FEET_OFF:_SEAT] *= 1 - 0.45 * untucked
    names["lean"][_FEET_OFF:_SEAT] *= 1 - 0.18 * untucked
    names["knee"][_FEET_OFF : _HANDS_OFF + 1] *= natural.times(0.08) * (2 - performance.amplitude)
    for name, rows in (("lean", (_HANDS_DOWN, _UP)), ("neck", (_FEET_OFF, _BACK)), ("arm", (_SEAT, _UP)), ("bend", (_BACK, _UP))):
        word = "lean" if name == "neck" else "bend" if name == "arm" else name
        names[name][rows[0] : rows[1] + 1] += float(natural(word, np.zeros(1))[0])
    for row, share in zip((_FEET_ON, _UP), _STIFF_SHARES, strict=True):
        less = share * max(0.0, _SUPPLE_DEG - hips_bend_deg)
        names["tip"][row] -= less
        names["hip"][row] += less

    gaps = np.diff(keys[:, 0])
    rolling = np.arange(1, len(keys))
    own = (rolling > _FEET_OFF) & (rolling <= _FEET_ON)
    gaps *= np.where(own, np.sqrt(figure.leg_m / _LEG_OF_KEYS_M), natural.seconds(1.0))
    gaps[_UP - 1 :] *= 1 + 0.35 * hands
    at_s = np.array([snapped(_STILL_S + float(gap)) for gap in np.concatenate(((0.0,), np.cumsum(gaps)))])

    count = round((at_s[-1] + 6.0) * RATE_HZ)
    times = np.arange(count) / RATE_HZ
    sampled = smooth(np.radians(splines.monotone(at_s, keys[:, 1:], times)), _SOFT_S)
    widest_deg = np.degrees(limits[smpl.INDEX["left_hip"], 2, 1]) - _HIP_SPARE_DEG
    open_deg = min(4 + 22 * apart, widest_deg) * splines.lasting(times, at_s[_FEET_OFF], at_s[_BACK], 0.25)
    return _Course(times, at_s, dict(zip(_COLUMNS, sampled.T, strict=True)), open_deg, min(hands, 1.0))


def _values(figure: Figure, course: _Course) -> dict[str, Float]:
    """The words of `models.motions.vocabulary` at each time; the feet are free."""
    count, column = len(course.times_s), course.column
    values = {name: np.broadcast_to(value, (count, *value.shape)).copy() for name, value in standing_values(figure).items()}
    values["tip"], values["lean"] = np.degrees(column["tip"]), np.degrees(column["lean"])
    arm, hip = column["arm"], column["hip"]
    for side in _SIDES:
        values[f"{side}_arm.upper"] = np.stack((np.sin(arm) + 0.02 * np.cos(arm), np.full(count, 0.17), -np.cos(arm)), axis=-1)
        raised = splines.minimum_jerk(arm / np.radians(75.0))
        fore = np.stack((np.cos(arm) * (1 - 0.6 * raised), -0.15 - 0.45 * raised, np.sin(arm)), axis=-1)
        values[f"{side}_arm.fore"] = fore
        values[f"{side}_arm.bend"] = np.degrees(column["bend"])
        values[f"{side}_arm.wrist"] = np.degrees(column["wrist"])
        values[f"{side}_leg.thigh"] = np.stack((-np.sin(hip), np.tan(np.radians(course.open_deg)), -np.cos(hip)), axis=-1)
        values[f"{side}_leg.bend"], values[f"{side}_leg.toes"] = np.degrees(column["knee"]), np.degrees(column["toes"])
        values[f"{side}_foot.hold"] = np.zeros(count)
    return values


def _tuck(course: _Course, limits: Float, local: Float) -> None:
    """Chin to the chest, whatever the eyes would like to see."""
    for joint, share in (("neck", _NECK_SHARE), ("head", 1 - _NECK_SHARE)):
        most = limits[smpl.INDEX[joint], 1, 1]
        local[:, smpl.INDEX[joint]] = rotations.about(1, np.minimum(share * course.column["neck"], most))


def _way(figure: Figure, course: _Course, values: dict[str, Float], local: Float) -> _Way:
    times, at_s = course.times_s, course.at_s
    count = len(times)
    posing.legs(figure, values, np.full((count, 3), _FAR_UP_M), local)
    placed = figure.place_local(np.zeros((count, 3)), local)
    heel = np.clip(course.column["heel"], *np.radians((0.0, 60.0)))
    over_feet = np.mean(
        [over_foot(figure, side, placed, np.radians(values[f"{side}_foot.yaw"]), heel) for side in _SIDES], axis=0
    )  # fmt: skip
    push, off = round(at_s[_PUSH] * RATE_HZ), round(at_s[_FEET_OFF] * RATE_HZ)
    highest = push + int(np.argmax(over_feet[push:off, 2]))
    first = push - round(0.1 * RATE_HZ)
    last = round((at_s[_UP] + 0.1) * RATE_HZ) + 1
    rolled = roll(figure, local[first:last])
    back = np.zeros((count, 3))
    back[first:last, [0, 2]] = smooth(np.column_stack((rolled.travel_m, rolled.heights_m + mat.HEIGHT_M)), _SOFT_ROLL_S)
    back[last:] = back[last - 1]
    way = carried(shares(times, ((at_s[_FEET_OFF] - 0.05, at_s[_NAPE_ON]),)), np.stack((_kept_up(over_feet, highest), back)))
    home = standing_values(figure)
    way[:, 0] += home["left_foot.place"][0]
    way[first:last, 2] = back[first:last, 2] + _above(way[first:last, 2] - back[first:last, 2])

    # The feet land where they come down by themselves, and from then on the body goes from the seat over to them.
    soles = (way + placed.joints_m[:, [smpl.INDEX["left_ankle"]]][:, 0])[:, 2] - figure.soles["left"].ankle_m(heel)[1]
    for ground_m in (mat.HEIGHT_M, 0.0):
        lands = int(np.flatnonzero((soles < ground_m) & (times > at_s[_BACK]))[0])
        landed = np.array((way[lands, 0] - over_feet[lands, 0], 0.0, ground_m))
        if landed[0] + figure.soles["left"].heel_m < mat.FROM_M + mat.LENGTH_M:
            break
    over_s = at_s[_UP] + 0.1 - times[lands] - _SEAT_STAYS_S
    rises = splines.minimum_jerk((times - times[lands] - _SEAT_STAYS_S) / over_s)[:, None]
    way = (1 - rises) * way + rises * (over_feet + landed)

    # Keyed legs stand a few millimetres beside `stand`.
    behind_m = landed - np.array((home["left_foot.place"][0], 0.0, 0.0))
    settle = splines.minimum_jerk((times - at_s[0]) / 0.4)[:, None]
    rise = splines.minimum_jerk((times - at_s[-1] + 0.4) / 0.4)[:, None]
    way = way + (1 - settle) * (home["pelvis"] - way[0]) + rise * (home["pelvis"] + behind_m - way[-1])
    on_back = way[:, 2] - back[:, 2] < _TOUCHES_M
    on_back[:off] = on_back[last:] = False
    return _Way(way, on_back, float(times[lands]), landed)


def _kept_up(over_feet: Float, highest: int) -> Float:
    """The way over feet that push off and leave: from its highest point on at the same pace, until the back carries."""
    kept = over_feet.copy()
    later = np.arange(len(kept) - highest)[:, None]
    kept[highest:] = kept[highest] + later * (kept[highest] - kept[highest - 1]) * np.array((1.0, 0.0, 0.0))
    return kept


def _above(height_m: Float) -> Float:
    """A height that does not fall below 0, with a rounded corner."""
    return np.asarray(_CORNER_M * np.logaddexp(0.0, height_m / _CORNER_M))


def _stand_on_feet(figure: Figure, course: _Course, values: dict[str, Float], walk: Walk, way: _Way) -> Bool:
    """Hold the feet where they carry, in place in `values`. Returns (T, 5) contacts of the feet."""
    times, at_s = course.times_s, course.at_s
    off, on = at_s[_FEET_OFF], way.lands_s
    contacts = np.zeros((len(times), len(CONTACTS)), bool)
    home = standing_values(figure)
    for side in _SIDES:
        place = values[f"{side}_foot.place"]
        later = times > (off + on) / 2
        place[later] = way.landed_m + home[f"{side}_foot.place"] * np.array((0.0, 1.0, 0.0))
        place += walk.steps_m[side]
        values[f"{side}_foot.hold"] = (
            1 - splines.minimum_jerk((times - off) / 0.12) + splines.minimum_jerk((times - on + 0.12) / 0.12)
        )
        values[f"{side}_foot.pitch"] = np.degrees(np.maximum(course.column["heel"], np.radians(walk.pitch_deg[side])))
        contacts[:, CONTACTS.index(f"{side}_foot")] = ((times <= off) | (times >= on)) & walk.stands[side]
    return contacts


def _supports(course: _Course, way: _Way) -> list[Support]:
    """Of the hands: before the roll, and with the fault in getting up."""
    at_s = course.at_s
    rolls_s = float(course.times_s[np.argmax(way.on_back)])
    before = Support(float(at_s[_HANDS_DOWN]), rolls_s, 1.0, 1.15, _OUT, _NEARER_ARMS)
    behind = Support(float(at_s[_SEAT]), float(at_s[_UP]), course.propped, 1.3, _OUT_BEHIND)
    return [before, behind] if course.propped > 0 else [before]


ACTION: Final = Action(
    name="forward_roll",
    title="Forward roll",
    faults=(
        Fault("head_not_tucked", "the chin is 45 % less tucked and the back 18 % less round: rolls over the head and lands flat"),
        Fault("legs_open", "the legs are 22 degrees further apart each in the roll"),
        Fault("hands_to_get_up", "pushes off the mat with the hands beside the hips to get up, which takes a third longer"),
    ),
    perform=perform,
)
