"""What the tablet server keeps of attempts, and what it does about a choice of the teacher's."""

import json

import msgspec
import pytest

from models.messages.attempts import AttemptsBegin
from models.messages.feedback import ActivityRequest
from models.messages.health import EvaluationHealth, Health, RecorderHealth
from models.messages.pupil import PupilCorrection, PupilCorrections, PupilTurn
from services.tablet import attempt_replay
from services.tablet.attempts import KEPT, Attempts, shown_of
from services.tablet.messages import CLIENT_MESSAGE, ActionWords, Anew, Choose, Correction, Teaching, Turn
from services.tablet.room_state import RoomState
from services.tablet.server import TabletServer, Told
from tests.mutations.samples import RIG, feedback

T0 = 10**12
SECOND_NS = 10**9
NO_TURN = PupilTurn("", 0)
TEACHING = Teaching(languages=["en"], actions={"long_jump": ActionWords(title={"en": "Long jump"}, faults={}, measures={})})


class Box:
    """A server at a time that the test sets, and what it asked of the evaluation."""

    def __init__(self) -> None:
        self.now_ns = T0
        self.asked: list[str] = []
        self.called: list[PupilTurn] = []
        self.corrected: list[PupilCorrections] = []
        self.begun: list[AttemptsBegin] = []
        self.shown: list[str] = []
        room = RoomState("gym", RIG.names, 30.0, T0)
        self.server = TabletServer(room, lambda: self.now_ns, TEACHING, self._hear)
        self.server.show_status = lambda: self.shown.append("status")  # type: ignore[method-assign]

    def _hear(self, told: Told) -> None:
        match told:
            case ActivityRequest(activity=activity):
                self.asked.append(activity)
            case PupilTurn():
                self.called.append(told)
            case PupilCorrections():
                self.corrected.append(told)
            case AttemptsBegin():
                self.begun.append(told)

    def hear(
        self, activity: str, state: str = "waiting", process: str = "evaluation", *, by: str = "tablet", turn: PupilTurn = NO_TURN
    ) -> None:
        evaluation = EvaluationHealth(activity, by, state, 1, 0.2, 30.0, 0, 0, turn.pupil, turn.t_ns)  # type: ignore[arg-type]
        self.server.receive_health(Health(process, 1, self.now_ns, "ok", (), 0.1, 100.0, evaluation=evaluation))

    def record(self, lesson: str, gaps: int) -> None:
        recorder = RecorderHealth(lesson, "7b", 60.0, 10**6, gaps)
        self.server.receive_health(Health("recorder", 1, self.now_ns, "ok", (), 0.1, 60.0, recorder=recorder))


@pytest.fixture
def box() -> Box:
    return Box()


def test_the_page_is_told_what_is_shown_of_an_attempt_and_null_where_nothing_is_known() -> None:
    told = feedback(T0)
    said = json.loads(shown_of(told).model_dump_json())
    assert said["number"] is None
    assert (said["action"], said["by"], said["handed"]) == ("basketball_shot", "recognised", "right")
    assert said["ended_ms"] == told.keyframes_ns[-1] // 10**6
    assert said["duration_s"] == pytest.approx(0.3, abs=1e-3)
    assert (said["cue"], said["praise"]) == ("no_knee_bend", "elbow_out")
    assert [measure["name"] for measure in said["measures"]] == ["knee_flexion", "balance"]
    knee, balance = said["measures"]
    assert (knee["value"], knee["sigma"], knee["verdict"], knee["low"], knee["high"]) == (25.0, 4.0, "poor", 60.0, None)
    assert (balance["value"], balance["sigma"], balance["verdict"]) == (None, None, "unknown")


def test_silence_is_no_cue_and_no_certainty() -> None:
    said = shown_of(msgspec.structs.replace(feedback(T0), cue="", cue_certainty=0.0, praise="", score=None, score_sigma=None))
    assert (said.cue, said.cue_certainty, said.praise, said.score, said.silence) == (None, None, None, None, "unseen")
    assert shown_of(feedback(T0)).silence is None


def test_an_attempt_that_comes_twice_is_kept_and_shown_once() -> None:
    attempts = Attempts()
    assert attempts.take(feedback(T0))
    assert not attempts.take(feedback(T0))
    assert len(attempts.shown) == 1


def test_the_oldest_attempt_goes_when_there_are_too_many_and_its_replay_with_it() -> None:
    attempts = Attempts()
    for number in range(KEPT + 3):
        attempts.take(feedback(T0 + number * SECOND_NS))
    ids = [attempt.id for attempt in attempts.shown]
    assert ids == sorted(ids)
    assert len(ids) == KEPT
    assert attempts.replay(feedback(T0).id) is None
    newest = feedback(T0 + (KEPT + 2) * SECOND_NS)
    replay = attempts.replay(newest.id)
    assert replay is not None
    assert len(attempt_replay.unpack(replay).states) == 10


@pytest.mark.parametrize(("activity", "asked"), [("long_jump", "long_jump"), (None, "")])
def test_a_choice_is_taken_to_the_evaluation(box: Box, activity: str | None, asked: str) -> None:
    box.server.choose(activity)
    assert box.asked == [asked]
    ActivityRequest(box.asked[0])


def test_an_action_that_there_is_not_cannot_be_chosen(box: Box) -> None:
    box.server.choose("pole_vault")
    assert box.asked == []
    assert box.server.status().rejected_client_messages == 1


@pytest.mark.parametrize(
    "text",
    [
        '{"type":"choose"}',
        '{"type":"choose","activity":""}',
        '{"type":"choose","activity":"Long jump"}',
        '{"type":"choose","activity":3}',
    ],
)
def test_a_choice_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="activity"):
        CLIENT_MESSAGE.validate_json(text)


def test_a_choice_is_read() -> None:
    assert CLIENT_MESSAGE.validate_json('{"type":"choose","activity":null}') == Choose(type="choose", activity=None)


def test_an_evaluation_that_was_started_again_is_told_the_choice_anew(box: Box) -> None:
    box.server._soon = object()  # type: ignore[assignment]  # no loop here tells of presence
    box.server.set_alive("evaluation", True)
    assert box.asked == []
    box.server.choose("long_jump")
    box.server.set_alive("evaluation", False)
    box.server.set_alive("evaluation", True)
    assert box.asked == ["long_jump", "long_jump"]


def test_a_server_that_was_started_again_takes_over_the_choice_and_tells_it_the_next_evaluation(box: Box) -> None:
    box.hear("long_jump")
    assert box.asked == []
    box.hear("", by="site")
    assert box.asked == ["long_jump"]


def test_what_the_site_says_is_no_choice_that_another_evaluation_is_told(box: Box) -> None:
    box.hear("long_jump", by="site")
    box.hear("", by="site")
    assert box.asked == []
    assert box.server.status().evaluation.activity_chosen_by == "site"


def test_a_choice_that_the_evaluation_has_not_heard_yet_is_not_undone_by_its_old_word(box: Box) -> None:
    box.hear("")
    box.server.choose("long_jump")
    box.now_ns += SECOND_NS // 2
    box.hear("")  # was under way
    box.hear("", by="site")  # and was killed before it heard
    assert box.asked == ["long_jump"] * 2
    box.now_ns += SECOND_NS
    box.hear("")
    box.hear("", by="site")
    assert box.asked == ["long_jump", "long_jump", ""], "it is lost, and every page has shown so"


def test_the_list_begins_anew_when_a_tablet_says_so(box: Box) -> None:
    box.hear("")
    box.record("", 0)
    box.server.receive_feedback(feedback(T0))
    assert box.server.listed is not None
    assert [attempt.number for attempt in box.server.listed.attempts] == [1]
    box.now_ns += SECOND_NS
    box.server.wish(Anew(type="anew"))
    assert box.server.listed.attempts == []
    assert box.begun[-1] == AttemptsBegin(T0 + SECOND_NS)


def test_the_list_of_a_lesson_that_is_recorded_does_not_begin_anew_by_a_touch(box: Box) -> None:
    box.hear("")
    box.record("2026-11-22-7b", 0)
    box.server.receive_feedback(feedback(T0))
    box.server.wish(Anew(type="anew"))
    box.now_ns += 10 * SECOND_NS  # The recorder is not heard any more, and may go on all the same.
    box.server.wish(Anew(type="anew"))
    assert len(box.server.attempts.shown) == 1
    assert box.server.status().rejected_client_messages == 2
    box.record("", 0)
    box.server.wish(Anew(type="anew"))
    assert box.server.attempts.shown == []


def test_the_list_does_not_begin_anew_before_the_recorder_was_heard(box: Box) -> None:
    box.server.receive_feedback(feedback(T0))
    box.server.wish(Anew(type="anew"))
    assert len(box.server.attempts.shown) == 1
    assert box.server.status().rejected_client_messages == 1


def test_the_list_is_sent_only_when_it_is_another_one(box: Box) -> None:
    shown: list[str] = []
    box.server.audience.show_attempts = lambda text: shown.append(text)  # type: ignore[method-assign]  # noqa: PLW0108
    box.server.receive_feedback(feedback(T0))
    assert shown == [], "what the evaluation remembers may come first"
    for _ in range(3):
        box.hear("")
        box.record("", 0)
        box.server.receive_feedback(feedback(T0))
    assert [len(json.loads(text)["attempts"]) for text in shown] == [1]
    assert json.loads(shown[0])["type"] == "attempts"


def test_what_was_chosen_is_shown_as_soon_as_the_evaluation_says_so(box: Box) -> None:
    box.hear("", by="site")
    assert box.server.status().evaluation.activity is None
    assert box.server.status().evaluation.activity_chosen_by == "site"
    before = len(box.shown)
    box.hear("long_jump")
    assert len(box.shown) == before + 1
    assert box.server.status().evaluation.activity == "long_jump"
    box.hear("long_jump", "moving")
    assert len(box.shown) == before + 1
    assert box.server.status().evaluation.state == "moving"


def test_an_evaluation_that_is_silent_says_nothing_of_the_pupil_and_the_choice_stays(box: Box) -> None:
    assert box.server.status().evaluation.state == "starting"
    assert box.server.status().evaluation.activity_chosen_by is None
    box.hear("long_jump", "moving")
    box.now_ns += 10 * SECOND_NS
    assert box.server.status().evaluation.state == "unknown"
    assert box.server.status().evaluation.activity == "long_jump"


def test_no_other_process_speaks_for_the_evaluation(box: Box) -> None:
    box.hear("long_jump", "moving", process="fusion")
    assert box.server.status().evaluation.activity is None
    assert box.server.status().evaluation.state == "starting"


def test_who_is_called_is_told_to_the_evaluation_with_the_moment(box: Box) -> None:
    box.server.wish(Turn(type="turn", pupil="B12"))
    box.now_ns += 5
    box.server.wish(Turn(type="turn", pupil=None))
    assert box.called == [PupilTurn("B12", T0), PupilTurn("", T0 + 5)]


@pytest.mark.parametrize(
    "text",
    [
        '{"type":"turn"}',
        '{"type":"turn","pupil":""}',
        '{"type":"turn","pupil":"Anna"}',
        '{"type":"turn","pupil":"ANNA"}',
        '{"type":"turn","pupil":"b12"}',
        '{"type":"turn","pupil":"-7"}',
        '{"type":"turn","pupil":"123456789"}',
        '{"type":"turn","pupil":"7\\n"}',
        '{"type":"turn","pupil":7}',
        '{"type":"correction","attempt":1}',
        '{"type":"correction","attempt":1,"pupil":"Anna"}',
    ],
)
def test_what_is_no_code_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="pupil"):
        CLIENT_MESSAGE.validate_json(text)


def test_a_turn_and_a_correction_are_read() -> None:
    assert CLIENT_MESSAGE.validate_json('{"type":"turn","pupil":"B12"}') == Turn(type="turn", pupil="B12")
    said = CLIENT_MESSAGE.validate_json('{"type":"correction","attempt":5,"pupil":null}')
    assert said == Correction(type="correction", attempt=5, pupil=None)


def test_who_is_up_is_shown_only_as_the_evaluation_says_it_and_then_at_once(box: Box) -> None:
    box.hear("", by="site")
    box.server.call("7")
    assert box.server.status().evaluation.pupil is None
    before = len(box.shown)
    box.hear("", by="site", turn=box.called[-1])
    assert len(box.shown) == before + 1
    assert box.server.status().evaluation.pupil == "7"
    box.hear("", by="site", turn=box.called[-1])
    assert len(box.shown) == before + 1
    assert len(box.called) == 1


def test_an_evaluation_that_was_started_again_is_told_who_is_up_and_since_when(box: Box) -> None:
    box.server.call("7")
    box.now_ns += 60 * SECOND_NS
    box.hear("")
    assert box.called == [PupilTurn("7", T0)] * 2


def test_a_server_that_was_started_again_takes_over_who_is_up_and_tells_it_the_next_evaluation(box: Box) -> None:
    box.hear("", turn=PupilTurn("7", T0 - 30 * SECOND_NS))
    assert box.called == []
    assert box.server.status().evaluation.pupil == "7"
    box.hear("")
    assert box.called == [PupilTurn("7", T0 - 30 * SECOND_NS)]


def test_where_nobody_remembers_nobody_is_up(box: Box) -> None:
    box.hear("")
    assert box.called == []
    assert box.server.status().evaluation.pupil is None


def test_a_turn_of_the_future_is_not_believed(box: Box) -> None:
    box.server.call("7")
    box.hear("", turn=PupilTurn("8", T0 + SECOND_NS))
    box.hear("")
    assert box.called == [PupilTurn("7", T0)] * 2


def test_an_attempt_is_listed_with_its_pupil_or_with_none() -> None:
    attempts = Attempts()
    attempts.take(msgspec.structs.replace(feedback(T0), pupil="B12"))
    attempts.take(feedback(T0 + SECOND_NS))
    assert [attempt.pupil for attempt in attempts.shown] == ["B12", None]


def test_whose_an_attempt_was_is_corrected_for_all_and_told_for_the_lesson(box: Box) -> None:
    box.hear("")
    shown: list[str] = []
    box.server.audience.show_attempts = lambda text: shown.append(text)  # type: ignore[method-assign]  # noqa: PLW0108
    first, second = feedback(T0), feedback(T0 + SECOND_NS)
    for told in (first, second):
        box.server.receive_feedback(msgspec.structs.replace(told, pupil="7"))
    replay = box.server.attempts.replay(first.id)
    box.server.wish(Correction(type="correction", attempt=first.id, pupil="8"))
    box.server.wish(Correction(type="correction", attempt=second.id, pupil=None))
    assert [attempt.pupil for attempt in box.server.attempts.shown] == ["8", None]
    told_pupils = [[attempt["pupil"] for attempt in json.loads(text)["attempts"]] for text in shown]
    assert told_pupils == [["7"], ["7", "7"], ["8", "7"], ["8", None]]
    assert box.server.attempts.replay(first.id) == replay
    assert box.corrected[-1].corrections == (PupilCorrection(first.id, "8"), PupilCorrection(second.id, ""))


def test_whoever_gives_an_attempt_to_the_pupil_that_it_has_is_told_that_it_is_so(box: Box) -> None:
    box.hear("")
    told = msgspec.structs.replace(feedback(T0), pupil="7")
    box.server.receive_feedback(told)
    shown: list[str] = []
    box.server.audience.show_attempts = lambda text: shown.append(text)  # type: ignore[method-assign]  # noqa: PLW0108
    box.server.wish(Correction(type="correction", attempt=told.id, pupil="7"))
    assert [[attempt["pupil"] for attempt in json.loads(text)["attempts"]] for text in shown] == [["7"]]


def test_an_attempt_that_comes_again_does_not_undo_its_correction(box: Box) -> None:
    told = msgspec.structs.replace(feedback(T0), pupil="7")
    box.server.receive_feedback(told)
    box.server.correct(told.id, "8")
    box.server.receive_feedback(told)
    assert [attempt.pupil for attempt in box.server.attempts.shown] == ["8"]


def test_an_attempt_that_is_not_kept_is_not_corrected(box: Box) -> None:
    box.server.correct(1, "8")
    assert box.corrected == []
    assert box.server.status().rejected_client_messages == 1


def test_of_attempts_that_are_gone_no_correction_is_told_any_more() -> None:
    attempts = Attempts()
    for number in range(KEPT):
        attempts.take(feedback(T0 + number * SECOND_NS))
        attempts.correct(PupilCorrection(feedback(T0 + number * SECOND_NS).id, "7"))
    attempts.take(feedback(T0 + KEPT * SECOND_NS))
    assert len(attempts.corrections.corrections) == KEPT - 1
    assert feedback(T0).id not in {one.attempt for one in attempts.corrections.corrections}


def test_what_was_corrected_is_told_again_after_an_interruption_of_the_lesson(box: Box) -> None:
    box.server.receive_feedback(feedback(T0))
    box.record("2026-11-22-7b", 0)
    box.server.correct(feedback(T0).id, "8")
    box.record("2026-11-22-7b", 0)
    assert len(box.corrected) == 1
    box.record("2026-11-22-7b", 1)
    assert box.corrected == [box.corrected[0]] * 2
    box.record("2026-11-22-7b", 1)
    box.record("another", 2)
    assert len(box.corrected) == 2


def test_an_evaluation_that_is_heard_again_is_told_what_was_corrected_meanwhile(box: Box) -> None:
    box.server._soon = object()  # type: ignore[assignment]  # no loop here tells of presence
    box.server.receive_feedback(feedback(T0))
    box.server.set_alive("evaluation", True)
    assert box.corrected == []
    box.server.set_alive("fusion", False)  # the router: nobody hears anybody
    box.server.set_alive("evaluation", False)
    box.server.correct(feedback(T0).id, "8")
    box.server.set_alive("fusion", True)
    box.server.set_alive("evaluation", True)
    assert box.corrected == [PupilCorrections((PupilCorrection(feedback(T0).id, "8"),))] * 2


def test_after_an_interruption_without_corrections_nothing_is_told(box: Box) -> None:
    box.record("2026-11-22-7b", 0)
    box.record("2026-11-22-7b", 1)
    assert box.corrected == []
