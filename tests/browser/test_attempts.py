"""Attempts on the page: what is said of them, the list, and the choice of what pupils do."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import msgspec
import pytest
from playwright.sync_api import Page, expect

from models.messages.feedback import Colour, Feedback
from models.motions.actions.library import ACTIONS
from services.evaluation.report.numbers import estimate
from services.evaluation.report.words import WORDS
from tests.browser.attempts import tried, unseen
from tests.browser.conftest import Tablets
from tests.browser.room import Room, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, like, see
from tests.browser.test_page import AXE, Shown, open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

NOT_NAMED = {("forward_roll", "head_not_tucked")}
"""At full severity nothing is said of it: "What stays weak" in docs/teaching.md."""


@dataclass(frozen=True)
class Words:
    """What the server says about attempts."""

    actions: dict[str, Any]

    def cue(self, made: Feedback, language: str = "en") -> str:
        return str(self.actions[made.action]["faults"][made.cue]["cue"][language])

    def praise(self, made: Feedback) -> str:
        return str(self.actions[made.action]["faults"][made.praise]["praise"]["en"])


@pytest.fixture
def words(tablet: Page, room: Room) -> Words:
    return Words(tablet.request.get(f"{room.page}api/teaching").json()["actions"])


def test_an_attempt_brings_its_cue_score_measures_and_its_slow_replay(tablet: Page, room: Room, words: Words) -> None:
    shown = open_live(tablet, room)
    expect(tablet.get_by_text("No attempt yet")).to_be_visible()
    made = tried(SHOT, FAULT)
    number = see(shown, room, made)
    panel = tablet.locator(".feedback")
    expect(panel.locator("[data-cue]")).to_contain_text(words.cue(made))
    expect(panel.locator("[data-praise]")).to_have_text(words.praise(made))
    assert made.score is not None
    expect(panel.locator("[data-score]")).to_contain_text(f"{made.score:.0f}")
    expect(panel.locator("[data-score]")).to_contain_text("±")
    expect(panel.locator("[data-measure]")).to_have_count(3)
    for measure in made.measures:
        row = panel.locator(f"[data-measure={measure.name}]")
        expect(row).to_have_attribute("data-verdict", measure.verdict)
        assert measure.value is not None
        expect(row).to_contain_text(estimate(measure.value, measure.sigma, "", WORDS["en"]).partition("\u00a0")[0])
        expect(row).to_contain_text("±")
    expect(tablet.locator(f"[data-attempt='{number}']:visible").first).to_be_visible()
    shown.wait_until("Number(d.position) > 0.1")


def test_praise_stands_before_the_cue(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    praise, cue = tablet.locator("[data-praise]").bounding_box(), tablet.locator("[data-cue]").bounding_box()
    assert praise is not None
    assert cue is not None
    assert praise["y"] + praise["height"] <= cue["y"]


def test_what_was_not_seen_is_grey_in_the_replay_and_unknown_in_words(tablet: Page, room: Room) -> None:
    with_scene(room, speed=0.0)
    shown = open_live(tablet, room)
    see(shown, room, unseen(tried(SHOT, FAULT)))
    expect(tablet.get_by_text("Not seen well enough to judge")).to_be_visible()
    expect(tablet.locator("[data-verdict=unknown]")).to_have_count(3)
    expect(tablet.locator("[data-cue], [data-praise]")).to_have_count(0)
    shown.wait_until("d.levels === '17,0,0,0'")
    tablet.get_by_role("button", name="Peak").click()
    shown.wait_until("d.levels === '17,0,0,0'")
    tablet.locator("[data-standard]").click()
    tablet.locator("[data-standard]").click()
    expect(tablet.locator("[data-standard=off]")).to_be_visible()
    assert shown.number("coloured") == 0
    assert like(shown, Colour.GREEN) < 5
    assert like(shown, Colour.RED) < 5


def test_an_attempt_without_a_fault_gets_no_correction(tablet: Page, room: Room, words: Words) -> None:
    shown = open_live(tablet, room)
    made = tried(SHOT)
    assert made.cue == ""
    see(shown, room, made)
    expect(tablet.locator("[data-cue]")).to_have_count(0)
    expect(tablet.locator("[data-praise]")).to_have_text(words.praise(made))
    expect(tablet.get_by_text("No correction this time")).to_be_visible()


def test_the_words_stay_between_two_attempts(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    panel = tablet.locator(".feedback [role=status]")
    before = panel.inner_text()
    changes = "window.changes = 0; new MutationObserver(list => window.changes += list.length).observe("
    tablet.evaluate(changes + "document.querySelector('.feedback'), {subtree: true, childList: true, characterData: true})")
    figures = shown.number("figures")
    shown.wait_until("Number(d.position) > 0.5")
    tablet.get_by_role("button", name="Back to live").click()
    shown.wait_until(f"d.stage === 'live' && Number(d.figures) > {figures + 10}")
    with_scene(room, evaluating="moving")
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "true")
    assert panel.inner_text() == before
    assert tablet.evaluate("window.changes") == 0


READ_OUT = """
window.readOut = 0;
const isRead = ({target}) => (target.nodeType === Node.TEXT_NODE ? target.parentElement : target).closest('[aria-live]') === null;
new MutationObserver(list => window.readOut += list.filter(isRead).length).observe(
    document.querySelector('.feedback [role=status]'), {subtree: true, childList: true, characterData: true, attributes: true});
"""
"""How much has changed that a screen reader reads out; of a region that is atomic it reads all."""


def test_neither_a_correction_nor_another_attempt_has_the_one_that_is_looked_at_read_out_again(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    first = see(shown, room, tried(SHOT, FAULT))
    tablet.locator(f"li [data-attempt='{first}']").click()
    tablet.evaluate(READ_OUT)
    tablet.locator(".feedback .who").click()
    tablet.get_by_role("dialog").locator("[data-code='6']").click()
    expect(tablet.locator(".feedback .who")).to_have_attribute("data-pupil", "6")
    expect(tablet.locator(".feedback .who")).to_have_attribute("aria-busy", "false")
    room.attempt(tried(SHOT))
    expect(tablet.locator(".feedback .what")).to_contain_text("Attempt 1")
    assert tablet.evaluate("window.readOut") == 0
    tablet.get_by_role("button", name="Back to live").click()
    expect(tablet.locator("[data-cue]")).to_have_count(0)
    assert tablet.evaluate("window.readOut") > 0


def test_the_list_grows_and_each_attempt_can_be_seen_again(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    first = see(shown, room, tried(SHOT, FAULT))
    second = see(shown, room, tried("cartwheel", "bent_legs"))
    entries = tablet.locator("li [data-attempt]")
    expect(entries).to_have_count(2)
    expect(entries.first).to_have_attribute("data-attempt", str(second))
    entries.last.click()
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{first}'")
    expect(tablet.locator("[data-shown]")).to_have_attribute("data-shown", str(first))
    expect(tablet.locator("[data-cue]")).to_have_attribute("data-cue", FAULT)


def test_a_school_s_language_is_spoken_to_a_tablet_of_another_one(tablets: Tablets, room: Room) -> None:
    page = tablets(800, 500, locale="fr-FR")
    words = page.request.get(f"{room.page}api/teaching").json()
    page.route("**/api/teaching", lambda route: route.fulfill(json={**words, "languages": ["es", "en", "zh", "de"]}))
    page.goto(room.page)
    expect(page.locator("html")).to_have_attribute("lang", "es", timeout=60_000)


def test_the_choice_of_an_activity_reaches_the_box_and_comes_back(tablet: Page, room: Room, words: Words) -> None:
    open_live(tablet, room)
    chooser = tablet.locator(".activity")
    expect(chooser).to_contain_text("Any")
    chooser.click()
    choices = tablet.get_by_role("dialog").locator("[data-choose]")
    expect(choices).to_have_count(len(ACTIONS))
    for choice in choices.all():
        box = choice.bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 88, "large enough for a thumb in a gym"
    tablet.locator("[data-choose=squat]").click()
    expect(chooser).to_contain_text(words.actions["squat"]["title"]["en"])
    expect(chooser).to_have_attribute("data-activity", "squat")
    assert _until(tablet, lambda: room.activity == "squat")
    chooser.click()
    tablet.get_by_role("dialog").get_by_text("Any activity").click()
    expect(chooser).to_have_attribute("data-activity", "any")
    assert _until(tablet, lambda: room.activity == "")


def test_an_attempt_at_what_does_not_count_any_more_is_faded_and_that_is_said(tablet: Page, room: Room, words: Words) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    card = tablet.locator(".feedback")
    expect(card.locator("[data-only-now]")).to_have_count(0)
    tablet.locator(".activity").click()
    tablet.locator("[data-choose=squat]").click()
    expect(card.locator("[data-only-now]")).to_contain_text(words.actions["squat"]["title"]["en"])
    expect(card).to_have_class(re.compile(r"\bold\b"))
    see(shown, room, tried("squat"))
    expect(card.locator("[data-only-now]")).to_have_count(0)
    expect(card).not_to_have_class(re.compile(r"\bold\b"))


def _until(page: Page, condition: Callable[[], bool]) -> bool:
    for _ in range(300):
        if condition():
            return True
        page.wait_for_timeout(100)
    return False


def test_ten_attempts_get_the_cues_of_their_faults(tablet: Page, room: Room, words: Words) -> None:
    shown = open_live(tablet, room)
    for action in ACTIONS.values():
        fault = action.faults[0].name
        made = tried(action.name, fault)
        assert made.cue == ("" if (action.name, fault) in NOT_NAMED else fault)
        number = see(shown, room, made)
        expect(tablet.locator("[data-shown]")).to_have_attribute("data-shown", str(number))
        if made.cue:
            expect(tablet.locator("[data-cue]")).to_contain_text(words.cue(made))
        else:
            expect(tablet.locator("[data-cue]")).to_have_count(0)
        tablet.get_by_role("button", name="Back to live").click()
    expect(tablet.locator("li [data-attempt]")).to_have_count(len(ACTIONS))


def test_a_tablet_that_joins_later_is_told_of_the_attempts_and_starts_no_replay(tablet: Page, room: Room, words: Words) -> None:
    open_live(tablet, room)
    made = tried(SHOT, FAULT)
    for _ in range(2):
        room.attempt(made)
        tablet.wait_for_timeout(20)
    expect(tablet.locator("li [data-attempt]")).to_have_count(2)
    tablet.wait_for_timeout(9000)  # by then it is news no more
    tablet.reload()
    shown = Shown(tablet)
    shown.wait_for_phase("live")
    expect(tablet.locator("li [data-attempt]")).to_have_count(2)
    expect(tablet.locator("[data-cue]")).to_contain_text(words.cue(made))
    assert tablet.locator(".page").get_attribute("data-stage") == "live"


def test_the_list_begins_anew_by_a_touch_on_all_tablets_and_with_every_recording(
    tablets: Tablets, tablet: Page, room: Room
) -> None:
    open_live(tablet, room)
    other = tablets(800, 580)
    other.goto(room.page)
    room.attempt(tried(SHOT, FAULT))
    for page in (tablet, other):
        expect(page.locator("li [data-attempt]")).to_have_count(1)
    anew = tablet.get_by_role("button", name="Begin anew").first
    anew.click()
    tablet.get_by_role("button", name="Keep the list").click()
    expect(tablet.locator("li [data-attempt]")).to_have_count(1)
    anew.click()
    tablet.get_by_role("dialog").get_by_role("button", name="Begin anew").click()
    for page in (tablet, other):
        expect(page.locator("li [data-attempt]")).to_have_count(0)
        expect(page.get_by_text("No attempt yet")).to_be_visible()
    for lesson_s in (1.0, 2.0):
        with_scene(room, recorded_s=lesson_s)
        expect(tablet.locator("[data-recording]")).to_be_visible()
        expect(tablet.get_by_text("No attempt yet")).to_be_visible()
        room.attempt(tried(SHOT))
        expect(tablet.locator("li [data-attempt]")).to_contain_text("See attempt 1 again")
        expect(tablet.get_by_role("button", name="Begin anew")).to_have_count(0)
        with_scene(room, recorded_s=None)
        expect(tablet.locator("[data-recording]")).to_have_count(0)
        expect(tablet.locator("li [data-attempt]")).to_have_count(1)


def test_an_attempt_says_how_old_it_is_and_is_grey_after_some_minutes(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    panel = tablet.locator(".feedback")
    for ago_s, words, colour in ((301.0, "5 minutes ago", "grayscale(1)"), (125.0, "2 minutes ago", "none")):
        room.attempt(tried(SHOT, FAULT), ago_s)
        expect(panel).to_contain_text(words)
        expect(panel.locator(".card")).to_have_css("filter", colour)
        expect(panel.locator("[role=status]")).not_to_contain_text("ago")
    room.attempt(tried(SHOT))
    expect(panel.locator("[data-age]")).to_have_count(0)
    expect(panel.locator(".card")).to_have_css("filter", "none")


@pytest.mark.parametrize("recorded_s", [60.0, None])
def test_attempts_that_nobody_can_list_any_more_are_not_said_to_be_none(tablet: Page, room: Room, recorded_s: float | None) -> None:
    with_scene(room, recorded_s=recorded_s)
    open_live(tablet, room)
    if recorded_s is not None:
        expect(tablet.locator("[data-recording]")).to_be_visible()
    room.attempt(tried(SHOT, FAULT))
    expect(tablet.locator("li [data-attempt]")).to_have_count(1)
    room.stop_server()
    with_scene(room, evaluating=None, restarted=frozenset({"tablet"}))
    Shown(tablet).wait_for_phase("offline")
    with_scene(room, evaluating="waiting")
    room.start_server()
    words = "are not known any more" if recorded_s is None else "are in the report"
    expect(tablet.locator(".feedback")).to_contain_text(f"Earlier attempts {words}")
    room.attempt(tried(SHOT))
    expect(tablet.locator("li [data-attempt]")).to_contain_text(f"See attempt {1 if recorded_s is None else 2} again")
    expect(tablet.locator("li[data-earlier]")).to_have_text(f"Earlier attempts {words}")


def test_an_evaluation_that_is_gone_is_said(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    expect(tablet.locator("[data-judging=off]")).to_have_count(0)
    with_scene(room, evaluating=None)
    expect(tablet.locator("[data-judging=off]")).to_be_visible()
    with_scene(room, evaluating="waiting")
    expect(tablet.locator("[data-judging=off]")).to_have_count(0)


def test_a_measure_that_has_no_value_has_no_verdict_either(tablet: Page, room: Room) -> None:
    made = tried(SHOT)
    nothing = msgspec.structs.replace(made.measures[0], value=None, sigma=None, verdict="unknown")
    shown = open_live(tablet, room)
    see(shown, room, msgspec.structs.replace(made, measures=(nothing, *made.measures[1:])))
    row = tablet.locator(f"[data-measure={nothing.name}]")
    expect(row).to_contain_text("Not known")
    expect(row.get_by_text("Good")).to_have_count(0)


def test_a_value_that_says_nothing_for_sure_is_shown_and_called_not_sure(tablet: Page, room: Room) -> None:
    made = tried(SHOT)
    doubtful = msgspec.structs.replace(made.measures[0], value=12.0, sigma=30.0, unit="pct", verdict="unknown")
    shown = open_live(tablet, room)
    see(shown, room, msgspec.structs.replace(made, measures=(doubtful, *made.measures[1:])))
    row = tablet.locator(f"[data-measure={doubtful.name}]")
    expect(row).to_contain_text("Not sure")
    expect(row).to_contain_text("12 % of height, give or take 30")
    expect(row.get_by_text("Not known")).to_have_count(0)


@pytest.mark.parametrize("language", ["zh", "de", "es"])
def test_the_page_speaks_the_language_that_is_chosen_and_keeps_it(tablet: Page, room: Room, words: Words, language: str) -> None:
    shown = open_live(tablet, room)
    made = tried(SHOT, FAULT)
    see(shown, room, made)
    tablet.get_by_role("combobox").select_option(language)
    expect(tablet.locator("html")).to_have_attribute("lang", language)
    expect(tablet.locator("[data-cue]")).to_contain_text(words.cue(made, language))
    expect(tablet.get_by_text("Next time")).to_have_count(0)
    tablet.reload()
    shown.wait_for_phase("live")
    expect(tablet.locator("[data-cue]")).to_contain_text(words.cue(made, language))


@pytest.mark.parametrize("what", ["replay", "chooser", "unseen", "paused"])
def test_attempts_are_accessible(tablet: Page, room: Room, what: str) -> None:
    shown = open_live(tablet, room)
    see(shown, room, unseen(tried(SHOT)) if what == "unseen" else tried(SHOT, FAULT))
    if what == "chooser":
        tablet.locator(".activity").click()
    elif what == "paused":
        tablet.get_by_role("button", name="Pause").click()
        tablet.get_by_role("button", name="Mirror").click()
    tablet.evaluate(AXE.read_text(encoding="utf-8"))
    found = tablet.evaluate("axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']})")
    assert [(violation["id"], [node["html"] for node in violation["nodes"]]) for violation in found["violations"]] == []


@pytest.mark.parametrize(("width", "height"), [(390, 844), (844, 390), (1280, 800)])
def test_attempts_fit_on_other_screens(tablets: Tablets, room: Room, width: int, height: int) -> None:
    page = tablets(width, height, has_touch=True, is_mobile=width != 1280)
    shown = open_live(page, room)
    see(shown, room, tried(SHOT, FAULT))
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    canvas = page.locator("canvas").bounding_box()
    assert canvas is not None
    assert canvas["height"] > 120
    page.locator("[data-cue]").scroll_into_view_if_needed()
    expect(page.locator("[data-cue]")).to_be_in_viewport()
