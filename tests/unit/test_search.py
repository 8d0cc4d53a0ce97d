"""What somebody looks for in a file: found where only what leads to the peak is the standard's; nothing where nobody does it."""

import numpy as np
import pytest

from models.arrays import Float
from models.motions.between import Pass, Pastime, spend
from models.motions.motion import Handed
from models.motions.standpoint import Standpoint
from models.skeleton import coco
from models.teaching.standard import FRAME_S
from services.evaluation.normalise import mirrored
from services.evaluation.search import attempts_in, performances_like
from services.evaluation.track import known_track
from tests.demonstrations import shown
from tests.pupils import pupil
from tests.taught import placed, shipped

pytestmark = pytest.mark.slow

CLEAR = shipped().standards["badminton_clear"]
WAIT = 30
AFTER = 60


def hits_and_sits_down(handed: Handed = "right", times: int = 1) -> tuple[Float, list[float]]:
    """(T, 17, 3) of who hits as the standard does and then, at once, is deep in a squat, as often as asked; and when he hits."""
    squat = shipped().standards["squat"]
    low = squat.joints_m[round(squat.moments_s[2] / FRAME_S)]
    hit_s = CLEAR.moments_s[2]
    until = round((hit_s + 0.1) / FRAME_S)
    parts = [np.repeat(CLEAR.joints_m[:1], WAIT, axis=0), CLEAR.joints_m[: until + 1], np.repeat(low[None], AFTER, axis=0)]
    count = sum(map(len, parts))
    joints = placed(np.concatenate(parts * times), "right")
    return mirrored(joints) if handed == "left" else joints, [(number * count + WAIT) * FRAME_S + hit_s for number in range(times)]


@pytest.mark.parametrize("handed", ["right", "left"])
def test_who_hits_as_the_standard_and_ends_otherwise_is_found_by_a_search_and_not_live(handed: Handed) -> None:
    joints, peaks_s = hits_and_sits_down(handed, times=2)
    track = known_track(joints, FRAME_S, 0.008)
    assert attempts_in(track, CLEAR) == ()
    found = performances_like(track, CLEAR)
    assert [one.handed for one in found] == [handed] * 2
    assert [one.moment_s("peak") for one in found] == pytest.approx(peaks_s, abs=0.15)
    assert found[0].moments_s[-1] < found[1].moments_s[0]


@pytest.mark.parametrize("handed", ["right", "left"])
@pytest.mark.parametrize("action", ["badminton_clear", "volleyball_spike", "soccer_kick", "squat", "long_jump"])
def test_a_search_finds_what_the_box_finds(action: str, handed: Handed) -> None:
    track, true = shown(action, handed)
    standard = shipped().standards[action]
    (one,), (other,) = attempts_in(track, standard), performances_like(track, standard)
    assert (one.action, one.handed) == (other.action, other.handed)
    assert np.abs(np.array(other.moments_s) - true.moments_s).max() <= 0.1 + 1e-9


@pytest.mark.parametrize("pastime", ["wait", "scratch", "bend", "clap", "hands_on_hips"])
def test_who_only_passes_the_time_is_like_no_clear(pastime: Pastime) -> None:
    subject = pupil(12.0)
    motion = spend(Pass(pastime, 5.0, seed=3), subject, Standpoint())
    times_s = np.arange(0, motion.duration_s, FRAME_S)
    joints = np.stack([subject.body.coco_m(motion.pose_at(float(t_s)))[: coco.COUNT] for t_s in times_s])
    assert performances_like(known_track(joints, FRAME_S, 0.008), CLEAR) == ()


def test_the_search_goes_on_after_what_nobody_saw() -> None:
    joints, (peak_s,) = hits_and_sits_down()
    joints[: WAIT // 2] = np.nan
    (one,) = performances_like(known_track(joints, FRAME_S, 0.008), CLEAR)
    assert one.moment_s("peak") == pytest.approx(peak_s, abs=0.15)


def test_in_a_track_that_shows_nobody_nothing_is_found() -> None:
    assert performances_like(known_track(np.full((60, coco.COUNT, 3), np.nan), FRAME_S), CLEAR) == ()
