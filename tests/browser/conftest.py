"""Chromium, and a synthetic room for it to show.

Where there is no browser the tests are skipped aloud, and fail if `CI` is set.
"""

import os
from collections.abc import Iterator
from typing import Any, NoReturn, Protocol

import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from services.tablet.page import PAGE
from tests.browser.room import Room
from tests.chromium import ARGUMENTS, NONE, chromium

_GENEROUS_MS = 60_000
DRAWN = 0.5
"""Pixels that are drawn a pixel of the layout, each way: WebGL in software is slow."""
LIVE_PICTURE_MS, REPLAY_PICTURE_MS = 250, 66
"""What a screen refresh takes: each picture costs a core tens of milliseconds. A replay takes no step beyond 0.1 s at a time,
also on a busy machine."""
_SLOW_SCREEN = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), %d);
window.cancelAnimationFrame = (request) => clearTimeout(request);
"""


def _missing(reason: str) -> NoReturn:
    if os.environ.get("CI"):
        pytest.fail(reason)
    pytest.skip(reason)


# Not for the session: while Playwright runs, this thread has an event loop that other tests would trip over.
@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if not (PAGE / "index.html").is_file():
        _missing("the page is not built: run 'make web'")
    path = chromium()
    if path is None:
        _missing(NONE)
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        yield launched
        launched.close()


@pytest.fixture
def room() -> Iterator[Room]:
    with Room() as made:
        yield made


@pytest.fixture
def errors() -> list[str]:
    """What pages could not cope with; at the end there must be nothing."""
    return []


expect.set_options(timeout=_GENEROUS_MS)


class Tablets(Protocol):
    """Opens a page as on another tablet; what Playwright's `new_page` takes says which."""

    def __call__(self, width: int, height: int, picture_ms: int = ..., **context: Any) -> Page: ...


@pytest.fixture
def tablets(browser: Browser, errors: list[str]) -> Iterator[Tablets]:
    """Pages of any screen, closed at the end; software WebGL is slow, and the layout is the same with fewer pixels."""
    opened: list[Page] = []

    def open_page(width: int, height: int, picture_ms: int = LIVE_PICTURE_MS, **context: Any) -> Page:
        made = browser.new_page(viewport={"width": width, "height": height}, device_scale_factor=DRAWN, **context)
        opened.append(made)
        made.add_init_script(_SLOW_SCREEN % picture_ms)
        made.set_default_timeout(_GENEROUS_MS)
        made.on("pageerror", lambda error: errors.append(str(error)))
        return made

    yield open_page
    for made in opened:
        made.close()
    assert errors == []


@pytest.fixture
def page(tablets: Tablets) -> Page:
    """A small tablet."""
    return tablets(800, 500)


@pytest.fixture
def tablet(tablets: Tablets) -> Page:
    """Just large enough for a replay and the list of attempts beside it; of other screens there is a test."""
    return tablets(800, 580, REPLAY_PICTURE_MS)
