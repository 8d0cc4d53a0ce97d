"""A replay is the lesson again, bit for bit, and whatever is not is named."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache

import msgspec
import numpy as np
import pytest

from models.errors import UserError
from models.messages import codec
from models.messages.lesson import Entry
from models.messages.motion import Motion
from services.fusion.config import PRESETS
from services.lesson.lesson_reader import LessonPart
from services.lesson.replay import Comparison, compare, configuration, difference, replay
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.lesson_log import entries, parts

GYM = Gym(seconds=2.0)
CONFIG = PRESETS["default"]


@cache
def log() -> tuple[Entry, ...]:
    return tuple(entries(GYM.events(), GYM.rig))


def lesson(*segments: tuple[Entry, ...]) -> Iterator[LessonPart]:
    """The parts of a lesson as its reader gives them."""
    for number, segment in enumerate(segments):
        for part in parts(segment, T0_NS + number):
            yield LessonPart(part.segment_ns, part.sequence, part.sequence == 0, "", part.entries)


def check(*segments: tuple[Entry, ...]) -> Comparison:
    return compare(replay(lesson(*segments), GYM.rig, CONFIG))


def motions() -> list[tuple[int, Motion]]:
    return [(i, codec.decode(entry.payload, Motion)) for i, entry in enumerate(log()) if entry.kind == "motion"]


def with_motion(number: int, change: Callable[[Motion], Motion]) -> tuple[Entry, ...]:
    """The log with one of its motions altered."""
    index, motion = motions()[number]
    changed = list(log())
    changed[index] = Entry("motion", changed[index].t_ns, codec.encode(change(motion)))
    return tuple(changed)


def test_a_replay_gives_every_motion_again_bit_for_bit() -> None:
    found = check(log())
    assert found.first is None
    assert found.compared == found.equal == len(motions()) > 30


def test_a_segment_begins_with_a_new_state_and_not_with_that_of_the_segment_before() -> None:
    found = check(log(), log())
    assert found.first is None
    assert (found.segments, found.equal) == (2, 2 * len(motions()))


def test_live_motions_come_out_too_and_are_those_of_the_lesson() -> None:
    live = [motion for item in replay(lesson(log()), GYM.rig, CONFIG) for motion in item.motions if motion.kind == "live"]
    again = [motion for item in replay(lesson(log()), GYM.rig, CONFIG) for motion in item.motions if motion.kind == "live"]
    assert len(live) > 30
    assert [difference(a, b) for a, b in zip(live, again, strict=True)] == [""] * len(live)


def last_bit(motion: Motion) -> Motion:
    joints = motion.joints_m.copy()
    joints[9, 2] = np.nextafter(joints[9, 2], np.float32(9))
    return msgspec.structs.replace(motion, joints_m=joints)


def uncertain(motion: Motion) -> Motion:
    return msgspec.structs.replace(motion, covariance_m2=motion.covariance_m2 * np.float32(1.5))


def unseen(motion: Motion) -> Motion:
    return msgspec.structs.replace(motion, views=motion.views ^ np.uint32(1), states=np.zeros(17, np.uint8))


def later(motion: Motion) -> Motion:
    return msgspec.structs.replace(motion, t_newest_ns=motion.t_newest_ns + 1)


def other_camera(motion: Motion) -> Motion:
    first, *rest = motion.cameras
    return msgspec.structs.replace(motion, cameras=(msgspec.structs.replace(first, used=not first.used), *rest))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (last_bit, "joints_m differs, joints by up to "),
        (uncertain, "covariance_m2 differs"),
        (unseen, "states, views differ"),
        (later, "t_newest_ns differs"),
        (other_camera, "cameras differs"),
    ],
)
def test_an_altered_motion_is_named_with_what_is_altered(change: Callable[[Motion], Motion], words: str) -> None:
    found = check(with_motion(25, change))
    assert found.first is not None
    assert found.first.what.startswith(words)
    _, altered = motions()[25]
    assert (found.first.segment, found.first.sequence, found.first.t_ns) == (0, altered.sequence, altered.t_ns)
    assert (found.compared, found.equal) == (len(motions()), len(motions()) - 1)


def test_when_a_motion_was_published_is_not_compared() -> None:
    found = check(with_motion(25, lambda motion: msgspec.structs.replace(motion, t_published_ns=motion.t_published_ns + 12345)))
    assert found.first is None


def test_the_sign_of_zero_differs_and_nan_equals_itself() -> None:
    _, motion = motions()[0]
    zero = msgspec.structs.replace(motion, joints_m=np.zeros((17, 3), np.float32))
    assert difference(zero, msgspec.structs.replace(zero, joints_m=-zero.joints_m)) != ""
    unknown_age = tuple(msgspec.structs.replace(use, age_ms=float("nan")) for use in motion.cameras)
    never = msgspec.structs.replace(motion, cameras=unknown_age)
    assert difference(never, msgspec.structs.replace(never, cameras=tuple(unknown_age))) == ""


def test_a_motion_that_is_missing_from_the_record_and_one_too_many_are_told() -> None:
    index, motion = motions()[20]
    without = log()[:index] + log()[index + 1 :]
    found = check(without)
    assert found.first is not None
    assert (found.first.sequence, found.first.what) == (motion.sequence, "it was not recorded")
    twice = log()[: index + 1] + log()[index:]
    found = check(twice)
    assert found.first is not None
    assert (found.first.sequence, found.first.what) == (motion.sequence, "it does not come out of the replay")


def test_an_observation_that_is_lost_from_the_log_shows() -> None:
    index = next(i for i, entry in enumerate(log()) if entry.kind == "observation" and i > 100)
    found = check(log()[:index] + log()[index + 1 :])
    assert found.first is not None
    assert "differ" in found.first.what


def test_another_preset_or_calibration_shows() -> None:
    for rig, config in ((GYM.rig, PRESETS["paper"]), (GYM.rig.with_shifts(np.full((4, 2), 1e-5)), CONFIG)):
        assert compare(replay(lesson(log()), rig, config)).first is not None


def test_a_log_that_lacks_a_part_is_not_replayed_as_if_nothing_were() -> None:
    with pytest.raises(UserError, match="part 2 of the lesson's segment 1 is missing"):
        compare(replay((part for part in lesson(log()) if part.sequence != 2), GYM.rig, CONFIG))
    with pytest.raises(UserError, match="part 0 of the lesson's segment 1 is missing"):
        compare(
            replay((replace(part, begins_segment=part.sequence == 1) for part in lesson(log()) if part.sequence), GYM.rig, CONFIG)
        )


def test_an_entry_of_another_wire_format_is_one_line() -> None:
    index = next(i for i, entry in enumerate(log()) if entry.kind == "observation")
    newer = Entry("observation", log()[index].t_ns, b"\x09" + log()[index].payload[1:])
    with pytest.raises(UserError, match="wire format version 9"):
        check((*log()[:index], newer, *log()[index + 1 :]))


def test_a_preset_that_is_not_known_is_one_line() -> None:
    with pytest.raises(UserError, match="preset 'next'"):
        configuration("next")


def test_a_lesson_without_anything_has_nothing_to_differ() -> None:
    assert compare(replay((), GYM.rig, CONFIG)) == Comparison(0, 0, 0, None)
