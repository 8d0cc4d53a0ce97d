"""A box without a built page is refused before anything is started, as a lesson's replay is."""

from importlib.metadata import entry_points
from itertools import islice
from pathlib import Path

import pytest

from models.config.site import TabletConfig
from models.errors import UserError
from services.cli import replay
from services.cli.parts import CHECKS
from services.lesson.lesson_file import LessonWriter
from services.tablet import check
from tests.integration.fusion_room import RIG, SITE
from tests.ports import free_port
from tests.synthetic.gym import T0_NS, Gym
from tests.synthetic.gym_lesson import gym_header
from tests.synthetic.lesson_log import entries, parts

GYM = Gym(seconds=1.0)
NOT_BUILT = r"^tablet: the page is not built .*; run 'make web'$"


def test_a_page_that_is_not_built_is_found_by_what_a_start_checks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (checked,) = [entry.load() for entry in entry_points(group=CHECKS) if entry.name == "tablet"]
    monkeypatch.setattr(check, "PAGE", tmp_path)
    with pytest.raises(UserError, match=NOT_BUILT):
        checked(SITE, RIG, tmp_path)
    (tmp_path / "index.html").touch()
    checked(SITE, RIG, tmp_path)


def test_a_page_that_is_not_built_starts_no_replay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def start(*_: object) -> None:
        raise AssertionError("started")

    monkeypatch.setattr(replay, "PAGE", tmp_path)
    monkeypatch.setattr(replay, "supervise", start)
    writer = LessonWriter.create(tmp_path, "short", gym_header(GYM))
    for part in parts(islice(entries(GYM.events(), GYM.rig), 3), T0_NS):
        writer.append(part)
    file = writer.finish()
    with pytest.raises(UserError, match=NOT_BUILT):
        replay.play(file, tmp_path, TabletConfig(host="127.0.0.1", port=free_port()), 1.0, loop=True)
