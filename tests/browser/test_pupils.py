"""Pupils' codes on the page: who is up, the next one, and whose an attempt was after all."""

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.attempts import tried
from tests.browser.conftest import Tablets
from tests.browser.room import Room, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, see
from tests.browser.test_page import AXE, Shown, open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

NUMBERS = 36


def up(page: Page) -> Locator:
    """The control that says who is up."""
    return page.locator(".pupil")


def call(page: Page, code: str) -> None:
    """Choose who is up with one of the large keys; empty for nobody."""
    up(page).locator(".who").click()
    page.get_by_role("dialog").locator(f"[data-code='{code}']").click()
    expect(up(page)).to_have_attribute("data-pupil", code)


def until_told(page: Page, room: Room, code: str) -> None:
    """Wait for the evaluation to know."""
    for _ in range(300):
        if room.pupil == code:
            return
        page.wait_for_timeout(100)
    raise AssertionError(f"the evaluation thinks that '{room.pupil}' is up, not '{code}'")


def choose(page: Page, room: Room, action: str) -> None:
    """Choose what pupils do, and wait for the evaluation to know."""
    page.locator(".activity").click()
    page.locator(f"[data-choose={action}]").click()
    for _ in range(300):
        if room.activity == action:
            break
        page.wait_for_timeout(100)
    expect(page.locator(".activity")).to_have_attribute("data-wish", "settled")


def test_nobody_is_up_until_somebody_is_called_and_the_evaluation_is_told(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    expect(up(tablet)).to_contain_text("Nobody")
    expect(tablet.get_by_role("button", name="Next pupil")).to_be_disabled()
    up(tablet).locator(".who").click()
    keys = tablet.get_by_role("dialog").locator("[data-code]:not([data-code=''])")
    expect(keys).to_have_count(NUMBERS)
    for key in keys.all():
        box = key.bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 56, "large enough for a thumb in a gym"
    keys.nth(6).click()
    expect(up(tablet)).to_have_attribute("data-pupil", "7")
    until_told(tablet, room, "7")


def test_next_steps_on_with_one_touch(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    call(tablet, "7")
    for code in ("8", "9", "10"):
        tablet.get_by_role("button", name=f"Next: pupil {code}").click()
        until_told(tablet, room, code)
        expect(up(tablet)).to_contain_text(code)
    call(tablet, "")
    until_told(tablet, room, "")


def test_a_code_can_be_typed_and_a_name_is_refused_with_what_a_code_is(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    up(tablet).locator(".who").click()
    sheet = tablet.get_by_role("dialog")
    expect(sheet).to_contain_text("no names")
    field = sheet.get_by_label("Another code")
    for name in ("Anna", "Christopher", "Emma2", "-7", "7-2", "7 b"):
        field.fill(name)
        field.press("Enter")
        expect(sheet.get_by_role("alert")).to_contain_text("Not a code. A code is a number, also with a letter")
        expect(field).to_have_attribute("aria-invalid", "true")
    assert room.pupil == ""
    field.fill("b12")
    expect(sheet.get_by_role("alert")).to_be_empty()
    field.press("Enter")
    expect(sheet).to_be_hidden()
    expect(up(tablet)).to_have_attribute("data-pupil", "B12")
    until_told(tablet, room, "B12")


def test_every_tablet_shows_who_is_up_also_after_it_was_loaded_again(tablets: Tablets, tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    call(tablet, "7")
    other = tablets(800, 580)
    other.goto(room.page)
    expect(up(other)).to_have_attribute("data-pupil", "7", timeout=60_000)
    other.get_by_role("button", name="Next: pupil 8").click()
    expect(up(tablet)).to_have_attribute("data-pupil", "8")
    tablet.reload()
    expect(up(tablet)).to_have_attribute("data-pupil", "8")


def test_who_is_up_and_what_was_chosen_outlive_the_evaluation_and_the_pages_server(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    call(tablet, "7")
    choose(tablet, room, "squat")
    expect(tablet.locator(".activity")).to_have_attribute("data-preset", "false")
    with_scene(room, evaluating=None)
    expect(tablet.locator("[data-judging=off]")).to_be_visible()
    until_told(tablet, room, "")
    with_scene(room, evaluating="waiting")
    until_told(tablet, room, "7")
    room.stop_server()
    shown.wait_for_phase("offline")
    expect(up(tablet)).to_have_attribute("data-pupil", "unknown")
    room.start_server()
    shown.wait_for_phase("live")
    expect(up(tablet)).to_have_attribute("data-pupil", "7")
    assert room.pupil == "7"
    assert room.activity == "squat"
    expect(tablet.locator(".activity")).to_have_attribute("data-activity", "squat")
    expect(tablet.locator(".activity")).to_have_attribute("data-preset", "false")


def test_where_all_is_forgotten_nobody_is_shown_and_nothing_as_if_it_were_chosen(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    call(tablet, "7")
    activity = tablet.locator(".activity")
    expect(activity).to_have_attribute("data-preset", "true")
    choose(tablet, room, "squat")
    expect(activity).to_have_attribute("data-preset", "false")
    room.stop_server()
    with_scene(room, evaluating=None)
    until_told(tablet, room, "")
    with_scene(room, evaluating="waiting")
    room.start_server()
    shown.wait_for_phase("live")
    expect(up(tablet)).to_have_attribute("data-pupil", "")
    expect(up(tablet)).to_contain_text("Nobody")
    assert room.pupil == ""
    expect(activity).to_have_attribute("data-activity", "any")
    expect(activity).to_have_attribute("data-preset", "true")
    expect(activity).to_contain_text("Any")
    activity.click()
    expect(tablet.get_by_role("dialog").locator("[aria-pressed=true]")).to_have_count(0)


def test_an_attempt_shows_its_pupil_on_the_replay_in_the_list_and_beside_its_score(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    call(tablet, "7")
    until_told(tablet, room, "7")
    number = see(shown, room, tried(SHOT, FAULT))
    expect(tablet.locator(".title [data-pupil]")).to_have_text("Pupil 7")
    expect(tablet.locator(f"li [data-attempt='{number}']")).to_contain_text("pupil 7")
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "7")
    tablet.get_by_role("button", name="Next: pupil 8").click()
    until_told(tablet, room, "8")
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "7")


def test_whose_an_attempt_was_is_corrected_on_every_tablet_and_told_for_the_lesson(
    tablets: Tablets, tablet: Page, room: Room
) -> None:
    with_scene(room, recorded_s=60.0)
    shown = open_live(tablet, room)
    other = tablets(800, 580)
    open_live(other, room)
    call(tablet, "7")
    until_told(tablet, room, "7")
    first = see(shown, room, tried(SHOT, FAULT))
    second = see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.locator(f"li [data-attempt='{first}']").click()
    tablet.locator(".feedback .who").click()
    sheet = tablet.get_by_role("dialog")
    expect(sheet).to_contain_text("Whose was attempt 1?")
    expect(sheet.get_by_text("Nothing is being recorded")).to_have_count(0)
    expect(sheet.locator("[data-code='7']")).to_have_attribute("aria-pressed", "true")
    sheet.locator("[data-code='6']").click()
    for page in (tablet, other):
        expect(page.locator(f"li [data-attempt='{first}'] [data-pupil]")).to_have_attribute("data-pupil", "6")
        expect(page.locator(f"li [data-attempt='{second}'] [data-pupil]")).to_have_attribute("data-pupil", "7")
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "6")
    expect(up(tablet)).to_have_attribute("data-pupil", "7")
    (told,) = room.corrections()
    assert [(one.attempt, one.pupil) for one in told.corrections] == [(first, "6")]


def test_a_correction_that_nothing_records_says_so(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    expect(tablet.get_by_role("button", name="Begin anew")).to_be_visible()
    tablet.locator(".feedback .who").click()
    sheet = tablet.get_by_role("dialog")
    expect(sheet).to_contain_text("Nothing is being recorded")
    # It is gone, and may go on with a lesson when it is back.
    with_scene(room, recorder=False)
    expect(sheet).to_contain_text("Whether anything is being recorded is not known")
    expect(sheet).not_to_contain_text("Nothing is being recorded")
    expect(tablet.locator(".anew")).to_have_count(0)


@pytest.mark.parametrize("language", ["zh", "de", "es"])
def test_pupils_are_spoken_of_in_the_language_that_is_chosen(tablet: Page, room: Room, language: str) -> None:
    open_live(tablet, room)
    tablet.get_by_role("combobox").select_option(language)
    expect(tablet.locator("html")).to_have_attribute("lang", language)
    expect(up(tablet)).not_to_contain_text("Nobody")
    up(tablet).locator(".who").click()
    sheet = tablet.get_by_role("dialog")
    expect(sheet).not_to_contain_text("Who is up?")
    sheet.get_by_role("textbox").fill("Anna")
    sheet.get_by_role("textbox").press("Enter")
    expect(sheet.get_by_role("alert")).to_contain_text("B12")
    expect(sheet.get_by_role("alert")).not_to_contain_text("Not a code")


@pytest.mark.parametrize("what", ["sheet", "wrong", "correction"])
def test_pupils_are_accessible(tablet: Page, room: Room, what: str) -> None:
    shown = open_live(tablet, room)
    call(tablet, "7")
    until_told(tablet, room, "7")
    see(shown, room, tried(SHOT, FAULT))
    tablet.locator(".feedback .who" if what == "correction" else ".pupil .who").click()
    if what == "wrong":
        tablet.get_by_role("dialog").get_by_role("textbox").fill("Anna")
        tablet.get_by_role("dialog").get_by_role("textbox").press("Enter")
    tablet.evaluate(AXE.read_text(encoding="utf-8"))
    found = tablet.evaluate("axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']})")
    assert [(violation["id"], [node["html"] for node in violation["nodes"]]) for violation in found["violations"]] == []


@pytest.mark.parametrize(("width", "height"), [(390, 844), (844, 390), (1280, 800), (1024, 768)])
def test_who_is_up_fits_on_other_screens(tablets: Tablets, room: Room, width: int, height: int) -> None:
    page = tablets(width, height, has_touch=True, is_mobile=width < 900)
    shown = open_live(page, room)
    call(page, "36")
    until_told(page, room, "36")
    see(shown, room, tried(SHOT, FAULT))
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    for control in (".activity", ".pupil .who", ".pupil .next", ".feedback .who"):
        box = page.locator(control).bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 44
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= width
    assert Shown(page).number("figures") > 0
