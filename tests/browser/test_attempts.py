"""Attempts on the page: what is said of them, their slow replay with its colours, the list, and the choice of what pupils do."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from models.messages.feedback import Colour, Feedback
from models.motions.actions.library import ACTIONS
from tests.browser.attempts import tried, unseen
from tests.browser.room import Room, with_scene
from tests.browser.test_page import AXE, Shown, open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]

SHOT, FAULT = "basketball_shot", "no_knee_bend"


@dataclass(frozen=True)
class Words:
    """What the server says about attempts."""

    actions: dict[str, Any]

    def cue(self, made: Feedback, language: str = "en") -> str:
        return str(self.actions[made.action]["faults"][made.cue]["cue"][language])

    def praise(self, made: Feedback) -> str:
        return str(self.actions[made.action]["faults"][made.praise]["praise"]["en"])


@pytest.fixture
def tablet(browser: Browser, errors: list[str]) -> Iterator[Page]:
    """As large as the tablets in schools are."""
    made = browser.new_page(viewport={"width": 1024, "height": 768})
    made.set_default_timeout(60_000)
    made.on("pageerror", lambda error: errors.append(str(error)))
    yield made
    made.close()
    assert errors == []


@pytest.fixture
def words(tablet: Page, room: Room) -> Words:
    return Words(tablet.request.get(f"{room.page}api/teaching").json()["actions"])


def see(shown: Shown, room: Room, made: Feedback) -> int:
    """Let an attempt end and wait for its replay; returns its id."""
    number = room.attempt(made)
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{number}'")
    return number


def levels(shown: Shown) -> list[int]:
    """How many joints are grey, green, yellow and red in the replay's picture."""
    return [int(count) for count in (shown.page.locator(".page").get_attribute("data-levels") or "").split(",")]


def like(shown: Shown, colour: Colour) -> int:
    """Pixels of the canvas that anybody would call green, or red."""
    blue, green, red = np.moveaxis(shown.picture(), -1, 0)
    main, others = (green, np.maximum(red, blue)) if colour == Colour.GREEN else (red, np.maximum(green, blue))
    return int((main > others + 0.15).sum())


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
        expect(row).to_contain_text(f"{measure.value:.{0 if (measure.sigma or 0) >= 0.95 else 1}f}")
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


def test_the_replay_is_coloured_as_the_box_judged_each_frame(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.get_by_role("button", name="Peak").click()
    shown.wait_until("d.levels.split(',')[3] > 0")
    grey, green, _, red = levels(shown)
    assert grey == 0
    assert green > 8
    assert red > 0
    assert like(shown, Colour.GREEN) > 1000
    assert like(shown, Colour.RED) > 100


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
    assert like(shown, Colour.GREEN) < 20
    assert like(shown, Colour.RED) < 20


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


def test_a_replay_ends_by_a_touch_and_when_the_next_attempt_begins(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("button", name="Back to live").click()
    shown.wait_until("d.stage === 'live' && Number(d.coloured) === 1")
    expect(tablet.get_by_role("group", name="Slow replay")).to_have_count(0)
    see(shown, room, tried(SHOT))
    with_scene(room, evaluating="moving")  # walks back: what he did is to be seen once
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "true")
    shown.wait_until("d.stage === 'replay' && Number(d.rounds) >= 1")
    with_scene(room, evaluating="waiting")
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "false")
    assert tablet.locator(".page").get_attribute("data-stage") == "replay"
    with_scene(room, evaluating="moving")
    shown.wait_until("d.stage === 'live'")


def test_a_replay_that_is_looked_at_is_not_taken_away(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    first = see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("button", name="Pause").click()
    with_scene(room, evaluating="moving")
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "true")
    room.attempt(tried(SHOT))
    expect(tablet.locator("li [data-attempt]")).to_have_count(2)
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{first}'")
    expect(tablet.locator("[data-cue]")).to_have_count(1)
    tablet.get_by_role("button", name="Back to live").click()
    expect(tablet.locator("[data-cue]")).to_have_count(0)  # the newest, which had no fault


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


def test_the_replay_is_slow_and_as_fast_as_is_wished(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried("forward_roll"))
    speeds = []
    for speed in ("0.25", "1"):
        tablet.locator(f"[data-speed='{speed}']").click()
        tablet.get_by_role("button", name="Start").click()
        tablet.get_by_role("button", name="Play", exact=True).click()
        from_s, began_s = shown.number("position"), tablet.evaluate("performance.now()") / 1000
        shown.wait_until(f"Number(d.position) > {from_s} + 0.4")
        speeds.append((shown.number("position") - from_s) / (tablet.evaluate("performance.now()") / 1000 - began_s))
    assert speeds[0] < speeds[1]


def test_the_scrubber_goes_to_keyframes_and_to_any_moment_by_key(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    made = tried(SHOT, FAULT)
    see(shown, room, made)
    for index, name in enumerate(("Start", "Effort", "Peak", "End")):
        tablet.get_by_role("button", name=name, exact=True).click()
        at_s = made.frame_of(made.keyframes_ns[index]) * made.frame_ns * 1e-9
        shown.wait_until(f"Math.abs(Number(d.position) - {at_s}) < 0.02")
    scrubber = tablet.get_by_role("slider")
    scrubber.focus()
    tablet.keyboard.press("Home")
    shown.wait_until("Number(d.position) === 0")
    tablet.keyboard.press("ArrowRight")
    shown.wait_until("Number(d.position) > 0")
    expect(scrubber).to_have_attribute("aria-valuetext", re.compile(r"^0\.0 of \d\.\d seconds$"))


def test_a_replay_at_rest_draws_nothing_while_the_pupil_goes_on(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("button", name="Peak", exact=True).click()
    tablet.wait_for_timeout(800)
    drawn = shown.number("drawn")
    tablet.wait_for_timeout(1500)
    assert shown.number("drawn") - drawn <= 2
    assert shown.number("figures") > 0
    expect(tablet.locator(".page")).to_have_attribute("data-phase", "live")


def test_a_school_s_language_is_spoken_to_a_tablet_of_another_one(browser: Browser, room: Room) -> None:
    page = browser.new_page(viewport={"width": 1024, "height": 768}, locale="fr-FR")
    words = page.request.get(f"{room.page}api/teaching").json()
    page.route("**/api/teaching", lambda route: route.fulfill(json={**words, "languages": ["es", "en", "zh", "de"]}))
    page.goto(room.page)
    expect(page.locator("html")).to_have_attribute("lang", "es", timeout=60_000)
    page.close()


def test_the_standard_is_on_top_beside_or_away_and_all_in_a_mirror(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.get_by_role("button", name="Peak", exact=True).click()
    choice = tablet.locator("[data-standard]")
    pictures = {}
    for name in ("ghost", "beside", "off"):
        expect(choice).to_have_attribute("data-standard", name)
        tablet.wait_for_timeout(800)  # until the view has come to rest
        pictures[name] = shown.picture()
        choice.click()
    different = [np.abs(pictures[one] - pictures[other]).max(axis=-1) > 0.1 for one, other in (("ghost", "off"), ("beside", "off"))]
    assert all(pixels.sum() > 500 for pixels in different)
    tablet.get_by_role("button", name="Mirror").click()
    expect(tablet.get_by_role("button", name="Mirror")).to_have_attribute("aria-pressed", "true")
    tablet.wait_for_timeout(800)
    assert (np.abs(shown.picture() - pictures["ghost"]).max(axis=-1) > 0.1).sum() > 500


def test_the_choice_of_an_activity_reaches_the_box_and_comes_back(tablet: Page, room: Room, words: Words) -> None:
    open_live(tablet, room)
    chooser = tablet.locator(".activity")
    expect(chooser).to_contain_text("Any activity")
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


def _until(page: Page, condition: Callable[[], bool]) -> bool:
    for _ in range(300):
        if condition():
            return True
        page.wait_for_timeout(100)
    return False


def test_ten_attempts_get_the_cues_of_their_faults(tablet: Page, room: Room, words: Words) -> None:
    shown = open_live(tablet, room)
    for action in ACTIONS.values():
        made = tried(action.name, action.faults[0].name)
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


def test_without_the_box_nothing_of_an_attempt_is_coloured(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT))
    room.stop_server()
    shown.wait_for_phase("offline")
    shown.wait_until("d.stage === 'live' && Number(d.coloured) === 0")
    assert shown.coloured_pixels() < 50
    expect(tablet.get_by_text("From before the connection was lost")).to_be_visible()
    expect(tablet.locator(".activity")).to_be_disabled()
    expect(tablet.locator("li [data-attempt]")).to_be_disabled()
    expect(tablet.locator(".feedback .card")).to_have_css("filter", "grayscale(1)")
    room.start_server()
    shown.wait_for_phase("live")
    expect(tablet.get_by_text("From before the connection was lost")).to_have_count(0)


def test_an_evaluation_that_is_gone_is_said(tablet: Page, room: Room) -> None:
    open_live(tablet, room)
    expect(tablet.locator("[data-judging=off]")).to_have_count(0)
    with_scene(room, evaluating=None)
    expect(tablet.locator("[data-judging=off]")).to_be_visible()
    with_scene(room, evaluating="waiting")
    expect(tablet.locator("[data-judging=off]")).to_have_count(0)


def test_a_replay_that_is_gone_is_said(tablet: Page, room: Room) -> None:
    tablet.route("**/replay", lambda route: route.fulfill(status=404, body=""))
    open_live(tablet, room)
    room.attempt(tried(SHOT, FAULT))
    expect(tablet.get_by_text("no longer there")).to_be_visible()
    expect(tablet.locator("[data-cue]")).to_be_visible()
    tablet.get_by_role("button", name="Back to live").click()
    expect(tablet.get_by_text("no longer there")).to_have_count(0)


def test_a_measure_that_has_no_value_has_no_verdict_either(tablet: Page, room: Room) -> None:
    made = tried(SHOT)
    nothing = msgspec.structs.replace(made.measures[0], value=None, sigma=None, verdict="unknown")
    shown = open_live(tablet, room)
    see(shown, room, msgspec.structs.replace(made, measures=(nothing, *made.measures[1:])))
    row = tablet.locator(f"[data-measure={nothing.name}]")
    expect(row).to_contain_text("Not known")
    expect(row.get_by_text("Good")).to_have_count(0)


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


def test_a_replay_goes_by_key(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("application").focus()
    tablet.keyboard.press(" ")
    expect(tablet.get_by_role("button", name="Play", exact=True)).to_be_visible()
    tablet.keyboard.press("Escape")
    shown.wait_until("d.stage === 'live'")


def test_who_wants_less_motion_gets_the_decisive_moment_at_rest(browser: Browser, room: Room) -> None:
    page = browser.new_page(viewport={"width": 1024, "height": 768}, reduced_motion="reduce")
    shown = open_live(page, room)
    made = tried(SHOT, FAULT)
    see(shown, room, made)
    at_s = made.frame_of(made.keyframes_ns[2]) * made.frame_ns * 1e-9
    shown.wait_until(f"Math.abs(Number(d.position) - {at_s}) < 0.02")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    page.close()


@pytest.mark.parametrize(("width", "height"), [(390, 844), (844, 390), (1280, 800)])
def test_attempts_fit_on_other_screens(browser: Browser, room: Room, width: int, height: int) -> None:
    page = browser.new_page(viewport={"width": width, "height": height}, has_touch=True, is_mobile=width != 1280)
    shown = open_live(page, room)
    see(shown, room, tried(SHOT, FAULT))
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    canvas = page.locator("canvas").bounding_box()
    assert canvas is not None
    assert canvas["height"] > 120
    page.locator("[data-cue]").scroll_into_view_if_needed()
    expect(page.locator("[data-cue]")).to_be_in_viewport()
    page.close()
