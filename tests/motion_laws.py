"""What must hold for every motion of every subject, measured: feet that stand, bodies that fly, joints that turn."""

from dataclasses import dataclass

import numpy as np

from models.arrays import Bool, Float
from models.body.limits import excess_rad, limits_rad
from models.body.pose import Pose
from models.motions import rotations
from models.motions.ballistics import GRAVITY_M_S2
from models.motions.figure import Placed, figure_of
from models.motions.motion import CONTACTS, RATE_HZ, Motion
from models.motions.standing import stand
from models.motions.subject import Subject
from models.skeleton import smpl

SIDES = ("left", "right")


@dataclass(frozen=True)
class Measured:
    """The worst of a motion.

    Attributes:
        slide_mm: level movement of a foot that stands: of its ball or its heel, whichever stays.
        sunk_mm: skin under the floor, above 0.
        floating_mm: lowest skin of a foot that is said to stand, over the floor.
        off_parabola_mm: centre of mass in flight against free fall.
        pull, push, shove: forces of the floor while something bears, in weights of the body: down (which no floor does), up, level.
        take_off_error_m_s: velocity of the centre of mass just before a flight against the flight's.
        beyond_limit_deg: joints against `models.body.limits`, and `beyond_limit_joint`.
        speed_rad_s, acceleration_rad_s2: of the joints, and which.
        from_stand_deg, to_stand_deg: first and last pose against `stand`, as far as the pelvis' yaw is not concerned.
        start_speed_m_s, end_speed_m_s: of the fastest joint at both ends.
    """

    slide_mm: float
    sunk_mm: float
    floating_mm: float
    off_parabola_mm: float
    take_off_error_m_s: float
    pull: float
    push: float
    shove: float
    beyond_limit_deg: float
    beyond_limit_joint: str
    speed_rad_s: float
    speed_joint: str
    acceleration_rad_s2: float
    acceleration_joint: str
    from_stand_deg: float
    to_stand_deg: float
    start_speed_m_s: float
    end_speed_m_s: float


def measured(motion: Motion, subject: Subject, every: int = 4) -> Measured:
    """Measure a motion; the skin at every so many poses."""
    figure = figure_of(subject)
    placed = figure.place(motion.translations_m, motion.rotations_rad)
    feet = motion.contacts[:, :2]
    sunk, floating = _skin(motion, subject, every)
    centre = figure.centres_of_mass_m(placed)
    off, jump = _flights(centre, in_air(motion))
    force = np.diff(centre, 2, axis=0) * RATE_HZ**2 / GRAVITY_M_S2 + np.array((0.0, 0.0, 1.0))
    borne = force[~in_air(motion)[1:-1]]
    excess = np.degrees(np.abs(excess_rad(motion.rotations_rad, limits_rad(subject.age_years)))).max(axis=(0, 2))
    local = rotations.matrices(motion.rotations_rad)
    spin = rotations.vectors(local[:-1].swapaxes(-1, -2) @ local[1:]) * RATE_HZ
    speed = np.linalg.norm(spin, axis=-1).max(0)
    acceleration = np.linalg.norm(np.diff(spin, axis=0), axis=-1).max(0) * RATE_HZ
    moved = np.linalg.norm(np.diff(placed.joints_m, axis=0), axis=-1).max(1) * RATE_HZ
    return Measured(
        slide_mm=1000 * max(_slide(subject, placed, side, feet[:, number]) for number, side in enumerate(SIDES)),
        sunk_mm=1000 * sunk,
        floating_mm=1000 * floating,
        off_parabola_mm=1000 * off,
        take_off_error_m_s=jump,
        pull=float(-borne[:, 2].min()),
        push=float(borne[:, 2].max()),
        shove=float(np.linalg.norm(borne[:, :2], axis=1).max()),
        beyond_limit_deg=float(excess.max()),
        beyond_limit_joint=smpl.NAMES[int(excess.argmax())],
        speed_rad_s=float(speed.max()),
        speed_joint=smpl.NAMES[int(speed.argmax())],
        acceleration_rad_s2=float(acceleration.max()),
        acceleration_joint=smpl.NAMES[int(acceleration.argmax())],
        from_stand_deg=_from_stand(motion.pose(0), subject),
        to_stand_deg=_from_stand(motion.pose(len(motion.translations_m) - 1), subject),
        start_speed_m_s=float(moved[0]),
        end_speed_m_s=float(moved[-1]),
    )


def in_air(motion: Motion) -> Bool:
    """(T,) nothing bears."""
    return np.asarray(~np.any(motion.contacts, axis=1))


def intervals(flags: Bool) -> list[tuple[int, int]]:
    """First and one-past-last of every run of true flags."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flags.astype(np.int8), [0]))))
    return [(int(first), int(last)) for first, last in zip(edges[::2], edges[1::2], strict=True)]


def _slide(subject: Subject, placed: Placed, side: str, stands: Bool) -> float:
    """The ball of a foot stays while its heel is up, its heel while the toes are up, both while it is flat."""
    ankle, toes = (smpl.INDEX[f"{side}_{name}"] for name in ("ankle", "foot"))
    skin = subject.body.model.skin
    mine = np.isin(skin.joints[np.arange(len(skin.joints)), skin.weights.argmax(1)], (ankle, toes))
    points = subject.body.rest_vertices_m[mine]
    lever = points[points[:, 0].argmin()] - subject.body.rest_joints_m[ankle]
    heel = placed.joints_m[:, ankle] + rotations.through(placed.turns[:, ankle], lever)
    pitch = np.abs(placed.turns[:, ankle, 2, 0])
    worst = 0.0
    for first, last in intervals(stands):
        flat = first + int(pitch[first:last].argmin())
        moved = [np.linalg.norm((point[first:last] - point[flat])[:, :2], axis=1) for point in (placed.joints_m[:, toes], heel)]
        worst = max(worst, float(np.minimum(*moved).max()))
    return worst


def _skin(motion: Motion, subject: Subject, every: int) -> tuple[float, float]:
    body, skin = subject.body, subject.body.model.skin
    carrier = skin.joints[np.arange(len(skin.joints)), skin.weights.argmax(1)]
    feet = [np.isin(carrier, [smpl.INDEX[f"{side}_{name}"] for name in ("ankle", "foot")]) for side in SIDES]
    sunk = floating = 0.0
    for number in range(0, len(motion.translations_m), every):
        heights = body.vertices_m(motion.pose(number))[:, 2]
        sunk = max(sunk, float(-heights.min()))
        for side, mine in enumerate(feet):
            if motion.contacts[number, side]:
                floating = max(floating, float(heights[mine].min()))
    return sunk, floating


def _flights(centre: Float, in_air: Bool) -> tuple[float, float]:
    """Off the parabola, and the velocity's jump at the take-off."""
    worst = jump = 0.0
    for first, last in intervals(in_air):
        if last - first < 4:
            continue
        after = np.arange(last - first) / RATE_HZ
        fallen = centre[first:last] + np.outer(after**2, (0.0, 0.0, GRAVITY_M_S2 / 2))
        design = np.stack((np.ones(len(after)), after), axis=1)
        fit, *_ = np.linalg.lstsq(design, fallen, rcond=None)
        worst = max(worst, float(np.linalg.norm(fallen - design @ fit, axis=1).max()))
        if first >= 2:
            before = (centre[first - 1] - centre[first - 2]) * RATE_HZ
            jump = max(jump, float(np.linalg.norm(before - fit[1])))
    return worst, jump


def _from_stand(pose: Pose, subject: Subject) -> float:
    """Degrees of the joint that is furthest from standing, and of the pelvis without its yaw."""
    wanted = rotations.matrices(stand(subject).rotations_rad)
    there = rotations.matrices(pose.rotations_rad)
    yaw = np.arctan2(there[0, 1, 0], there[0, 0, 0])
    there[0] = rotations.about(2, np.asarray(-yaw)) @ there[0]
    turned = np.linalg.norm(rotations.vectors(wanted.swapaxes(-1, -2) @ there), axis=-1)
    return float(np.degrees(turned.max()))


def assert_lawful(motion: Motion, subject: Subject, every: int = 4, sinks_mm: float = 3.0) -> None:
    """The bounds that hold for every action. Beyond the joints' limits by 2 degrees is what linear skinning does not show."""
    found = measured(motion, subject, every)
    assert found.slide_mm <= 2.0, found
    assert found.sunk_mm <= sinks_mm, found
    assert found.floating_mm <= 5.0, found
    assert found.off_parabola_mm <= 5.0, found
    assert found.take_off_error_m_s <= 0.25, found
    assert found.push <= 8.0, found
    assert found.shove <= 8.0, found
    assert found.beyond_limit_deg <= 2.0, found
    assert found.speed_rad_s <= 80.0, found
    assert found.acceleration_rad_s2 <= 20_000.0, found
    assert max(found.from_stand_deg, found.to_stand_deg) <= 0.05, found
    assert max(found.start_speed_m_s, found.end_speed_m_s) <= 0.01, found
    assert motion.contacts.shape[1] == len(CONTACTS)
    for attempt in motion.attempts:
        assert attempt.end_s <= motion.duration_s
