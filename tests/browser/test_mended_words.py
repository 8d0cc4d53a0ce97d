"""A school's file that was half saved while the page's server was started: what an open page says, and once it is mended."""

from importlib import resources
from pathlib import Path

import msgspec
import pytest
from playwright.sync_api import Page, expect

import models.teaching
from models.messages.feedback import Feedback
from services.tablet import process
from tests.browser import room as room_module
from tests.browser.attempts import tried
from tests.browser.room import Room
from tests.browser.shown_attempts import FAULT, SHOT, see
from tests.browser.test_page import open_live
from tests.browser.test_silence import WORDLESS
from tests.taught import shipped

pytestmark = [pytest.mark.browser, pytest.mark.slow]


@pytest.fixture
def file(room: Room, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The school's own file, of which half was saved as the page's server was started."""
    made = tmp_path / "school/actions" / f"{SHOT}.toml"
    made.parent.mkdir(parents=True)
    made.write_text("version = 1\n", encoding="utf-8")
    monkeypatch.setattr(room_module, "PAGE", tmp_path)
    monkeypatch.setattr(process, "AGAIN_AFTER_S", 0.2)
    room.stop_server()
    room.start_server()
    return made


def own(fault: str) -> str:
    """A fault as only the school's file names it."""
    return f"own_{fault}" if fault else ""


def by_the_schools_file(made: Feedback) -> Feedback:
    """The same attempt, judged by the school's file, which the evaluation may read before the page's server does."""
    judgements = tuple(msgspec.structs.replace(one, fault=own(one.fault)) for one in made.judgements)
    return msgspec.structs.replace(made, cue=own(made.cue), praise=own(made.praise), judgements=judgements)


def mended(made: Feedback) -> str:
    """The whole file: KineBox's own, with the school's names for faults."""
    text = resources.files(models.teaching).joinpath(f"actions/{SHOT}.toml").read_text(encoding="utf-8")
    for one in made.judgements:
        text = text.replace(f'name = "{one.fault}"', f'name = "{own(one.fault)}"')
    return text


def test_an_open_page_takes_the_words_that_were_mended(tablet: Page, room: Room, file: Path) -> None:
    shown, made = open_live(tablet, room), tried(SHOT, FAULT)
    see(shown, room, by_the_schools_file(made))
    card = tablet.locator(".feedback")
    expect(card.locator("[data-wordless]")).to_have_text(WORDLESS)
    expect(card.locator("[data-cue], [data-praise], [data-silence]")).to_have_count(0)
    file.write_text(mended(made), encoding="utf-8")
    words = {fault.name: fault for fault in shipped().teachings[SHOT].fault}
    expect(card.locator("[data-cue]")).to_contain_text(words[made.cue].cue.en)
    expect(card.locator("[data-praise]")).to_have_text(words[made.praise].praise.en)
    expect(card.locator("[data-wordless]")).to_have_count(0)
