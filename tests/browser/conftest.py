"""Chromium, and a synthetic room for it to show.

The browser is Debian's or the one that `KINEBOX_CHROMIUM` names. Where there is none the tests are skipped aloud, and fail if
`CI` is set.
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
_GENEROUS_MS = 60_000


def _chromium() -> str:
    path = os.environ.get("KINEBOX_CHROMIUM") or shutil.which("chromium") or shutil.which("google-chrome")
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
    made = browser.new_page(viewport={"width": 800, "height": 500})
    made.set_default_timeout(_GENEROUS_MS)
    made.on("pageerror", lambda error: errors.append(str(error)))
    yield made
    made.close()
    assert errors == []
