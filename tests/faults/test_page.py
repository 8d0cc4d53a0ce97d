"""What a teacher sees in Chromium while a part of the real box is dead: grey, and colour again once it is back."""

import os
import signal
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from tests.browser.conftest import browser as browser  # noqa: PLC0414 - a fixture
from tests.faults.box import ISOLATED
from tests.faults.drills import DRILLS, RECOVERS_WITHIN_S, VICTIM, Stage
from tests.faults.page_watch import PageWatch
from tests.faults.test_drills import staged

pytestmark = [pytest.mark.usefixtures("watch"), pytest.mark.faults, pytest.mark.slow, pytest.mark.timeout(600)]

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
def page(browser: Browser) -> Iterator[Page]:
    made = browser.new_page(viewport={"width": 800, "height": 500})
    made.set_default_timeout(RECOVERS_WITHIN_S * 1e3)
    yield made
    made.close()


@pytest.fixture
def watch(page: Page, stage: Stage) -> PageWatch:
    """The page is open and shows the figure."""
    made = PageWatch(page)
    page.goto(stage.box.page)
    page.wait_for_function(IS_LIVE)
    stage.settle()
    return made


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
