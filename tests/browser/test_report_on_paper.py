"""A report in Chromium, as it is printed: it fits A4, asks nobody for anything, and is read without colour."""

import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from models.arrays import Float
from models.messages.feedback import Colour
from models.teaching.schema import Language
from services.evaluation.report import page as report_page
from tests.browser.test_page import AXE
from tests.reported import attempt, sheet

pytestmark = [pytest.mark.browser, pytest.mark.slow]

PAPER_MM = 297.0 - 11.0 - 12.0
"""Between the margins."""
MM = 96 / 25.4
WORDY: dict[str, Any] = {"cue_certainty": 0.9, "cue": "no_knee_bend", "praise": "elbow_out"}


@pytest.fixture
def paper(browser: Browser) -> Iterator[Page]:
    # Only so that axe may look; what the policy forbids is told in the console nevertheless.
    context = browser.new_context(viewport={"width": 794, "height": 1123}, bypass_csp=True)
    page = context.new_page()
    page.emulate_media(media="print")
    yield page
    context.close()


def written(folder: Path, language: Language = "en") -> Path:
    """Two sheets: one of a pupil with a code, one of nobody's attempts."""
    judged = attempt().colours
    coloured = judged.copy()
    coloured[:] = np.resize([Colour.GREEN, Colour.YELLOW, Colour.RED, Colour.GREY], judged.shape[1])
    attempts = (
        attempt(**WORDY, score=61.0, score_sigma=4.0, colours=coloured),
        attempt("squat", hidden=("left_wrist",), guessed=("left_knee",), score=None, score_sigma=None),
        attempt("long_jump"),
        (attempt("badminton_clear", handed="left"), "P07"),
        (attempt("forward_roll"), "P07"),
    )
    file = folder / "report.html"
    file.write_bytes(report_page.encode(sheet(*attempts, language=language)))
    return file


@pytest.mark.parametrize("language", ["en", "zh", "de", "es"])
def test_nothing_is_wider_than_the_paper_and_two_attempts_fit_on_one(paper: Page, tmp_path: Path, language: Language) -> None:
    paper.goto(written(tmp_path, language).as_uri())
    assert paper.evaluate("document.documentElement.scrollWidth <= innerWidth")
    heights_mm = paper.evaluate("[...document.querySelectorAll('article')].map(one => one.getBoundingClientRect().height)")
    assert len(heights_mm) == 5
    assert max(heights_mm) / MM < PAPER_MM / 2 - 4
    beyond = paper.evaluate("""[...document.querySelectorAll('body *')].filter(one => {
        const box = one.getBoundingClientRect(), body = document.body.getBoundingClientRect();
        return box.width > 0 && (box.left < body.left - 2 || box.right > body.right + 2);
    }).map(one => one.outerHTML.slice(0, 120))""")
    assert beyond == []


def test_each_pupils_sheet_begins_on_paper_of_its_own(paper: Page, tmp_path: Path) -> None:
    paper.goto(written(tmp_path).as_uri())
    pdf = paper.pdf(prefer_css_page_size=True, print_background=True)
    # The summary and one attempt, then two; for nobody's attempts the summary and one, then two.
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 4


def test_a_printed_attempt_is_small_however_much_of_it_is_dotted_and_striped(paper: Page, tmp_path: Path) -> None:
    paper.goto(written(tmp_path).as_uri())
    pdf = paper.pdf(prefer_css_page_size=True, print_background=True)
    assert len(pdf) < 5 * 100_000


def test_it_asks_nobody_for_anything_and_breaks_no_policy(browser: Browser, tmp_path: Path) -> None:
    page = browser.new_page()
    asked: list[str] = []
    said: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("console", lambda message: said.append(message.text))
    address = written(tmp_path).as_uri()
    page.goto(address)
    page.close()
    assert asked == [address]
    assert said == []


def shot(page: Page, place: int) -> Float:
    """A swatch of the legend, grey, 0 to 1."""
    picture = page.locator("article").first.locator(".legend svg").nth(place).screenshot()
    decoded = cv2.imdecode(np.frombuffer(picture, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert decoded is not None
    height, width = decoded.shape
    return np.asarray(decoded[height // 4 : -height // 4, width // 3 : -width // 3] / 255.0)


def test_without_colour_every_judgement_looks_different(browser: Browser, tmp_path: Path) -> None:
    page = browser.new_page(device_scale_factor=4)
    page.goto(written(tmp_path).as_uri())
    good, near, off, unsure, model = (shot(page, place) for place in range(5))
    page.close()
    means = [one.mean() for one in (unsure, good, near, off)]
    assert all(lighter > darker + 0.02 for lighter, darker in pairwise(means))
    plain, patterned = max(good.std(), unsure.std(), model.std()), min(near.std(), off.std())
    assert plain < 0.02
    assert patterned > 0.1
    assert abs(model.mean() - good.mean()) > 0.1


def test_it_is_accessible(paper: Page, tmp_path: Path) -> None:
    paper.goto(written(tmp_path).as_uri())
    paper.evaluate(AXE.read_text(encoding="utf-8"))
    found = paper.evaluate("axe.run().then(found => found.violations.map(one => [one.id, one.nodes[0].html]))")
    assert found == []
