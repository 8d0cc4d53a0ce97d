"""The slow replay of an attempt: its colours, its speed, its keys, the standard beside it, and who may end it."""

import re
import time

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from models.messages.feedback import Colour
from tests.browser.attempts import tried
from tests.browser.conftest import Tablets
from tests.browser.room import Room, with_scene
from tests.browser.shown_attempts import FAULT, SHOT, levels, like, see
from tests.browser.test_page import open_live

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_the_replay_is_coloured_as_the_box_judged_each_frame(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.get_by_role("button", name="Peak").click()
    shown.wait_until("d.levels.split(',')[3] > 0")
    grey, green, _, red = levels(shown)
    assert grey == 0
    assert green > 8
    assert red > 0
    assert like(shown, Colour.GREEN) > 250
    assert like(shown, Colour.RED) > 25


def test_a_replay_ends_by_a_touch_and_when_the_next_attempt_begins(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("button", name="Back to live").click()
    shown.wait_until("d.stage === 'live' && Number(d.coloured) === 1")
    expect(tablet.get_by_role("group", name="Slow replay")).to_have_count(0)
    see(shown, room, tried(SHOT))
    with_scene(room, evaluating="moving")  # walks back: what he did is to be seen once
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "true")
    with_scene(room, evaluating="waiting")
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "false")
    shown.wait_until("d.stage === 'replay' && Number(d.rounds) >= 1")
    with_scene(room, evaluating="moving")
    shown.wait_until("d.stage === 'live'")


def test_who_walks_back_and_goes_straight_into_the_next_attempt_is_seen_after_one_round(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    made = tried(SHOT, FAULT)
    begun_s = time.monotonic()
    see(shown, room, made)
    with_scene(room, evaluating="moving")
    expect(tablet.locator(".activity")).to_have_attribute("data-moving", "true")
    assert tablet.locator(".page").get_attribute("data-stage") == "replay"
    shown.wait_until("d.stage === 'live'")
    one_round_s = (len(made.states) - 1) * made.frame_ns * 1e-9 / 0.5
    assert time.monotonic() - begun_s > one_round_s


def test_words_of_an_earlier_attempt_that_somebody_reads_stay_when_a_pupil_moves(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    first = see(shown, room, tried(SHOT, FAULT))
    see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.locator(f"li [data-attempt='{first}']").click()
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{first}' && Number(d.rounds) >= 1")
    # Half a minute later nobody has touched it any more.
    tablet.evaluate("const real = performance.now.bind(performance); performance.now = () => real() + 31_000;")
    with_scene(room, evaluating="moving")
    shown.wait_until("d.stage === 'live'")
    expect(tablet.locator("[data-shown]")).to_have_attribute("data-shown", str(first))
    expect(tablet.locator("[data-cue]")).to_have_attribute("data-cue", FAULT)


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


PACE = """async () => {
    const {dataset} = document.querySelector('.page');
    const change = async () => {
        const before = dataset.position;
        while (dataset.position === before) await new Promise(requestAnimationFrame);
        return [performance.now() / 1000, Number(dataset.position)];
    };
    const [fromS, from] = await change();
    let [nowS, now] = [fromS, from];
    while (nowS - fromS < 1) [nowS, now] = await change();
    return (now - from) / (nowS - fromS);
}"""
"""Seconds of the attempt a second, over one second at least. A slow machine plays more slowly, but never faster."""


def test_the_replay_is_slow_and_as_fast_as_is_wished(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried("forward_roll"))
    paces = {}
    for speed in (0.25, 1.0):
        tablet.locator(f"[data-speed='{speed:g}']").click()
        tablet.get_by_role("button", name="Start").click()
        tablet.get_by_role("button", name="Play", exact=True).click()
        paces[speed] = tablet.evaluate(PACE)
        assert 0.1 * speed < paces[speed] < 1.25 * speed
    assert 0.15 < paces[0.25] / paces[1.0] < 0.5


def test_the_scrubber_goes_to_keyframes_and_to_any_moment_by_key(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    made = tried(SHOT, FAULT)
    see(shown, room, made)
    for index, name in enumerate(("Start", "Effort", "Peak", "End")):
        tablet.get_by_role("button", name=name, exact=True).click()
        at_s = made.frame_of(made.keyframes_ns[index]) * made.frame_ns * 1e-9
        shown.wait_until(f"Math.abs(Number(d.position) - {at_s}) < 0.02")
        expect(tablet.locator("[data-keyframe][aria-current=true]")).to_have_text(name)
        expect(tablet.locator(".ticks .reached")).to_have_count(1)
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
    assert (np.abs(shown.picture() - pictures["ghost"]).max(axis=-1) > 0.1).sum() > 125


def test_the_model_s_tile_names_what_a_touch_does(tablet: Page, room: Room) -> None:
    see(open_live(tablet, room), room, tried(SHOT, FAULT))
    choice = tablet.locator("[data-standard]")
    for name, then in (("Model beside", "beside"), ("Hide model", "off"), ("Model on top", "ghost")):
        tablet.get_by_role("button", name=name).click()
        expect(choice).to_have_attribute("data-standard", then)


def test_a_slow_replay_is_not_called_live(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    live = tablet.get_by_text("Live", exact=True)
    expect(live).to_be_visible()
    see(shown, room, tried(SHOT, FAULT))
    expect(live).to_have_count(0)
    tablet.get_by_role("button", name="Back to live").click()
    expect(live).to_be_visible()


def test_a_lost_connection_takes_no_replay_away_and_lets_others_be_seen_that_were(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    first = see(shown, room, tried(SHOT, FAULT))
    tablet.route("**/replay", lambda route: route.abort())
    never_seen = room.attempt(tried(SHOT))
    expect(tablet.get_by_text("did not arrive")).to_be_visible()
    tablet.unroute("**/replay")
    explained = see(shown, room, tried("cartwheel", "bent_legs"))
    tablet.evaluate(
        "window.said = 0; new MutationObserver(list => window.said += list.length).observe("
        "document.querySelector('.feedback [role=status]'), {subtree: true, childList: true, characterData: true})"
    )
    room.stop_server()
    shown.wait_for_phase("offline")
    expect(tablet.get_by_text("From before the connection was lost")).to_be_visible()
    expect(tablet.locator(".activity")).to_be_disabled()
    expect(tablet.locator(".feedback .card")).to_have_css("filter", "grayscale(1)")
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{explained}' && Number(d.rounds) >= 1")
    room.start_server()
    shown.wait_for_phase("live")
    expect(tablet.get_by_text("From before the connection was lost")).to_have_count(0)
    expect(tablet.get_by_role("button", name="Begin anew")).to_be_visible()  # the list is there, too
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{explained}'")
    assert tablet.evaluate("window.said") == 0, "whoever has it read out heard it once"
    room.stop_server()
    shown.wait_for_phase("offline")
    expect(tablet.locator(f"li [data-attempt='{never_seen}']")).to_be_disabled()
    tablet.locator(f"li [data-attempt='{first}']").click()
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{first}'")
    expect(tablet.locator("[data-cue]")).to_have_attribute("data-cue", FAULT)
    tablet.get_by_role("button", name="Back to live").click()
    shown.wait_until("d.stage === 'live' && Number(d.coloured) === 0")
    shown.wait_for_coloured_pixels(lambda pixels: pixels < 13)


def test_a_replay_that_is_gone_is_said(tablet: Page, room: Room) -> None:
    tablet.route("**/replay", lambda route: route.fulfill(status=404, body=""))
    open_live(tablet, room)
    room.attempt(tried(SHOT, FAULT))
    expect(tablet.get_by_text("no longer there")).to_be_visible()
    expect(tablet.locator("[data-cue]")).to_be_visible()
    tablet.get_by_role("button", name="Back to live").click()
    expect(tablet.get_by_text("no longer there")).to_have_count(0)


def test_a_replay_that_did_not_arrive_can_be_asked_for_again(tablet: Page, room: Room) -> None:
    tablet.route("**/replay", lambda route: route.abort())
    shown = open_live(tablet, room)
    number = room.attempt(tried(SHOT, FAULT))
    expect(tablet.get_by_text("did not arrive")).to_be_visible()
    expect(tablet.get_by_text("no longer there")).to_have_count(0)
    tablet.unroute("**/replay")
    tablet.get_by_role("button", name="Try again").click()
    shown.wait_until(f"d.stage === 'replay' && d.attempt === '{number}'")
    expect(tablet.get_by_text("did not arrive")).to_have_count(0)


def test_on_a_low_screen_the_patterns_are_explained_too(tablets: Tablets, room: Room) -> None:
    page = tablets(844, 390, has_touch=True, is_mobile=True)
    shown = open_live(page, room)
    see(shown, room, tried(SHOT, FAULT))
    legend = page.locator(".bar .legend")
    expect(legend.get_by_text("Not sure")).to_be_in_viewport()
    box, reset = legend.bounding_box(), page.locator(".tools").bounding_box()
    assert box is not None
    assert reset is not None
    assert box["x"] + box["width"] <= reset["x"], "nothing that is touched is under it"


def test_a_replay_goes_by_key(tablet: Page, room: Room) -> None:
    shown = open_live(tablet, room)
    see(shown, room, tried(SHOT, FAULT))
    tablet.get_by_role("application").focus()
    tablet.keyboard.press(" ")
    expect(tablet.get_by_role("button", name="Play", exact=True)).to_be_visible()
    tablet.keyboard.press("Escape")
    shown.wait_until("d.stage === 'live'")


def test_who_wants_less_motion_gets_the_decisive_moment_at_rest(tablets: Tablets, room: Room) -> None:
    page = tablets(800, 500, reduced_motion="reduce")
    shown = open_live(page, room)
    made = tried(SHOT, FAULT)
    see(shown, room, made)
    at_s = made.frame_of(made.keyframes_ns[2]) * made.frame_ns * 1e-9
    shown.wait_until(f"Math.abs(Number(d.position) - {at_s}) < 0.02")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
