"""What is asked of the box is shown as a wish until the box has done it, and said if it does not."""

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser.attempts import tried
from tests.browser.room import Room, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, see
from tests.browser.test_page import AXE, open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

STOP_CLOCK = """() => {
    const [real, stoppedMs] = [performance.now.bind(performance), performance.now()];
    window.passedMs = 0;
    performance.now = () => stoppedMs + window.passedMs;
    window.startClock = () => (performance.now = real);
}"""
"""A wish has some seconds, which a busy machine may need to show it at all: here they pass when the test says so."""
TOO_LATE = "window.passedMs = 5000"


def test_a_choice_that_the_box_takes_late_is_a_wish_and_said_until_then(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    with_scene(room, evaluating=None)
    expect(tablet.locator("[data-judging=off]")).to_be_visible()
    activity, pupil = tablet.locator(".activity"), tablet.locator(".pupil")
    tablet.evaluate(STOP_CLOCK)
    activity.click()
    tablet.locator("[data-choose=squat]").click()
    expect(activity).to_have_attribute("data-wish", "pending")
    expect(activity).to_have_attribute("data-activity", "squat")
    pupil.locator(".who").click()
    tablet.get_by_role("dialog").locator("[data-code='7']").click()
    expect(pupil).to_have_attribute("data-wish", "pending")
    expect(pupil).to_have_attribute("data-pupil", "7")
    tablet.evaluate(TOO_LATE)
    for control in (activity, pupil):
        expect(control).to_have_attribute("data-wish", "overdue")
    expect(activity).to_have_attribute("data-activity", "any")
    expect(pupil).to_have_attribute("data-pupil", "")
    for what in ("Squat", "Pupil 7"):
        expect(tablet.get_by_text(f"{what}: the box has not taken it yet")).to_be_visible()
    tablet.evaluate(AXE.read_text(encoding="utf-8"))
    found = tablet.evaluate("axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']})")
    assert [(violation["id"], [node["html"] for node in violation["nodes"]]) for violation in found["violations"]] == []
    with_scene(room, evaluating="waiting")
    expect(activity).to_have_attribute("data-activity", "squat")
    expect(pupil).to_have_attribute("data-pupil", "7")
    for control in (activity, pupil):
        expect(control).to_have_attribute("data-wish", "settled")
    expect(tablet.get_by_text("the box has not taken it yet")).to_have_count(0)


def test_what_is_asked_while_the_connection_goes_is_not_shown_as_done(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.locator(".feedback .who").click()
    room.stop_server()
    shown.wait_for_phase("offline")
    tablet.evaluate(STOP_CLOCK)
    tablet.get_by_role("dialog").locator("[data-code='6']").click()
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "6")
    expect(tablet.locator(".feedback .who")).to_have_class(re.compile("pending"))
    tablet.evaluate(TOO_LATE)
    expect(tablet.get_by_text("Attempt 1, Pupil 6: the box has not taken it yet")).to_be_visible()
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "")
    tablet.evaluate("window.startClock()")
    room.start_server()
    shown.wait_for_phase("live")
    assert room.corrections() == []


def test_a_list_that_does_not_begin_anew_is_not_silent_about_it(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    room.attempt(tried(SHOT))
    tablet.locator(".anew").click()
    tablet.evaluate("WebSocket.prototype.send = () => {}")  # The connection is lost, and nobody has noticed yet.
    tablet.evaluate(STOP_CLOCK)
    tablet.get_by_role("dialog").get_by_role("button", name="Begin anew").click()
    expect(tablet.locator(".anew")).to_have_attribute("aria-busy", "true")
    tablet.evaluate(TOO_LATE)
    expect(tablet.get_by_text("Begin anew: the box has not taken it yet")).to_be_visible()
    expect(tablet.locator("li [data-attempt]")).to_have_count(1)
