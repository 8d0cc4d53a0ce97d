"""What a teacher sees in Chromium while a part of the real box is dead: grey, and colour again once it is back."""

import os
import signal
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page

from tests.browser.conftest import browser as browser  # noqa: PLC0414 - a fixture
from tests.faults.box import ISOLATED
from tests.faults.drills import RECOVERS_WITHIN_S, VICTIM, Stage
from tests.faults.test_drills import staged

pytestmark = [pytest.mark.faults, pytest.mark.slow, pytest.mark.timeout(600)]

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
def page(browser: Browser, stage: Stage) -> Iterator[Page]:
    made = browser.new_page(viewport={"width": 800, "height": 500})
    made.set_default_timeout(RECOVERS_WITHIN_S * 1e3)
    made.goto(stage.box.page)
    made.wait_for_function("() => { const d = document.querySelector('.page')?.dataset; return d && Number(d.coloured) > 0; }")
    stage.settle()
    yield made
    made.close()


def test_the_figure_is_grey_while_fusion_is_dead_and_coloured_once_it_is_back(page: Page, stage: Stage) -> None:
    page.evaluate(RECORD)
    os.kill(stage.box.child("fusion").pid, signal.SIGKILL)
    page.wait_for_function("() => window.seen.some((state) => !state.startsWith('live') && state.endsWith('false'))")
    page.wait_for_function("() => window.seen.at(-1) === 'live|true'")


def test_a_camera_whose_process_is_dead_is_shown_as_lost_and_the_figure_stays(page: Page, stage: Stage) -> None:
    page.evaluate(RECORD)
    fault_s = time.monotonic()
    os.kill(stage.box.child(f"edge-{VICTIM}").pid, signal.SIGKILL)
    page.wait_for_function(f"() => document.querySelector('[data-camera={VICTIM}]')?.dataset.state === 'lost'")
    stage.client.wait_figure(fault_s)
    page.wait_for_function(f"() => ['ok', 'slow'].includes(document.querySelector('[data-camera={VICTIM}]')?.dataset.state)")
