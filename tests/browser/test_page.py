"""The page in Chromium, on the real server: the figure moves, and nothing that is not known looks fine."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import msgspec
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from models.arrays import Float
from models.messages.motion import JointState
from models.messages.trouble import Trouble
from models.process import Playback
from models.skeleton import coco
from services.tablet.page import PAGE
from tests.browser.conftest import Tablets
from tests.browser.room import CAMERAS, MACHINE, Room, Scene, with_scene

pytestmark = [pytest.mark.browser, pytest.mark.slow]

AXE = PAGE.parent / "node_modules" / "axe-core" / "axe.min.js"


@dataclass(frozen=True)
class Shown:
    """What the page tells of itself in `data-` attributes."""

    page: Page

    def number(self, key: str) -> float:
        return float(self.page.locator(".page").get_attribute(f"data-{key}") or "nan")

    def wait_for_phase(self, phase: str) -> None:
        self.page.locator(f".page[data-phase={phase}]").wait_for()

    def wait_until(self, condition: str) -> None:
        """Wait for a condition on `d`, the root's data set."""
        self.page.wait_for_function(f"() => {{ const d = document.querySelector('.page').dataset; return {condition}; }}")

    def picture(self) -> Float:
        """(height, width, 3) what the canvas shows, 0 to 1, without the words above it."""
        self._show_words(False)
        png = self.page.locator("canvas").screenshot()
        self._show_words(True)
        return np.asarray(cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_COLOR), np.float64) / 255

    def _show_words(self, visible: bool) -> None:
        # Through the object model: the page's security policy refuses a style sheet from outside.
        change = "for (const e of document.querySelectorAll('.messages, .legend, .reset')) e.style.visibility = "
        self.page.evaluate(change + ("''" if visible else "'hidden'"))

    def coloured_pixels(self) -> int:
        """Pixels that nobody would call grey."""
        picture = self.picture()
        return int((np.ptp(picture, axis=-1) > 0.25).sum())

    def wait_for_coloured_pixels(self, wanted: Callable[[int], bool]) -> None:
        """Wait for a picture: what is on the screen may for a moment be the one before."""
        for _ in range(100):
            if wanted(self.coloured_pixels()):
                return
            self.page.wait_for_timeout(100)
        raise AssertionError(f"{self.coloured_pixels()} coloured pixels")


def open_live(page: Page, room: Room) -> Shown:
    shown = Shown(page)
    page.goto(room.page)
    shown.wait_for_phase("live")
    shown.wait_until("Number(d.figures) >= 3 && Number(d.coloured) > 0")
    return shown


def test_the_figure_moves_while_the_pupil_does(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    before, figures = shown.picture(), shown.number("figures")
    shown.wait_until(f"Number(d.figures) >= {figures + 5}")
    assert (np.abs(shown.picture() - before).max(axis=-1) > 0.2).sum() > 75
    shown.wait_for_coloured_pixels(lambda pixels: pixels > 250)


def test_nothing_is_drawn_while_nothing_changes(page: Page, room: Room) -> None:
    with_scene(room, publishing=False)
    page.goto(room.page)
    shown = Shown(page)
    shown.wait_for_phase("searching")
    drawn = shown.number("drawn")
    page.wait_for_timeout(1500)
    assert shown.number("drawn") - drawn <= 2


def test_dragging_turns_the_view_and_the_button_brings_it_back(page: Page, room: Room) -> None:
    with_scene(room, speed=0.0)
    shown = open_live(page, room)
    first = shown.number("azimuth")
    box = page.locator("canvas").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y, steps=4)
    page.mouse.up()
    shown.wait_until(f"Math.abs(Number(d.azimuth) - {first}) > 20")
    page.get_by_role("button", name="Reset view").click()
    shown.wait_until(f"Math.abs(Number(d.azimuth) - {first}) < 1")


def test_the_view_turns_by_key(page: Page, room: Room) -> None:
    with_scene(room, speed=0.0)
    shown = open_live(page, room)
    first = shown.number("azimuth")
    page.get_by_role("application").focus()
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    shown.wait_until(f"Math.abs(Number(d.azimuth) - {first} - 20) < 1")
    page.keyboard.press("r")
    shown.wait_until(f"Math.abs(Number(d.azimuth) - {first}) < 1")


def test_server_gone_is_grey_with_words_and_server_back_is_live(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    room.stop_server()
    shown.wait_for_phase("offline")
    expect(page.get_by_text("No connection to the box")).to_be_visible()
    assert shown.number("coloured") == 0
    shown.wait_for_coloured_pixels(lambda pixels: pixels < 13)
    expect(page.locator("[data-camera]")).to_have_count(0)
    expect(page.get_by_text("Good")).to_have_count(0)
    room.start_server()
    shown.wait_for_phase("live")
    shown.wait_until("Number(d.coloured) > 0")


def test_motion_that_stops_becomes_grey_and_says_for_how_long(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    with_scene(room, publishing=False)
    shown.wait_for_phase("stale")
    expect(page.get_by_text("No new movement for")).to_be_visible()
    shown.wait_until("Number(d.coloured) === 0")
    shown.wait_for_coloured_pixels(lambda pixels: pixels < 13)
    with_scene(room, publishing=True)
    shown.wait_for_phase("live")


def test_a_pupil_who_leaves_is_waited_for(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    with_scene(room, pupil="searching", states=dict.fromkeys(range(coco.COUNT), JointState.UNKNOWN))
    shown.wait_for_phase("waiting")
    expect(page.get_by_text("Nobody in view")).to_be_visible()
    assert shown.number("coloured") == 0


def test_nobody_is_said_to_be_missing_before_the_box_has_looked(page: Page, room: Room) -> None:
    with_scene(room, publishing=False)
    page.goto(room.page)
    Shown(page).wait_for_phase("searching")
    expect(page.get_by_text("Looking for the pupil")).to_be_visible()
    expect(page.locator("[data-state=ok]")).to_have_count(4)
    expect(page.get_by_text("Nobody in view")).to_have_count(0)


def test_a_fusion_that_is_given_up_is_said_with_what_to_do(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    with_scene(room, publishing=False, given_up=frozenset({"fusion"}))
    shown.wait_for_phase("failed")
    expect(page.get_by_text("The box makes no figure any more")).to_be_visible()
    expect(page.get_by_text("Start the box anew")).to_be_visible()
    expect(page.get_by_text("lost")).to_have_count(0)
    shown.wait_until("Number(d.coloured) === 0")


def test_a_camera_that_is_given_up_is_told_from_one_that_returns(page: Page, room: Room) -> None:
    open_live(page, room)
    with_scene(room, lost=frozenset({CAMERAS[2]}), given_up=frozenset({f"edge-{CAMERAS[2]}"}))
    expect(page.get_by_text("Camera 3 lost \N{EN DASH} the lesson goes on with three")).to_be_visible()
    expect(page.get_by_text("Camera 3 does not come back by itself: check it, then start the box anew.")).to_be_visible()
    expect(page.locator(f"[data-camera={CAMERAS[2]}]")).to_contain_text("until it is started anew")


def test_guesses_alone_are_never_live(page: Page, room: Room) -> None:
    shown = open_live(page, room)
    with_scene(room, states=dict.fromkeys(range(coco.COUNT), JointState.GUESSED))
    shown.wait_for_phase("stale")
    shown.wait_for_coloured_pixels(lambda pixels: pixels < 13)


def test_a_joint_that_is_not_sure_is_grey_on_a_coloured_figure(page: Page, room: Room) -> None:
    with_scene(room, speed=0.0)
    shown = open_live(page, room)
    everything = shown.coloured_pixels()
    with_scene(room, states={coco.INDEX["left_knee"]: JointState.GUESSED, coco.INDEX["right_ankle"]: JointState.UNKNOWN})
    shown.wait_until("Number(d.coloured) < 1")
    shown.wait_for_coloured_pixels(lambda pixels: 0 < pixels < 0.9 * everything)


def test_a_lost_camera_is_named_and_the_lesson_goes_on(page: Page, room: Room) -> None:
    open_live(page, room)
    expect(page.locator("[data-state=ok]")).to_have_count(4)
    with_scene(room, lost=frozenset({CAMERAS[2]}))
    expect(page.get_by_text("Camera 3 lost \N{EN DASH} the lesson goes on with three")).to_be_visible()
    lost = page.locator(f"[data-camera={CAMERAS[2]}]")
    expect(lost).to_have_attribute("data-state", "lost")
    expect(lost).not_to_contain_text("/s")
    with_scene(room, lost=frozenset())
    expect(page.locator("[data-state=ok]")).to_have_count(4)
    expect(page.get_by_text("the lesson goes on")).to_have_count(0)


def test_the_rates_that_run_are_on_the_page(page: Page, room: Room) -> None:
    with_scene(room, fresh_hz=5.9)
    open_live(page, room)
    expect(page.get_by_text("The box is busy \N{EN DASH} fast movement may be missed")).to_be_visible()
    expect(page.get_by_text("fast movement may be missed")).to_have_count(1)
    expect(page.locator(f"[data-camera={CAMERAS[0]}]")).to_contain_text("6/s")
    page.get_by_role("button", name="Details").click()
    details = page.get_by_role("complementary")
    expect(details).to_contain_text("5.9 / 15.0")
    expect(details).to_contain_text("thunder")
    page.keyboard.press("Escape")
    expect(details).to_have_count(0)
    expect(page.get_by_role("button", name="Details")).to_be_focused()


def test_recording_is_told_with_its_length_while_it_lasts(page: Page, room: Room) -> None:
    open_live(page, room)
    chip = page.locator("[data-recording]")
    expect(chip).to_have_count(0)
    with_scene(room, recorded_s=723.4)
    expect(chip).to_have_text("Recording 12:03")
    expect(page.get_by_text("Live", exact=True)).to_be_visible()
    with_scene(room, recorded_s=None)
    expect(chip).to_have_count(0)


def test_a_phone_shows_figure_and_cameras_without_sideways_scrolling(tablets: Tablets, room: Room) -> None:
    with_scene(room, recorded_s=3725.0)
    page = tablets(390, 844, has_touch=True, is_mobile=True)
    shown = open_live(page, room)
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    canvas = page.locator("canvas").bounding_box()
    assert canvas is not None
    assert canvas["height"] > 300
    last = page.locator("[data-camera]").last.bounding_box()
    assert last is not None
    assert last["y"] + last["height"] <= 844, "all cameras are in view without scrolling"
    shown.wait_for_coloured_pixels(lambda pixels: pixels > 500)


@pytest.mark.parametrize(("width", "height"), [(390, 844), (844, 390)])
def test_a_warning_on_a_phone_stands_above_the_figure(tablets: Tablets, room: Room, width: int, height: int) -> None:
    with_scene(room, fresh_hz=5.0)
    page = tablets(width, height, has_touch=True, is_mobile=True)
    open_live(page, room)
    # On a busy machine the page may have more to say for a moment: `evaluate` waits for the warning, as `bounding_box` does not.
    bottom_px = page.get_by_text("The box is busy").evaluate("warning => warning.getBoundingClientRect().bottom")
    top_px = page.locator("canvas").evaluate("canvas => canvas.getBoundingClientRect().top")
    assert 0 < bottom_px <= top_px
    # The canvas follows the window with the next picture, which a busy machine draws late.
    page.wait_for_function("() => document.documentElement.scrollHeight <= window.innerHeight")


@pytest.mark.parametrize("phase", ["live", "lost", "offline", "details"])
def test_the_page_is_accessible(page: Page, room: Room, phase: str) -> None:
    with_scene(room, recorded_s=61.0)
    shown = open_live(page, room)
    if phase == "lost":
        with_scene(room, lost=frozenset({CAMERAS[1]}), fresh_hz=5.0)
        page.get_by_text("Camera 2 lost \N{EN DASH} the lesson goes on").wait_for()
    elif phase == "offline":
        room.stop_server()
        shown.wait_for_phase("offline")
    elif phase == "details":
        page.get_by_role("button", name="Details").click()
    # Not as a script element, which the page's security policy rightly refuses.
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate("axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']})")
    assert [(violation["id"], [node["html"] for node in violation["nodes"]]) for violation in found["violations"]] == []


def test_the_page_asks_no_other_host(page: Page, room: Room) -> None:
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    open_live(page, room)
    assert asked
    assert [url for url in asked if not url.startswith(room.page)] == []


def test_reduced_motion_is_respected(tablets: Tablets, room: Room) -> None:
    with_scene(room, speed=0.0)
    page = tablets(640, 400, reduced_motion="reduce")
    shown = open_live(page, room)
    first = shown.number("azimuth")
    page.get_by_role("application").focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("r")
    shown.wait_until(f"Math.abs(Number(d.azimuth) - {first}) < 0.2")


def test_a_browser_without_3d_says_so(page: Page, room: Room) -> None:
    page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    page.goto(room.page)
    Shown(page).wait_for_phase("unable")
    expect(page.get_by_text("This tablet cannot draw in 3D")).to_be_visible()


def test_a_teacher_is_told_of_the_machine_only_when_it_matters_and_the_technician_always(page: Page, room: Room) -> None:
    with_scene(room, speed=0.0, machine=msgspec.structs.replace(MACHINE, clock_step_ms=3000.0, disk_free_mib=1536.0))
    open_live(page, room)
    page.get_by_role("button", name="Details").click()
    details = page.locator("#details")
    for words in ("The clock of the box was set", "The disk is nearly full", "63 °C", "3.3 GB", "1.6 GB", "0.1.0"):
        expect(details.get_by_text(words, exact=True)).to_be_visible()
    message = page.locator(".messages")
    expect(message.get_by_text("disk")).to_have_count(0)
    with_scene(room, machine=msgspec.structs.replace(MACHINE, disk_free_mib=20.0))
    expect(message.get_by_text("The disk is full")).to_be_visible()
    with_scene(room, machine=msgspec.structs.replace(MACHINE, temperature_c=97.0))
    expect(message.get_by_text("The box is too hot")).to_be_visible()
    with_scene(room, machine=MACHINE)
    expect(message.get_by_text("The box is too hot")).to_have_count(0)


def test_a_teacher_is_told_of_cameras_that_are_exchanged_and_the_technician_which(page: Page, room: Room) -> None:
    exchanged = Trouble("cameras_exchanged", "cam01 and cam02 seem to be exchanged", "exchange their plugs")
    with_scene(room, speed=0.0, troubles=(exchanged,))
    open_live(page, room)
    message = page.locator(".messages")
    expect(message.get_by_text("Two cameras seem to be exchanged")).to_be_visible()
    page.get_by_role("button", name="Details").click()
    expect(page.locator("#details").get_by_text(exchanged.words)).to_be_visible()
    with_scene(room, troubles=())
    expect(message.get_by_text("Two cameras seem to be exchanged")).to_have_count(0)


def test_a_box_that_has_just_been_started_gets_ready_and_gives_no_warning(page: Page) -> None:
    """ "Attempts are not judged" was the first that a teacher read."""
    room = Room()
    room.scene = Scene(evaluating=None)
    with room:
        page.goto(room.page)
        expect(page.locator("[data-judging=starting]")).to_contain_text("Getting ready")
        expect(page.locator("[data-judging=off]")).to_have_count(0)
        with_scene(room, evaluating="waiting")
        expect(page.locator("[data-judging]")).to_have_count(0)


@pytest.mark.parametrize("locale", ["en", "de", "es", "zh"])
def test_a_lesson_that_is_to_be_played_says_that_it_waits_for_whoever_judges_it(tablets: Tablets, locale: str) -> None:
    """It was said that the cameras look for a pupil."""
    words = {
        "en": ("The lesson begins in a moment", "until attempts can be judged"),
        "de": ("Die Stunde beginnt gleich", "bis Versuche beurteilt werden können"),
        "es": ("La clase empieza enseguida", "que se puedan evaluar los intentos"),
        "zh": ("这节课马上开始播放", "等待评价动作的部分就绪"),
    }[locale]
    room = Room(playback=Playback("7b.mcap", "7b", 1_763_460_000_000_000_000, 1.0, loop=True))
    room.scene = Scene(publishing=False, pupil="unknown", evaluating=None)
    with room:
        page = tablets(1280, 800, locale=locale)
        page.goto(room.page)
        message = page.locator(".messages")
        for part in words:
            expect(message).to_contain_text(part)
        with_scene(room, evaluating="waiting", replayed_s=0.5, publishing=True, pupil="found")
        Shown(page).wait_for_phase("live")
        expect(message).not_to_contain_text(words[0])


def test_a_figure_whose_frame_changes_its_size_is_never_gone(page: Page, room: Room) -> None:
    """On a busy tablet the stage was white until the next picture was drawn."""
    shown = open_live(page, room)
    page.evaluate("window.requestAnimationFrame = () => 1")
    before = page.evaluate("document.querySelector('canvas').width")
    page.set_viewport_size({"width": 1000, "height": 600})
    page.wait_for_function("width => document.querySelector('canvas').width !== width", arg=before)
    assert shown.coloured_pixels() > 100
