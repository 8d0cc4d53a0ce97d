"""A foot that is swung faster than anything foresaw is not lost for as long as the swing lasts."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import pytest

from models.arrays import Float
from models.messages.motion import JointState
from models.skeleton import coco
from services.fusion.config import FusionConfig
from tests.synthetic.gym import Gym
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT, after, errors_mm, play

pytestmark = pytest.mark.slow

ANKLE: Final = coco.INDEX["right_ankle"]
_EVERY_S: Final = 2.0
_BACK_S, _HIT_S, _DOWN_S = 0.8, 1.1, 1.5
"""Of each round: the leg begins to be drawn back, is highest behind, is down again; between the last two it is kicked through."""

_LOST_MM = 150.0


@dataclass(frozen=True)
class Kicker(Person):
    """Stands, and kicks with the right foot every two seconds: some 23 m/s at its fastest, as a grown-up who means it."""

    radius_m: float = 0.0
    throws: bool = False

    def joints(self, t_s: float) -> Float:
        """See `Person.joints`."""
        out = super().joints(0.0)
        hip, thigh_m, shank_m = out[coco.INDEX["right_hip"]], 0.245 * self.height_m, 0.245 * self.height_m
        forward = np.array((np.cos(np.pi / 2), np.sin(np.pi / 2), 0.0))
        u = t_s % _EVERY_S
        drawn = _step(u, _BACK_S, _HIT_S) * (1.0 - _step(u, _HIT_S - 0.02, _HIT_S + 0.12))
        through = _step(u, _HIT_S, _HIT_S + 0.16) * (1.0 - _step(u, _HIT_S + 0.16, _DOWN_S))
        thigh = -0.7 * drawn + 1.1 * through
        shank = thigh - 1.7 * drawn
        knee = hip + thigh_m * (np.sin(thigh) * forward - np.cos(thigh) * np.array((0.0, 0.0, 1.0)))
        out[coco.INDEX["right_knee"]] = knee
        out[ANKLE] = knee + shank_m * (np.sin(shank) * forward - np.cos(shank) * np.array((0.0, 0.0, 1.0)))
        return out


def _step(u: float, begin: float, end: float) -> float:
    """From 0 to 1, without a jerk."""
    share = min(max((u - begin) / (end - begin), 0.0), 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)


GYM = replace(Gym(pupil=Kicker(), seconds=9.0, rates_hz=(15.0,), noise_px=1.0, reported_px=1.0).quiet(), jitter=0.02)
NEVER = replace(DEFAULT, smoothing=replace(DEFAULT.smoothing, recapture_views=np.inf))


def _ankle_mm(config: FusionConfig, kind: str) -> Float:
    """Errors of the foot that kicks, from the second kick on, where it is said to be seen."""
    played = play(GYM.rig, GYM.events(), config)
    motions = after(played.smooth if kind == "smooth" else played.live, _EVERY_S)
    seen = np.array([motion.states[ANKLE] == JointState.SEEN for motion in motions])
    errors: Float = errors_mm(motions, GYM.truth)[seen, ANKLE]
    return errors


@pytest.mark.parametrize(("kind", "share", "lost"), [("smooth", 0.4, 0.02), ("live", 0.6, 0.04)])
def test_a_foot_that_kicks_is_not_lost_for_the_length_of_the_kick(kind: str, share: float, lost: float) -> None:
    never_mm, caught_mm = _ankle_mm(NEVER, kind), _ankle_mm(DEFAULT, kind)
    assert len(caught_mm) >= len(never_mm), "nor is it called unseen"
    assert caught_mm.mean() < share * never_mm.mean()
    assert (caught_mm > _LOST_MM).mean() < lost < (never_mm > _LOST_MM).mean()


def test_what_is_seen_where_it_is_expected_is_left_alone() -> None:
    gym = replace(GYM, pupil=Person(throws=False))
    always, never = (play(gym.rig, gym.events(), config).smooth for config in (DEFAULT, NEVER))
    moved_mm = [
        1e3 * np.linalg.norm(a.joints_m - b.joints_m, axis=1) for a, b in zip(after(always, 1.0), after(never, 1.0), strict=True)
    ]
    assert np.quantile(moved_mm, 0.99) < 3.0
