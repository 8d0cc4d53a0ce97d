"""Somebody speaks while the disk holds the recorder up, and nobody as soon as it does not."""

import threading
import time

from services.lesson.disk_wait import DiskWait
from tests.integration.waiting import until


def test_a_wait_is_told_again_and_again_and_no_more_once_it_is_over() -> None:
    told_s: list[float] = []
    with DiskWait(told_s.append, quiet_s=0.0) as disk:
        with disk.at_work():
            until(lambda: len(told_s) >= 3, "a word, three times")
        told = len(told_s)
        time.sleep(0.6)
        assert len(told_s) == told
    assert told_s == sorted(told_s)


def test_the_loop_goes_on_only_when_the_last_word_about_its_wait_is_said() -> None:
    speaking, said = threading.Event(), list[str]()

    def tell(_waited_s: float) -> None:
        speaking.set()
        time.sleep(0.2)
        said.append("it waits")

    with DiskWait(tell, quiet_s=0.0) as disk:
        with disk.at_work():
            assert speaking.wait(10.0)
        said.append("it goes on")
    assert said[-1] == "it goes on"


def test_short_waits_are_nobodys_matter_and_a_loop_that_never_comes_back_is_found_out() -> None:
    told_s: list[float] = []
    with DiskWait(told_s.append, quiet_s=60.0) as disk, disk.at_work():
        time.sleep(0.6)
    with DiskWait(told_s.append, quiet_s=0.0, longest_s=0.0) as disk, disk.at_work():
        time.sleep(0.6)
    assert told_s == []
