import signal

import pytest

from models.config.site import SupervisorConfig
from models.errors import USER_ERROR_CODE
from models.messages.trouble import Trouble, TroubleCode
from models.process import EVALUATION, REPLAY, ROUTER
from services.supervisor.child import ChildSpec
from services.supervisor.policy import LONGEST_WAIT_S
from services.supervisor.post import SETTLES_WITHIN_S, Post, describe_exit


def test_what_settles_by_itself_after_a_start_is_no_news() -> None:
    post = Post(ChildSpec("fusion"))
    assert not post.reports("degraded", (), 100.0)
    assert not post.reports("degraded", (), 100.0 + SETTLES_WITHIN_S - 0.1)
    assert not post.reports("ok", (), 100.0 + SETTLES_WITHIN_S)


def test_what_does_not_settle_is_told_once_and_so_is_its_end() -> None:
    post = Post(ChildSpec("fusion"))
    assert not post.reports("degraded", (), 100.0)
    later_s = 100.0 + SETTLES_WITHIN_S
    assert [post.reports(state, (), later_s) for state in ("degraded", "degraded", "ok", "ok")] == [True, False, True, False]


def test_another_trouble_is_told_though_the_state_stays_and_one_that_comes_and_goes_once() -> None:
    post = Post(ChildSpec("fusion"))
    assert not post.reports("degraded", ("camera_unheard",), 100.0)
    later_s = 100.0 + SETTLES_WITHIN_S
    said: list[tuple[TroubleCode, ...]] = [("camera_moved",), ("cameras_exchanged",), ("camera_moved",), (), ("cameras_exchanged",)]
    assert [post.reports("degraded", codes, later_s) for codes in said] == [True, True, False, False, False]
    assert post.reports("ok", (), later_s)
    assert post.reports("degraded", ("camera_moved",), later_s)
    assert post.reports("degraded", ("camera_moved", "camera_unheard"), later_s)


def test_a_process_that_compiles_when_it_starts_is_heard_and_not_yet_at_work() -> None:
    """A spare that is begun meanwhile would compile the same, beside it."""
    post = Post(ChildSpec("fusion"))
    for now_s in (100.0, 110.0):
        post.reports("starting", ("getting_ready",), now_s)
        assert (post.first_heard_s, post.works_since_s) == (100.0, None)
    post.reports("degraded", (), 120.0)
    post.reports("ok", (), 130.0)
    assert (post.first_heard_s, post.works_since_s) == (100.0, 120.0)
    post.ended(1, "", 140.0, SupervisorConfig())
    assert (post.first_heard_s, post.works_since_s) == (None, None)


def test_a_failure_is_told_at_once() -> None:
    assert Post(ChildSpec("fusion")).reports("failed", (), 100.0)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (0, "ended with exit code 0"),
        (3, "ended with exit code 3"),
        (-signal.SIGKILL, "was ended by SIGKILL"),
        # A real-time signal, which has no name.
        (-40, "was ended by signal 40"),
    ],
)
def test_every_end_of_a_process_can_be_told(code: int, words: str) -> None:
    assert describe_exit(code) == words


LINE = "camera 'a': film.avi is missing; run 'make footage'"
CONFIG = SupervisorConfig(max_restarts=3, window_s=60)


def refused(post: Post, times: int, now_s: float = 100.0) -> list[float]:
    """Let a process end with a line for people as soon as it is started, so many times; how long each restart was waited for."""
    waits_s: list[float] = []
    for _ in range(times):
        post.start_at_s = None  # It was started.
        post.ended(USER_ERROR_CODE, LINE, now_s, CONFIG)
        if post.start_at_s is None:
            break
        waits_s.append(post.start_at_s - now_s)
        now_s = post.start_at_s
    return waits_s


def at_work(entry: str, camera: str | None = None) -> Post:
    """A post whose process was at work in this run of the box."""
    post = Post(ChildSpec(entry, camera))
    post.reports("ok", (), 50.0)
    return post


def test_what_a_person_must_do_is_final_for_a_process_that_never_worked() -> None:
    post = Post(ChildSpec("edge", "a"))
    post.reports("starting", ("getting_ready",), 50.0)
    assert refused(post, 1) == []
    assert post.given_up == LINE
    assert post.absence == Trouble("given_up", LINE)
    assert post.trouble == "", "nobody shall read that it is started again"


def test_an_evaluation_that_cannot_read_what_is_taught_is_tried_again_though_it_never_worked() -> None:
    post = Post(ChildSpec(EVALUATION))
    post.reports("starting", ("getting_ready",), 50.0)
    assert refused(post, 20)[-1] == LONGEST_WAIT_S
    assert post.given_up == ""
    assert post.absence == Trouble("restarting", f"{LINE}; it is tried again")


@pytest.mark.parametrize("entry", ["tablet", "recorder"])
def test_a_process_that_died_before_it_worked_and_cannot_be_started_then_is_tried_again(entry: str) -> None:
    post = Post(ChildSpec(entry))
    post.ended(-signal.SIGKILL, "", 60.0, CONFIG)
    assert refused(post, 20)[-1] == LONGEST_WAIT_S
    assert post.given_up == ""


def test_a_process_that_worked_and_cannot_now_is_tried_again_less_and_less_often_and_never_given_up() -> None:
    post = at_work("edge", "a")
    waits_s = refused(post, 40)
    assert waits_s[:4] == [0.0, 0.25, 0.5, 1.0]
    assert waits_s[8:] == [LONGEST_WAIT_S] * 32
    assert post.given_up == ""
    assert post.restarts is not None
    assert post.restarts.count == 40


def test_while_a_process_waits_until_it_can_work_a_person_reads_what_to_do_in_its_place() -> None:
    post = at_work("edge", "a")
    refused(post, 1)
    assert post.trouble == f"edge-a said: {LINE}; it is tried again"
    assert post.absence == Trouble("restarting", f"{LINE}; it is tried again")
    assert post.restarts is not None
    assert post.restarts.reason == f"said: {LINE}"


def test_a_process_that_works_for_a_moment_between_its_refusals_is_not_tried_without_a_pause() -> None:
    post, now_s, waits_s = at_work("edge", "a"), 100.0, list[float]()
    for _ in range(30):
        waits_s += refused(post, 1, now_s)
        now_s += waits_s[-1] + 2.0
        post.reports("ok", (), now_s)
    assert waits_s[-1] == LONGEST_WAIT_S


def test_a_refusal_is_no_crash_and_counts_towards_no_limit_of_them() -> None:
    post = at_work("edge", "a")
    refused(post, 20)
    for _ in range(CONFIG.max_restarts):
        post.ended(-signal.SIGKILL, "", 200.0, CONFIG)
        assert post.given_up == ""
    post.ended(-signal.SIGKILL, "", 200.0, CONFIG)
    assert post.given_up.startswith("ended 4 times within 60 s")


def test_a_router_that_cannot_route_is_given_up_soon_since_without_it_nobody_is_heard_and_its_line_is_kept() -> None:
    post = at_work(ROUTER)
    assert len(refused(post, 20)) == CONFIG.max_restarts
    assert post.given_up == f"ended 4 times within 60 s; last, it said: {LINE}"


def test_a_lesson_that_cannot_be_played_on_ends_its_replay_at_once() -> None:
    post = at_work(REPLAY)
    assert refused(post, 1) == []
    assert post.given_up == LINE


def test_a_process_that_was_found_hung_has_said_nothing() -> None:
    post = at_work("edge", "a")
    post.hangs = True
    post.ended(USER_ERROR_CODE, LINE, 100.0, CONFIG)
    assert post.trouble == "edge-a hung and is started again"
    assert post.absence is None
