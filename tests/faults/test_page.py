"""What a teacher sees in Chromium while a part of the real box is dead: grey, and colour again once it is back."""

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser.conftest import browser as browser  # noqa: PLC0414 - a fixture
from tests.faults.box import ISOLATED
from tests.faults.drills import DRILLS, RECOVERS_WITHIN_S, VICTIM, Stage
from tests.faults.page_watch import PageWatch
from tests.faults.test_drills import staged
from tests.integration.waiting import until

pytestmark = [pytest.mark.faults, pytest.mark.slow, pytest.mark.timeout(600)]

GREY_WITHIN_S = 1.2
"""Half a second, and what a browser without a graphics card is late on a busy machine."""
IS_LIVE = """() => { const d = document.querySelector('.page')?.dataset;
    return d && d.phase === 'live' && Number(d.coloured) > 0; }"""
RECORD = """() => { window.seen = [];
    const look = () => { const d = document.querySelector('.page').dataset;
        const last = window.seen.at(-1);
        const now = `${d.phase}|${Number(d.coloured) > 0}`;
        if (now !== last) window.seen.push(now); };
    new MutationObserver(look).observe(document.querySelector('.page'), { attributes: true, subtree: true, childList: true });
    look(); }"""


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    with staged(tmp_path_factory.mktemp("box"), ISOLATED, disk=False) as made:
        yield made


@pytest.fixture
def watch(browser: Browser, stage: Stage) -> Iterator[PageWatch]:
    """The page is open and shows the figure."""
    made = PageWatch(new_page(browser))
    made.page.goto(stage.box.page)
    made.page.wait_for_function(IS_LIVE)
    stage.settle()
    yield made
    made.page.close()


@pytest.fixture
def page(watch: PageWatch) -> Page:
    return watch.page


def new_page(browser: Browser) -> Page:
    page = browser.new_page(viewport={"width": 800, "height": 500})
    page.set_default_timeout(RECOVERS_WITHIN_S * 1e3)
    return page


def test_the_figure_is_grey_while_fusion_and_its_spare_are_dead_and_coloured_once_it_is_back(page: Page, stage: Stage) -> None:
    page.evaluate(RECORD)
    children = stage.box.children()
    for name in ("fusion-spare", "fusion"):
        os.kill(children[name].pid, signal.SIGKILL)
    page.wait_for_function("() => window.seen.some((state) => state.endsWith('false'))")
    page.wait_for_function("() => window.seen.at(-1) === 'live|true'")


@pytest.mark.parametrize("drill", ["kill-fusion", "stop-fusion", "kill-tablet", "stop-tablet"])
def test_no_figure_stands_still_in_colour(drill: str, page: Page, watch: PageWatch, stage: Stage) -> None:
    watch.begin()
    outcome = DRILLS[drill](stage)
    assert watch.still_s < GREY_WITHIN_S
    assert watch.away_s > 0.1 or outcome.pause_s < GREY_WITHIN_S
    page.wait_for_function(IS_LIVE)


def test_a_camera_whose_process_is_dead_is_shown_as_lost_and_the_figure_stays(page: Page, stage: Stage) -> None:
    page.evaluate(RECORD)
    fault_s = time.monotonic()
    os.kill(stage.box.child(f"edge-{VICTIM}").pid, signal.SIGKILL)
    page.wait_for_function(f"() => document.querySelector('[data-camera={VICTIM}]')?.dataset.state === 'lost'")
    stage.client.wait_figure(fault_s)
    page.wait_for_function(f"() => ['ok', 'slow'].includes(document.querySelector('[data-camera={VICTIM}]')?.dataset.state)")


def test_a_storm_of_crashes_is_told_to_the_teacher_with_what_to_do(browser: Browser, tmp_path: Path) -> None:
    with staged(tmp_path, "[supervisor]\nmax_restarts = 1\nwindow_s = 600\n", disk=False) as stage:
        page = new_page(browser)
        page.goto(stage.box.page)
        page.wait_for_function(IS_LIVE)
        name = f"edge-{VICTIM}"
        first = stage.box.child(name).pid
        os.kill(first, signal.SIGKILL)
        until(lambda: stage.box.child(name).pid != first, "the one restart that is allowed")
        os.kill(stage.box.child(name).pid, signal.SIGKILL)
        expect(page.locator(f"[data-camera={VICTIM}]")).to_contain_text("until it is started anew")
        page.wait_for_function(IS_LIVE)  # the other three go on
        page.close()
