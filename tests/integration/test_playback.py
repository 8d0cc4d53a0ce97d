"""The replay process on the bus in memory: the lesson's figure, moved to now, and what its cameras said, and nothing else."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import structlog.testing

from models.config.site import SITE_VERSION, CameraConfig, Site
from models.errors import UserError
from models.messages import codec, topics
from models.messages.attempts import AttemptsBegin
from models.messages.feedback import ActivityRequest
from models.messages.health import Health
from models.messages.motion import Motion
from models.messages.pupil import PupilTurn
from models.process import Playback, ProcessContext, Resources, Subscription
from services.bus.memory import MemoryBus, MemoryRouter
from services.fusion.config import PRESETS
from services.lesson import playback
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import Lesson, LessonPart, open_lesson
from services.lesson.playback import LONGEST_PAUSE_NS, Pace, moved
from services.lesson.replay import difference, replay
from tests.integration.waiting import DEADLINE_S, until
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.gym_lesson import TITLE, gym_header, write_gym_lesson

S = 1_000_000_000
GYM = Gym(seconds=3.0, seed=5)


def test_an_instant_is_due_when_the_speed_says() -> None:
    pace = Pace(speed=2.0, from_ns=100 * S, at_ns=7 * S)
    assert pace.due_ns(100 * S, 7 * S) == 7 * S
    assert pace.due_ns(104 * S, 8 * S) == 9 * S


def test_a_long_pause_of_the_lesson_is_cut_short_and_the_pace_goes_on_from_there() -> None:
    pace = Pace(speed=1.0, from_ns=0, at_ns=50 * S)
    assert pace.due_ns(600 * S, 51 * S) == 51 * S + LONGEST_PAUSE_NS
    assert pace.due_ns(601 * S, 54 * S) == 55 * S


def test_who_is_late_does_not_hurry_after_the_lesson() -> None:
    pace = Pace(speed=1.0, from_ns=0, at_ns=50 * S)
    first = pace.due_ns(1 * S, 80 * S)
    assert first <= 80 * S
    assert pace.due_ns(2 * S, 80 * S) == first + S


@pytest.fixture(scope="module")
def lesson(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_gym_lesson(tmp_path_factory.mktemp("lesson"), GYM)


class Played:
    """Everything that a replay publishes."""

    def __init__(self, router: MemoryRouter) -> None:
        self._router = router
        self._bus = router.open()
        self._evaluation: MemoryBus | None = None
        self._motions: Subscription = self._bus.subscribe(topics.motion("live"), topics.motion("smooth"), keep=10_000)
        self._healths: Subscription = self._bus.subscribe(topics.ALL_HEALTH, keep=10_000)
        self._wishes: Subscription = self._bus.subscribe(topics.activity_request(), keep=10_000)
        self._turns: Subscription = self._bus.subscribe(topics.pupil_turn(), keep=10_000)
        self._begins: Subscription = self._bus.subscribe(topics.attempts_begin(), keep=10_000)
        self.asked: list[str] = []
        self.begun: list[AttemptsBegin] = []
        self.called: list[PupilTurn] = []
        self.live: list[Motion] = []
        self.smooth: list[Motion] = []
        self.healths: list[Health] = []

    def collect(self) -> "Played":
        while (delivery := self._motions.receive(0.0)) is not None:
            motion = codec.decode(delivery.payload, Motion)
            (self.live if motion.kind == "live" else self.smooth).append(motion)
        while (delivery := self._wishes.receive(0.0)) is not None:
            self.asked.append(codec.decode(delivery.payload, ActivityRequest).activity)
        while (delivery := self._turns.receive(0.0)) is not None:
            self.called.append(codec.decode(delivery.payload, PupilTurn))
        while (delivery := self._begins.receive(0.0)) is not None:
            self.begun.append(codec.decode(delivery.payload, AttemptsBegin))
        while (delivery := self._healths.receive(0.0)) is not None:
            self.healths.append(codec.decode(delivery.payload, Health))
        return self

    def evaluation_comes(self) -> None:
        """As when its process joins the bus, or is started again."""
        if self._evaluation is not None:
            self._evaluation.close()
        self._evaluation = self._router.open()
        self._evaluation.declare_alive(topics.alive("evaluation"))


@contextmanager
def playing(
    file: Path, *, loop: bool, speed: float = 8.0, beat: Callable[[], None] = lambda: None, evaluated: bool = True
) -> Iterator[tuple[Played, threading.Thread]]:
    """The replay of a lesson, and of what the bus has from it; `evaluated`: the evaluation is there before it."""
    router, stop = MemoryRouter(), threading.Event()
    cameras = [CameraConfig(name=name, kind="video", path="none.avi") for name in GYM.rig.names]
    context = ProcessContext(
        name="replay",
        camera=None,
        site=Site(version=SITE_VERSION, name="test", calibration="rig.toml", cameras=cameras),
        rig=GYM.rig,
        data=file.parent,
        start_ns=time.monotonic_ns(),
        bus=router.open(),
        stop=stop,
        resources=lambda: Resources(0.1, 100.0),
        playback=Playback(str(file), TITLE, 0, speed, loop),
        beat=beat,
    )
    played = Played(router)
    if evaluated:
        played.evaluation_comes()
    thread = threading.Thread(target=playback.main, args=(context,), daemon=True)
    thread.start()
    try:
        yield played, thread
    finally:
        stop.set()
        thread.join(DEADLINE_S)
        assert not thread.is_alive(), "the replay did not honour stop"


@pytest.mark.slow
def test_the_figure_of_the_lesson_is_published_with_its_times_moved_and_nothing_else_changed(lesson: Path) -> None:
    before_ns = time.monotonic_ns()
    with playing(lesson, loop=False) as (played, thread):
        thread.join(DEADLINE_S)
        assert not thread.is_alive(), "a lesson that is played once comes to its end"
        played.collect()
    with open_lesson(lesson) as opened:
        recorded = [m for item in replay(opened.parts(), GYM.rig, PRESETS["default"]) for m in item.motions]
    for kind, published in (("live", played.live), ("smooth", played.smooth)):
        expected = [motion for motion in recorded if motion.kind == kind]
        assert len(published) == len(expected) > 60
        for motion, original in zip(published, expected, strict=True):
            assert motion.t_ns - motion.t_newest_ns == original.t_ns - original.t_newest_ns
            assert difference(moved(original, motion.t_ns - original.t_ns, 0), motion) == ""
            assert motion.t_ns > before_ns - S, "shown as of now, not as of the lesson's day"
            assert motion.t_published_ns >= motion.t_newest_ns


@pytest.mark.slow
def test_a_lesson_is_read_through_once_before_it_is_played(lesson: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[Path] = []
    parts = Lesson.parts

    def counted(opened: Lesson) -> Iterator[LessonPart]:
        read.append(opened.path)
        return parts(opened)

    monkeypatch.setattr(Lesson, "parts", counted)
    with playing(lesson, loop=False) as (_, thread):
        thread.join(DEADLINE_S)
    assert read == [lesson, lesson], "once before, and once as it is played"


@pytest.mark.slow
def test_cameras_and_fusion_say_again_what_they_said_and_others_of_that_day_do_not(lesson: Path) -> None:
    with playing(lesson, loop=True, speed=1.0) as (played, _):
        names = {"replay", "fusion", *(f"edge-{name}" for name in GYM.rig.names)}
        until(lambda: {health.process for health in played.collect().healths} >= names, "everybody's word")
        until(lambda: any(h.replay is not None and h.replay.position_s > 0 for h in played.collect().healths), "a position")
    assert {health.process for health in played.healths} == names
    told = [health.replay for health in played.healths if health.replay is not None]
    assert all(0 <= replay.position_s <= replay.length_s + 0.1 for replay in told)
    assert all(replay.length_s == pytest.approx(3.0, abs=0.2) for replay in told)


@pytest.mark.slow
def test_the_lesson_waits_for_the_evaluation_so_that_an_attempt_with_which_it_begins_is_not_missed(lesson: Path) -> None:
    with playing(lesson, loop=False, evaluated=False) as (played, thread):
        until(lambda: any(h.replay is not None for h in played.collect().healths), "a word of the replay")
        assert (played.begun, played.live, played.smooth) == ([], [], [])
        assert {health.replay.position_s for health in played.healths if health.replay is not None} == {0.0}
        played.evaluation_comes()
        thread.join(DEADLINE_S)
    assert len(played.collect().begun) == 1
    with open_lesson(lesson) as opened:
        recorded = (m for item in replay(opened.parts(), GYM.rig, PRESETS["default"]) for m in item.motions if m.kind == "smooth")
        assert played.smooth[0].sequence == next(recorded).sequence


@pytest.mark.slow
def test_a_lesson_is_played_without_an_evaluation_that_does_not_come(lesson: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(playback, "EVALUATION_WITHIN_NS", S // 5)
    with structlog.testing.capture_logs() as logged, playing(lesson, loop=False, evaluated=False) as (played, thread):
        thread.join(DEADLINE_S)
    assert len(played.collect().smooth) > 60
    assert [line["event"] for line in logged] == ["the evaluation is not there: attempts at the lesson's beginning are missed"]


@pytest.mark.slow
def test_the_evaluation_is_told_what_pupils_were_to_do_once_and_again_when_it_comes_later(lesson: Path) -> None:
    with playing(lesson, loop=False, speed=1.0) as (played, thread):
        until(lambda: played.collect().asked == ["long_jump"], "what pupils were to do")
        played.evaluation_comes()
        until(lambda: played.collect().asked == ["long_jump", "long_jump"], "the same for who came later")
        thread.join(DEADLINE_S)
    assert played.collect().asked == ["long_jump", "long_jump"], "between two changes whoever watches may choose otherwise"


@pytest.fixture(scope="module")
def lesson_of_pupils(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """7 was up before it began, 8 from 1.2 s on."""
    turns = (PupilTurn("7", T0_NS - 50 * S), PupilTurn("8", T0_NS + 12 * S // 10))
    return write_gym_lesson(tmp_path_factory.mktemp("lesson"), GYM, turns=turns)


@pytest.mark.slow
@pytest.mark.parametrize("speed", [1.0, 2.0])
def test_the_evaluation_is_told_who_was_up_as_of_the_instant_that_is_shown(lesson_of_pupils: Path, speed: float) -> None:
    began_ns = time.monotonic_ns()
    with playing(lesson_of_pupils, loop=False, speed=speed) as (played, thread):
        thread.join(DEADLINE_S)
        played.collect()
    nobody, first, second = dict.fromkeys(played.called)
    assert [turn.pupil for turn in (nobody, first, second)] == ["", "7", "8"]
    assert began_ns <= nobody.t_ns < first.t_ns < second.t_ns
    shown = min(played.smooth, key=lambda motion: abs(motion.t_ns - second.t_ns))
    assert (shown.sequence - played.smooth[0].sequence) / 30 == pytest.approx(1.2, abs=0.15)
    assert first.t_ns == nobody.t_ns + 1, "he was up long before, and of two turns the later one counts"


@pytest.mark.slow
def test_an_evaluation_that_comes_later_is_told_who_was_up_with_the_same_moment(lesson_of_pupils: Path) -> None:
    with playing(lesson_of_pupils, loop=False, speed=1.0) as (played, thread):
        until(lambda: [turn.pupil for turn in played.collect().called][-1:] == ["8"], "who was up")
        said = played.called[-1]
        played.evaluation_comes()
        until(lambda: played.collect().called.count(said) == 2, "the same for who came later")
        thread.join(DEADLINE_S)


@pytest.mark.slow
def test_at_the_beginning_of_the_next_round_nobody_is_up_who_was_at_the_end(lesson_of_pupils: Path) -> None:
    with playing(lesson_of_pupils, loop=True) as (played, _):
        until(
            lambda: [turn.pupil for turn in dict.fromkeys(played.collect().called)][:6] == ["", "7", "8"] * 2,
            "the turns of two rounds",
        )
    times = [turn.t_ns for turn in dict.fromkeys(played.called)]
    assert times == sorted(times), "of two turns the later one counts"


@pytest.mark.slow
def test_a_loop_begins_again_with_the_same_figure(lesson: Path) -> None:
    with playing(lesson, loop=True) as (played, _):
        until(lambda: sum(motion.sequence == 5 for motion in played.collect().smooth) >= 2, "the lesson's second time")
    first, second = [motion for motion in played.smooth if motion.sequence == 5][:2]
    assert second.t_ns > first.t_ns
    assert difference(moved(first, second.t_ns - first.t_ns, 0), second) == ""


@pytest.mark.slow
def test_in_each_round_attempts_are_numbered_from_one_as_in_the_report(lesson: Path) -> None:
    with playing(lesson, loop=True) as (played, _):
        until(lambda: sum(motion.sequence == 5 for motion in played.collect().smooth) >= 2, "the lesson's second time")
    first, second = [motion for motion in played.smooth if motion.sequence == 5][:2]
    begin, again = played.begun[:2]
    assert begin.t_ns < first.t_published_ns < again.t_ns < second.t_published_ns
    assert (begin.count, again.count) == (0, 0)


@pytest.mark.slow
def test_a_lesson_without_an_entry_is_no_reason_to_spin_or_to_fall_silent(tmp_path: Path) -> None:
    empty = LessonWriter.create(tmp_path, "empty", gym_header(GYM)).finish()
    beats = 0

    def beat() -> None:
        nonlocal beats
        beats += 1

    with playing(empty, loop=True, beat=beat) as (played, _):
        until(lambda: len([health for health in played.collect().healths if health.replay is not None]) >= 2, "two words of it")
        began_s, before = time.monotonic(), beats
        until(lambda: beats > before + 3, "further beats")
        assert beats - before <= 2 + (time.monotonic() - began_s) / 0.05, "each round waits"


def test_without_a_lesson_the_process_says_how_it_is_started(tmp_path: Path) -> None:
    context = ProcessContext(
        name="replay",
        camera=None,
        site=Site(version=SITE_VERSION, name="t", calibration="r", cameras=[]),
        rig=GYM.rig,
        data=tmp_path,
        start_ns=0,
        bus=MemoryRouter().open(),
        stop=threading.Event(),
        resources=lambda: Resources(0.0, 0.0),
    )
    with pytest.raises(UserError, match="start it with 'kinebox replay LESSON'"):
        playback.main(context)
