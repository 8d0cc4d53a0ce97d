"""Where nothing is corrected the page says what that means, and approves of nothing that it does not know."""

import msgspec
import pytest
from playwright.sync_api import Page, expect

from models.messages.feedback import Feedback
from tests.browser.attempts import tried, unseen
from tests.browser.room import Room
from tests.browser.shown_attempts import FAULT, SHOT
from tests.browser.test_page import open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

FINE, UNSURE = "No correction this time", "Nothing clear to correct this time"
UNSEEN, REST = "Not seen well enough to judge", "The rest was not seen well enough"
WORDLESS = "There is something to correct, but the words for it are not here yet"


def made_poor(feedback: Feedback) -> Feedback:
    """The same attempt with a number that is poor, and which no fault is about."""
    one, *others = feedback.measures
    return msgspec.structs.replace(feedback, measures=(msgspec.structs.replace(one, verdict="poor"), *others), fine=False)


def test_silence_says_what_it_means(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    good = tried(SHOT)
    assert (good.silence, good.praise != "") == ("fine", True)
    cases = (
        (good, FINE, "fine"),
        (made_poor(good), UNSURE, "unsure"),
        (unseen(good), UNSEEN, "unseen"),
        (msgspec.structs.replace(unseen(good), praise=good.praise), REST, "unseen"),
        (tried(SHOT, FAULT), "", ""),
    )
    silence = tablet.locator("[data-silence]")
    for made, said, meaning in cases:
        number = room.attempt(made)
        expect(tablet.locator("[data-shown]")).to_have_attribute("data-shown", str(number))
        expect(silence).to_have_count(1 if said else 0)
        if said:
            expect(silence).to_have_text(said)
            expect(silence).to_have_attribute("data-silence", meaning)
        expect(tablet.locator("[data-praise]")).to_have_count(1 if made.praise else 0)


def test_a_cue_without_words_says_so_until_they_arrive(tablet: Page, room: Room) -> None:
    """Once it was taken for "No correction this time"; then there was a score without any reason."""
    tablet.route("**/api/teaching", lambda route: route.fulfill(status=503, body=""))
    open_live(tablet, room)
    number = room.attempt(tried(SHOT, FAULT))
    expect(tablet.locator("[data-shown]")).to_have_attribute("data-shown", str(number))
    expect(tablet.locator("[data-score]")).to_be_visible()
    expect(tablet.locator("[data-wordless]")).to_have_text(WORDLESS)
    expect(tablet.locator("[data-silence], [data-praise]")).to_have_count(0)
    tablet.unroute("**/api/teaching")
    expect(tablet.locator("[data-cue]")).to_be_visible()
    expect(tablet.locator("[data-wordless]")).to_have_count(0)
