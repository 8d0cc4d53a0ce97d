import signal

import pytest

from models.messages.trouble import TroubleCode
from services.supervisor.child import ChildSpec
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
