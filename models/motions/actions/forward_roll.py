"""Gymnastics' forward roll: squat, hands on the mat, chin to the chest, over nape, back and seat to the feet, and up.

The feet, then the back, then the feet again carry the body. Whatever carries it stays where it is on the ground: the pelvis' way
follows from that. The pupil begins on the floor before the mat (`models.motions.mat`) and steps off it at the other end.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import limits_rad
from models.motions import mat, palms, posing, rotations, splines
from models.motions.actions.action import Action, Fault
from models.motions.carrying import carried, over_foot, shares, smooth
from models.motions.figure import Figure, figure_of
from models.motions.mirror import mirror_image, mirrored
from models.motions.motion import CONTACTS, RATE_HZ, Attempt, Motion
from models.motions.natural import Natural
from models.motions.performance import Performance
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
_FINGERS_IN_RAD: Final = np.radians(32.0)
_SUPPLE_DEG: Final = 150.0
"""Whose hips bend less gets up with the pelvis tipped less far over the thighs: by this share of what they bend less, as the feet
land and as he is up on them."""
_STIFF_SHARES: Final = (0.3, 0.9)
_SIDES: Final = ("left", "right")
_NECK_SHARE: Final = 0.46
_OUT: Final = (0.6, 0.9, 0.2)
"""Where the elbows point while the hands bear."""
_FAR_UP_M: Final = 9.0
"""Where no floor is in the way of legs that go by their angles."""
_CORNER_M: Final = 0.002
_TOUCHES_M: Final = 0.003
_LIES_M: Final = 0.004
"""A palm that bears is not further than this from where it was put; in the end the wrist bends no further, and it leaves."""


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
        landed_m: x of their prints.
    """

    pelvis_m: Float
    on_back: Bool
    lands_s: float
    landed_m: float


def perform(performance: Performance, subject: Subject) -> Motion:
    """See `models.motions.perform.perform`."""
    if performance.handed == "left":
        return mirrored(_right_first(performance, mirror_image(subject)))
    return _right_first(performance, subject)


def _right_first(performance: Performance, subject: Subject) -> Motion:
    """The right foot steps off the mat first."""
    figure = figure_of(subject)
    limits = limits_rad(subject.age_years)
    course = _course(performance, figure, -float(np.degrees(limits[smpl.INDEX["left_hip"], 1, 0])))
    values = _values(figure, course)
    local = posing.upper_body(figure, values)
    _tuck(course, limits, local)
    way = _way(figure, course, values, local)
    walk = walk_off(
        figure, float(course.at_s[-1]) + 0.1, way.landed_m, mat.FROM_M + mat.LENGTH_M, len(course.times_s), mat.HEIGHT_M
    )
    contacts = _stand_on_feet(figure, course, values, walk, way)
    pelvis = way.pelvis_m + walk.shift_m
    posing.legs(figure, values, pelvis, local)
    for side in _SIDES:
        contacts[:, CONTACTS.index(f"{side}_hand")] = _bear_on_hands(figure, course, way, side, pelvis, local)
    contacts[:, CONTACTS.index("trunk")] = way.on_back
    end = round(walk.end_s * RATE_HZ) + round(_STILL_S * RATE_HZ) + 1
    at_s = course.at_s
    attempt = Attempt(
        "forward_roll", performance.handed, float(at_s[0]), float(at_s[_PUSH]), float(at_s[_BACK]), float(at_s[-1]),
        tuple(performance.faults.items()),
    )  # fmt: skip
    return Motion(pelvis[:end], rotations.vectors(local[:end]), contacts[:end], (attempt,))


def _course(performance: Performance, figure: Figure, hips_bend_deg: float) -> _Course:
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
    open_deg = (4 + 22 * apart) * _while(times, at_s[_FEET_OFF], at_s[_BACK], 0.25)
    return _Course(times, at_s, dict(zip(_COLUMNS, sampled.T, strict=True)), open_deg, min(hands, 1.0))


def _while(times_s: Float, from_s: float, to_s: float, ease_s: float) -> Float:
    """(T,) 1 between two times, 0 outside, with this much time to go from one to the other."""
    up, down = splines.minimum_jerk((times_s - from_s + ease_s) / ease_s), splines.minimum_jerk((times_s - to_s) / ease_s)
    return np.asarray(up - down)


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
    coming = np.flatnonzero((soles < mat.HEIGHT_M) & (times > at_s[_BACK]))
    lands = int(coming[0])
    landed = float(way[lands, 0] - over_feet[lands, 0])
    over_s = at_s[_UP] + 0.1 - times[lands] - _SEAT_STAYS_S
    rises = splines.minimum_jerk((times - times[lands] - _SEAT_STAYS_S) / over_s)[:, None]
    way = (1 - rises) * way + rises * (over_feet + np.array((landed, 0.0, mat.HEIGHT_M)))

    # Keyed legs stand a few millimetres beside `stand`.
    behind_m = np.array((landed - home["left_foot.place"][0], 0.0, mat.HEIGHT_M))
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
        place[later] = np.array((way.landed_m, home[f"{side}_foot.place"][1], mat.HEIGHT_M))
        place += walk.steps_m[side]
        values[f"{side}_foot.hold"] = (
            1 - splines.minimum_jerk((times - off) / 0.12) + splines.minimum_jerk((times - on + 0.12) / 0.12)
        )
        values[f"{side}_foot.pitch"] = np.degrees(np.maximum(course.column["heel"], np.radians(walk.pitch_deg[side])))
        contacts[:, CONTACTS.index(f"{side}_foot")] = ((times <= off) | (times >= on)) & walk.stands[side]
    return contacts


def _bear_on_hands(figure: Figure, course: _Course, way: _Way, side: str, pelvis: Float, local: Float) -> Bool:
    """Put a hand on the mat before the roll, and with the fault beside the hips after it. Returns (T,) when it bears."""
    times, at_s = course.times_s, course.at_s
    count, mirror = len(times), 1.0 if side == "left" else -1.0
    shoulder = figure.place_local(pelvis, local).joints_m[:, smpl.INDEX[f"{side}_shoulder"]]
    width = 1.15 * abs(float(shoulder[0, 1]))
    up = mat.HEIGHT_M + palms.wrist_height_m(figure, side)
    bearing = np.zeros(count, bool)
    nape_s = float(times[np.argmax(way.on_back)])
    turns = [(at_s[_HANDS_DOWN], nape_s, 1.0, width, (_OUT[0], _OUT[1] * mirror, _OUT[2]))]
    if course.propped > 0:
        turns.append((at_s[_SEAT], at_s[_UP], course.propped, 1.3 * width, (-0.8, 0.6 * mirror, 0.2)))
    for from_s, to_s, share, wide, out in turns:
        during = (times >= from_s) & (times <= to_s)
        # Half way between where the shoulders are at first and at last, within reach of both.
        place = np.array((float(shoulder[during, 0].mean()), mirror * wide, up))
        palm = palms.Palm(
            side,
            np.tile(place, (count, 1)),
            np.full(count, -mirror * _FINGERS_IN_RAD),
            share * _while(times, from_s, to_s, 0.2),
            np.tile(out, (count, 1)),
            points=False,
        )
        palms.bear(figure, palm, pelvis, local)
        palms.settle(figure, side, mat.HEIGHT_M, during & (share >= 1), pelvis, local)
        placed = figure.place_local(pelvis, local)
        moved = np.linalg.norm((placed.joints_m[:, smpl.INDEX[f"{side}_wrist"]] - place)[:, :2], axis=1)
        bearing |= during & (moved < _LIES_M) & (palms.lowest_m(figure, side, placed) - mat.HEIGHT_M < _LIES_M)
    return bearing


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
