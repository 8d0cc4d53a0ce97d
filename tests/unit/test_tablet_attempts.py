"""What the tablet server keeps of attempts, and what it does about a choice of the teacher's."""

import json

import msgspec
import pytest

from models.messages.feedback import ActivityRequest
from models.messages.health import EvaluationHealth, Health
from services.tablet import attempt_replay
from services.tablet.attempts import KEPT, Attempts, shown_of
from services.tablet.messages import CLIENT_MESSAGE, ActionWords, Choose, Teaching
from services.tablet.room_state import RoomState
from services.tablet.server import TabletServer
from tests.mutations.samples import RIG, feedback

T0 = 10**12
SECOND_NS = 10**9
TEACHING = Teaching(languages=["en"], actions={"long_jump": ActionWords(title={"en": "Long jump"}, faults={}, measures={})})


class Box:
    """A server at a time that the test sets, and what it asked of the evaluation."""

    def __init__(self) -> None:
        self.now_ns = T0
        self.asked: list[str] = []
        self.shown: list[str] = []
        room = RoomState("gym", RIG.names, 30.0, T0)
        self.server = TabletServer(room, lambda: self.now_ns, TEACHING, lambda request: self.asked.append(request.activity))
        self.server.show_status = lambda: self.shown.append("status")  # type: ignore[method-assign]

    def hear(self, activity: str, state: str = "waiting", process: str = "evaluation", *, by: str = "tablet") -> None:
        evaluation = EvaluationHealth(activity, by, state, 1, 0.2, 30.0, 0, 0)  # type: ignore[arg-type]
        self.server.receive_health(Health(process, 1, self.now_ns, "ok", (), 0.1, 100.0, evaluation=evaluation))


@pytest.fixture
def box() -> Box:
    return Box()


def test_the_page_is_told_what_is_shown_of_an_attempt_and_null_where_nothing_is_known() -> None:
    told = feedback(T0)
    said = json.loads(shown_of(told).model_dump_json())
    assert said["type"] == "attempt"
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
    assert (said.cue, said.cue_certainty, said.praise, said.score) == (None, None, None, None)


def test_an_attempt_that_comes_twice_is_kept_and_shown_once() -> None:
    attempts = Attempts()
    assert attempts.take(feedback(T0)) is not None
    assert attempts.take(feedback(T0)) is None
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
    assert box.server.status().evaluation.state == "unknown"
    assert box.server.status().evaluation.activity_chosen_by is None
    box.hear("long_jump", "moving")
    box.now_ns += 10 * SECOND_NS
    assert box.server.status().evaluation.state == "unknown"
    assert box.server.status().evaluation.activity == "long_jump"


def test_no_other_process_speaks_for_the_evaluation(box: Box) -> None:
    box.hear("long_jump", "moving", process="fusion")
    assert box.server.status().evaluation.activity is None
    assert box.server.status().evaluation.state == "unknown"
