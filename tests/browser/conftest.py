"""Chromium, and a synthetic room for it to show.

The browser is Debian's or the one that `KINEBOX_CHROMIUM` names. Where there is none the tests are skipped aloud, and fail if
`CI` is set. Of Debian's two, the one that has no window of its own comes first: it draws the same pages for less CPU.
"""

import os
import shutil
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from services.tablet import process
from tests.browser.room import Room

_ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # WebGL in software: test machines have no GPU.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
_BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")
_GENEROUS_MS = 60_000
DRAWN = 0.5
"""Pixels that are drawn a pixel of the layout, each way: WebGL in software is slow."""
LIVE_PICTURE_MS, REPLAY_PICTURE_MS = 250, 33
"""What a screen refresh takes: each picture costs a core tens of milliseconds. A replay takes no step beyond 0.1 s at a time,
also on a busy machine."""
_SLOW_SCREEN = """
window.requestAnimationFrame = (draw) => setTimeout(() => draw(performance.now()), %d);
window.cancelAnimationFrame = (request) => clearTimeout(request);
"""


def _chromium() -> str:
    path = os.environ.get("KINEBOX_CHROMIUM") or next(filter(None, map(shutil.which, _BROWSERS)), None)
    if path is None:
        _missing("no Chromium: install it (Debian: apt-get install chromium) or name one in KINEBOX_CHROMIUM")
    return str(path)


def _missing(reason: str) -> None:
    if os.environ.get("CI"):
        pytest.fail(reason)
    pytest.skip(reason)


# Not for the session: while Playwright runs, this thread has an event loop that other tests would trip over.
@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if not (process.PAGE / "index.html").is_file():
        _missing("the page is not built: run 'make web'")
    path = _chromium()
    with sync_playwright() as playwright:
        launched = playwright.chromium.launch(executable_path=path, args=list(_ARGUMENTS))
        yield launched
        launched.close()


@pytest.fixture
def room() -> Iterator[Room]:
    with Room() as made:
        yield made


@pytest.fixture
def errors() -> list[str]:
    """What the page could not cope with; `page` checks at its end that there is nothing."""
    return []


@pytest.fixture
def page(browser: Browser, errors: list[str]) -> Iterator[Page]:
    """A small tablet: software WebGL is slow, and the layout is the same as on 1280x800."""
    yield from _watched(browser, 500, LIVE_PICTURE_MS, errors)


@pytest.fixture
def tablet(browser: Browser, errors: list[str]) -> Iterator[Page]:
    """Just large enough for a replay and the list of attempts beside it; of other screens there is a test."""
    yield from _watched(browser, 580, REPLAY_PICTURE_MS, errors)


def _watched(browser: Browser, height_px: int, picture_ms: int, errors: list[str]) -> Iterator[Page]:
    made = browser.new_page(viewport={"width": 800, "height": height_px}, device_scale_factor=DRAWN)
    made.add_init_script(_SLOW_SCREEN % picture_ms)
    made.set_default_timeout(_GENEROUS_MS)
    made.on("pageerror", lambda error: errors.append(str(error)))
    yield made
    made.close()
    assert errors == []
