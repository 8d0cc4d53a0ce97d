"""The whole way, once: ten attempts rendered, looked at by the networks of four cameras, fused, judged, and read off the page.

Every action is tried once, five times with a fault, by a pupil on whom nothing was tuned (`kinebox simulate ten_attempts`). The
browser draws on the cores of the box, which therefore looks less often than in a gym.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import pytest
from playwright.sync_api import Page

from edge.simulation.command import find_plan
from edge.simulation.lesson.attempts import read_attempts
from edge.simulation.lesson.files import ATTEMPTS_NAME
from edge.simulation.rendering.render_lesson import folder_of, render_lesson
from models.messages.feedback import Colour
from models.motions.motion import Attempt
from tests.browser.conftest import LIVE_PICTURE_MS, Tablets
from tests.browser.shown_attempts import levels, like
from tests.browser.test_page import Shown
from tests.installed import DATA, require_graphics
from tests.system.test_box import running
from tests.taught import shipped

pytestmark = [pytest.mark.browser, pytest.mark.slow, pytest.mark.rendering, pytest.mark.timeout(3600)]

_PLAN = "ten_attempts"
_COLOURED = "() => document.querySelector('.page').dataset.levels.split(',').slice(1).reduce((sum, n) => sum + Number(n), 0) > 8"
"""More than half of the joints that the replay shows are green, yellow or red, and not grey."""
_ROUND_MS, _DRAWN_MS = 120_000, 5_000
_RIGHT = 9
"""Of ten cues or silences. How often they are right is measured elsewhere (`make bench-keyframes`); this pupil runs with such long
steps of his own that he is told so in most rounds.
"""


@dataclass(frozen=True)
class Seen:
    """What the page showed of an attempt.

    Attributes:
        action: as its title.
        cue: the fault that is to be corrected; empty for silence.
        judged: joints that are green, yellow or red in the replay.
        green: pixels of that colour.
    """

    action: str
    cue: str
    judged: int
    green: int


@pytest.fixture(scope="module")
def lesson() -> Path:
    """The rendered lesson; some ten minutes on two idle cores unless it was rendered before."""
    require_graphics()
    plan = find_plan(_PLAN)
    folder = folder_of(plan, DATA)
    render_lesson(plan, folder, lambda *_: None)
    return folder


def _replays(page: Page) -> Iterator[Seen]:
    """Every attempt, as its replay begins by itself."""
    shown, before = Shown(page), ""
    while True:
        page.wait_for_function(
            "before => { const d = document.querySelector('.page').dataset; return d.stage === 'replay' && d.attempt !== before; }",
            arg=before,
            timeout=_ROUND_MS,
        )
        before = page.locator(".page").get_attribute("data-attempt") or ""
        page.locator(f"[data-shown='{before}']").wait_for()
        # The slow page names the attempt before it has drawn the first picture of its replay.
        page.wait_for_function(_COLOURED, timeout=_DRAWN_MS)
        cue = page.locator("[data-cue]")
        title = page.locator("[data-shown] .what span").inner_text()
        _, *judged = levels(shown)
        yield Seen(title, (cue.get_attribute("data-cue") or "") if cue.count() else "", sum(judged), like(shown, Colour.GREEN))


def test_ten_attempts_are_seen_with_their_cues_their_replays_and_their_colours(
    tablets: Tablets, lesson: Path, tmp_path: Path
) -> None:
    true = read_attempts(lesson / ATTEMPTS_NAME)["pupil"]
    with running(tmp_path, lesson) as box:
        page = tablets(1280, 800, LIVE_PICTURE_MS)
        page.goto(f"http://127.0.0.1:{box.port}/")
        page.locator(".page[data-phase=live]").wait_for(timeout=_ROUND_MS)
        replays = _replays(page)
        # The first round begins while the networks are still being loaded.
        next(one for one in replays if one.action == _title(true[-1]))
        seen = list(islice(replays, len(true)))
    assert [one.action for one in seen] == [_title(attempt) for attempt in true]
    right = [one.cue == "".join(name for name, _ in attempt.faults) for one, attempt in zip(seen, true, strict=True)]
    assert sum(right) >= _RIGHT, [(one.action, one.cue) for one in seen]
    assert [one for one in seen if one.judged <= 8 or one.green <= 100] == []


def _title(attempt: Attempt) -> str:
    return shipped().teachings[attempt.action].title.en
