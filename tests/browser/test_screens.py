"""What fits on the screens that teachers have, in every language. Letters are wide where these tests run."""

import msgspec
import pytest
from playwright.sync_api import Page, Route, expect

from models.process import Playback
from tests.browser.attempts import tried
from tests.browser.conftest import REPLAY_PICTURE_MS, Tablets
from tests.browser.room import Room, Scene, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, see
from tests.browser.test_page import open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LANGUAGES = ("en", "de", "es", "zh")
SCREENS = [(1280, 800), (390, 844)]
ARM = 0.4 / 2.4
"""How far raised hands are from the middle of the picture, of its height; see `framing.ts`."""

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
    const touches = (e) => {
        const range = document.createRange();
        range.selectNodeContents(e);
        const [text, key] = [range.getBoundingClientRect(), e.closest('button').getBoundingClientRect()];
        return text.left < key.left + 3 || text.right > key.right - 3;
    };
    const keyed = shown('.activity .what, .pupil .what, dialog[open] li button span').filter(touches);
    cut.push(...keyed.map((e) => `touches its border: ${words(e)}`));
    const over = shown('.title, .back, .message, .picture .legend li, .tools button');
    const lies = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const pairs = over.flatMap((a, index) => over.slice(index + 1).map((b) => [a, b]));
    const hidden = pairs.filter(([a, b]) => lies(a.getBoundingClientRect(), b.getBoundingClientRect()));
    return [...cut, ...hidden.map(([a, b]) => `one over the other: ${words(a)}, ${words(b)}`)];
}"""
"""Main labels that do not fit into their places, and those that lie over one another."""


CUT = """words => {
    const shown = [...document.querySelectorAll(words)].filter((e) => e.getClientRects().length > 0);
    const wide = (e) => {
        const free = e.cloneNode(true);
        free.style.cssText = 'position: absolute; width: max-content; max-width: none';
        e.after(free);
        const [own, wanted] = [e, free].map((each) => each.getBoundingClientRect().width);
        free.remove();
        return wanted > own; // a part of a pixel costs a letter
    };
    const oneLine = (e) => getComputedStyle(e).whiteSpace === 'nowrap';
    const cut = (e) => oneLine(e) ? wide(e) : e.scrollHeight > e.clientHeight + 1 || e.scrollWidth > e.clientWidth + 1;
    const faulty = shown.filter(cut).map((e) => e.textContent.trim());
    return document.documentElement.scrollWidth > window.innerWidth ? [...faulty, 'wider than the screen'] : faulty;
}"""
"""Which of some words are cut."""


CODES = """code => {
    const found = [];
    const texts = document.createTreeWalker(document.querySelector('main'), NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
        const [text, range] = [texts.currentNode, document.createRange()];
        const key = text.parentElement.closest('button, .title');
        const from = text.data.indexOf(code);
        if (from < 0 || key === null || text.parentElement.closest('.hidden')) continue;
        range.setStart(text, from);
        range.setEnd(text, from + code.length);
        if (range.getClientRects().length === 0) continue;
        const [own, room] = [range.getBoundingClientRect(), key.getBoundingClientRect()];
        const whole = own.left > room.left && own.right < room.right && own.top > room.top && own.bottom < room.bottom;
        const lines = new Set([...range.getClientRects()].map(({ top }) => Math.round(top))).size;
        found.push({ place: key.className, lines, whole });
    }
    const label = document.querySelector('.pupil small');
    const next = document.querySelector('.pupil .next').getBoundingClientRect();
    const covered = label.getBoundingClientRect().right > next.left || label.scrollWidth > label.clientWidth;
    return { found, covered };
}"""
"""Where a code stands on the page, and how well it can be read there."""

LEAVES = """() => {
    const column = document.querySelector('.asked').getBoundingClientRect();
    const said = '.card, .card .what, .card .what span, .card .who, .card .score, .card .score i, .card p, .measures > li';
    const leaves = (e) => {
        const own = e.getBoundingClientRect();
        const wide = e.clientWidth > 0 && e.scrollWidth > e.clientWidth + 1; // a line of words has no width of its own
        return wide || own.left < column.left - 1 || own.right > column.right + 1;
    };
    return [...document.querySelectorAll(said)].filter(leaves).map((e) => `${e.className}: ${e.textContent.trim()}`);
}"""
"""What is said of an attempt and is wider than its place or the column."""


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


@pytest.mark.parametrize(("width", "height"), [(1180, 820), (1024, 768), (800, 580), (390, 844), (844, 390)])
def test_what_is_replayed_is_not_cut_nor_is_the_name_of_the_site(tablets: Tablets, width: int, height: int) -> None:
    words = "header h1 span, [data-replay] .begun, [data-replay] time"
    if width != 800:  # there a title may be cut, where day and time say which lesson it is
        words += ", [data-replay] .name"
    with Room(playback=Playback("7b.mcap", "7b, throwing", 1_795_000_000_000_000_000, 1.0, loop=True)) as room:
        with_scene(room, replayed_s=2345.0)
        page = tablets(width, height, has_touch=True, is_mobile=width < 900)
        open_live(page, room)
        expect(page.locator("[data-replay]")).to_contain_text("39:05")
        cut = {}
        for language in LANGUAGES:
            speak(page, language)
            cut[language] = page.evaluate(CUT, words)
        assert not any(cut.values()), cut


@pytest.mark.parametrize(
    ("width", "height", "code"),
    [(1280, 800, "WW-10000"), (390, 844, "7B-12"), (390, 844, "WW-10000"), (844, 390, "WW-10000")],
)
def test_no_code_is_broken_or_cut_in_any_language(tablets: Tablets, room: Room, width: int, height: int, code: str) -> None:
    page = tablets(width, height, REPLAY_PICTURE_MS, has_touch=True, is_mobile=width < 900)
    shown = open_live(page, room)
    page.locator(".pupil .who").click()
    page.get_by_role("dialog").get_by_role("textbox").fill(code)
    page.keyboard.press("Enter")
    expect(page.locator(".pupil")).to_have_attribute("data-pupil", code)
    expect(page.locator(".pupil")).to_have_attribute("data-wish", "settled")
    see(shown, room, tried(SHOT, FAULT))
    for language in LANGUAGES:
        speak(page, language)
        read = page.evaluate(CODES, code)
        assert len(read["found"]) >= 3, "who is up, on the list, and beside the score"
        assert [one for one in read["found"] if one["lines"] != 1 or not one["whole"]] == [], language
        assert not read["covered"], language
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth"), language


def test_codes_in_the_sentence_that_says_what_a_code_is_are_not_broken(tablets: Tablets, room: Room) -> None:
    page = tablets(390, 844, has_touch=True, is_mobile=True)
    open_live(page, room)
    page.locator(".pupil .who").click()
    page.get_by_role("dialog").get_by_role("textbox").fill("Anna")
    page.keyboard.press("Enter")
    for language in LANGUAGES:
        speak(page, language)
        expect(page.get_by_role("alert")).to_contain_text("7B\N{NON-BREAKING HYPHEN}12")


def test_what_nobody_has_chosen_takes_two_lines_on_a_phone(tablets: Tablets, room: Room) -> None:
    page = tablets(390, 844, has_touch=True, is_mobile=True)
    open_live(page, room)
    expect(page.locator(".activity")).to_have_attribute("data-preset", "true")
    for language in LANGUAGES:
        speak(page, language)
        assert page.locator(".activity .what").evaluate("what => what.offsetHeight") < 50, language


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (1024, 768)])
def test_a_warning_lies_beside_the_figure_and_not_over_its_head(tablets: Tablets, room: Room, width: int, height: int) -> None:
    with_scene(room, fresh_hz=6.0)
    page = tablets(width, height)
    open_live(page, room)
    expect(page.locator(".message")).to_be_visible()
    for language in LANGUAGES:
        speak(page, language)
        message, canvas = page.locator(".message").bounding_box(), page.locator("canvas").bounding_box()
        assert message is not None
        assert canvas is not None
        arm = ARM * canvas["height"]
        assert message["x"] + message["width"] < canvas["x"] + canvas["width"] / 2 - arm, language


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


@pytest.mark.parametrize(("width", "height"), [*SCREENS, (844, 390)])
def test_nothing_of_what_is_said_of_an_attempt_leaves_its_column(tablets: Tablets, room: Room, width: int, height: int) -> None:
    """On a phone that was held sideways the score's error and the ends of the words were out of sight."""
    page = tablets(width, height, REPLAY_PICTURE_MS, has_touch=True, is_mobile=width < 1000)
    made = msgspec.structs.replace(tried(SHOT, FAULT), score=100.0, score_sigma=12.0)
    see(open_live(page, room), room, made)
    for language in LANGUAGES:
        speak(page, language)
        assert page.evaluate(LEAVES) == [], language


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
