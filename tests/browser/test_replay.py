"""A lesson played by `kinebox replay`, as the page shows it: the figure moves, and nobody takes it for live."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from models.config.site import TabletConfig
from services.supervisor.page import answers
from tests.browser.test_page import AXE, Shown
from tests.installed import ROOT
from tests.integration.waiting import until
from tests.lifeline import bound
from tests.ports import free_port
from tests.synthetic.gym import Gym
from tests.synthetic.gym_lesson import write_gym_lesson

pytestmark = [pytest.mark.browser, pytest.mark.slow]

STARTING_S = 120.0
"""A machine that has never compiled the kernels compiles them now."""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    folder = tmp_path_factory.mktemp("lesson")
    with playing(write_gym_lesson(folder, Gym(seconds=8.0)), folder) as address:
        yield address


@contextmanager
def playing(lesson: Path, folder: Path, *options: str) -> Iterator[str]:
    """`kinebox replay`, which goes on for ever unless `options` say otherwise; the address of its page."""
    port = free_port()
    command = [
        sys.executable,
        "-m",
        "services.cli.main",
        "replay",
        str(lesson),
        "--port",
        str(port),
        "--data",
        str(ROOT / "build"),
        *options,
    ]
    with (
        (folder / "output").open("wb") as output,
        subprocess.Popen(bound(command), cwd=ROOT, stdout=output, stderr=output) as process,
    ):
        try:
            page = TabletConfig(host="127.0.0.1", port=port)
            until(lambda: answers(page) or process.poll() is not None, "the page of the replay", STARTING_S)
            assert process.poll() is None, (folder / "output").read_text()
            yield f"http://127.0.0.1:{port}/"
        finally:
            process.terminate()
            process.wait(60)


def open_replay(page: Page, address: str) -> Shown:
    shown = Shown(page)
    page.goto(address)
    shown.wait_for_phase("live")
    shown.wait_until("Number(d.figures) >= 3 && Number(d.coloured) > 0")
    return shown


def test_a_replay_moves_and_says_that_it_is_one(page: Page, address: str) -> None:
    shown = open_replay(page, address)
    chip = page.locator("[data-replay]")
    expect(chip).to_contain_text("Replay \N{MIDDLE DOT} 7b, throwing")
    expect(chip).to_contain_text("18 Nov 2026")
    expect(page.get_by_text("Live", exact=True)).to_have_count(0)
    expect(page.get_by_text("Synthetic gym")).to_be_visible()
    before, figures = shown.picture(), shown.number("figures")
    shown.wait_until(f"Number(d.figures) >= {figures + 5}")
    assert abs(shown.picture() - before).max() > 0.2
    expect(page.locator("[data-camera]")).to_have_count(4)
    expect(page.locator("[data-state=ok]")).to_have_count(4)
    first = chip.locator("time").text_content() or ""
    assert first.endswith(("/ 0:08", "/ 0:07"))
    expect(chip.locator("time")).not_to_have_text(first)


def test_a_replay_is_accessible_and_fits_on_a_phone(page: Page, address: str) -> None:
    open_replay(page, address)
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.locator("[data-replay]")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    page.evaluate(Path(AXE).read_text(encoding="utf-8"))
    found = page.evaluate("axe.run({runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'best-practice']})")
    assert [(violation["id"], [node["html"] for node in violation["nodes"]]) for violation in found["violations"]] == []


def test_the_end_of_a_replay_is_said_and_is_no_lost_connection(page: Page, tmp_path: Path) -> None:
    with playing(write_gym_lesson(tmp_path, Gym(seconds=8.0)), tmp_path, "--once") as address:
        shown = open_replay(page, address)
        shown.wait_for_phase("ended")
        expect(page.get_by_text("The replay has ended")).to_be_visible()
        expect(page.get_by_text("No connection")).to_have_count(0)
