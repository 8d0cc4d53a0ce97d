"""What fits on the screens that teachers have, in every language. Letters are wide where these tests run."""

import pytest
from playwright.sync_api import Page, Route, expect

from tests.browser.attempts import tried
from tests.browser.conftest import REPLAY_PICTURE_MS, Tablets
from tests.browser.room import Room, Scene, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, see
from tests.browser.test_page import open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LANGUAGES = ("en", "de", "es", "zh")
SCREENS = [(1280, 800), (390, 844)]

FAULTY = """() => {
    const shown = (selector) => [...document.querySelectorAll(selector)].filter((e) => e.getClientRects().length > 0);
    const words = (e) => e.textContent.trim();
    const labels = '.activity strong, .activity small, .pupil strong, .pupil small, .pill, .opener, .title, .back, .legend li, '
        + '.tools button, .group button, .anew, dialog[open] form button, dialog[open] li button';
    const leaves = (e) => {
        const room = e.parentElement.closest('.stage, button, dialog, main, header').getBoundingClientRect();
        const own = e.getBoundingClientRect();
        return own.left < room.left - 1 || own.right > room.right + 1;
    };
    const cut = shown(labels).filter((e) => e.scrollWidth > e.clientWidth + 1 || leaves(e)).map((e) => `cut: ${words(e)}`);
    const over = shown('.title, .back, .message, .picture .legend li, .tools button');
    const lies = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const pairs = over.flatMap((a, index) => over.slice(index + 1).map((b) => [a, b]));
    const hidden = pairs.filter(([a, b]) => lies(a.getBoundingClientRect(), b.getBoundingClientRect()));
    return [...cut, ...hidden.map(([a, b]) => `one over the other: ${words(a)}, ${words(b)}`)];
}"""
"""Main labels that do not fit into their places, and those that lie over one another."""


SPEAK = """code => {
    const list = document.querySelector('header select');
    list.value = code;
    list.dispatchEvent(new Event('change', {bubbles: true}));
}"""


def speak(page: Page, language: str) -> None:
    """Also behind an open sheet."""
    page.evaluate(SPEAK, language)
    expect(page.locator("html")).to_have_attribute("lang", language)


def faulty(page: Page) -> dict[str, list[str]]:
    """What does not fit, by language."""
    found = {}
    for language in LANGUAGES:
        speak(page, language)
        found[language] = page.evaluate(FAULTY)
    return {language: labels for language, labels in found.items() if labels}


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_no_label_is_cut_or_covered_in_any_language(tablets: Tablets, room: Room, width: int, height: int) -> None:
    with_scene(room, fresh_hz=6.0)  # a warning is there, too
    page = tablets(width, height, REPLAY_PICTURE_MS, has_touch=True, is_mobile=width < 760)
    shown = open_live(page, room)
    expect(page.locator(".message")).to_be_visible()
    assert faulty(page) == {}
    page.locator(".pupil .who").click()
    assert faulty(page) == {}
    page.keyboard.press("Escape")
    page.locator(".activity").click()
    assert faulty(page) == {}
    page.locator("[data-choose=long_jump]").click()
    expect(page.locator(".activity")).to_have_attribute("data-wish", "settled")
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.route("**/replay", hold)
    room.attempt(tried(SHOT, FAULT))
    expect(page.locator("[data-replaying=loading]")).to_be_visible()
    assert faulty(page) == {}
    held[0].continue_()
    shown.wait_until("d.stage === 'replay'")
    assert faulty(page) == {}


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_no_label_is_cut_while_the_box_starts(tablets: Tablets, width: int, height: int) -> None:
    room = Room()
    room.scene = Scene(evaluating=None)
    with room:
        page = tablets(width, height, has_touch=True, is_mobile=width < 760)
        open_live(page, room)
        expect(page.locator(".activity")).to_have_attribute("data-activity", "unknown")
        assert faulty(page) == {}


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_no_column_of_the_details_is_out_of_sight(tablets: Tablets, room: Room, width: int, height: int) -> None:
    page = tablets(width, height, has_touch=True, is_mobile=width < 760)
    open_live(page, room)
    page.locator(".opener").click()
    expect(page.locator("#details table")).to_have_count(2)
    for language in LANGUAGES:
        speak(page, language)
        assert page.evaluate("(s => s.scrollWidth - s.clientWidth)(document.querySelector('#details .scroll'))") == 0, language


def test_a_phone_shows_what_to_correct_without_scrolling(tablets: Tablets, room: Room) -> None:
    with_scene(room, recorded_s=3725.0)
    page = tablets(390, 844, REPLAY_PICTURE_MS, has_touch=True, is_mobile=True)
    see(open_live(page, room), room, tried(SHOT, FAULT))
    for language in LANGUAGES:
        speak(page, language)
        expect(page.locator("[data-cue]")).to_be_in_viewport(ratio=1)
        feet, tools = page.locator("canvas").bounding_box(), page.locator(".tools").bounding_box()
        assert feet is not None
        assert tools is not None
        assert feet["height"] > 120
        assert feet["x"] + feet["width"] <= tools["x"] + 1, "nothing lies over the figure"


def test_the_head_of_a_phone_s_page_is_one_row(tablets: Tablets, room: Room) -> None:
    with_scene(room, recorded_s=3725.0)
    page = tablets(390, 844, has_touch=True, is_mobile=True)
    open_live(page, room)
    expect(page.locator("[data-recording]")).to_be_visible()
    for language in LANGUAGES:
        speak(page, language)
        assert page.locator("header").first.evaluate("header => header.offsetHeight") < 70, language


def test_a_phone_says_that_names_are_not_wanted_without_scrolling(tablets: Tablets, room: Room) -> None:
    page = tablets(390, 844, has_touch=True, is_mobile=True)
    open_live(page, room)
    page.locator(".pupil .who").click()
    sheet = page.locator("dialog[open]")
    for language in LANGUAGES:
        speak(page, language)
        expect(sheet.locator(".privacy")).to_be_in_viewport(ratio=1)
        tops = [sheet.locator(what).evaluate("one => one.getBoundingClientRect().top") for what in ("input", "form button")]
        assert abs(tops[0] - tops[1]) < 10, "the button is beside its field"
