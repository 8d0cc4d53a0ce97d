"""The box that a replay starts: of the recorded site only what was in the room counts."""

from dataclasses import replace
from pathlib import Path

import msgspec

from models.config.site import EvaluationConfig, Site, TabletConfig
from services.cli.replay import replay_site
from services.site_file.rendering import render
from tests.integration.fusion_room import SITE, header

PAGE = TabletConfig(host="127.0.0.1", port=8099)
RECORDED = EvaluationConfig(activity="an_action_of_that_day", language="de", teaching="ours")


def replayed(data: Path, evaluation: EvaluationConfig) -> Site:
    site: Site = msgspec.structs.replace(SITE, evaluation=evaluation)
    return replay_site(replace(header(), site_toml=render(site)), PAGE, data)


def test_what_the_school_taught_counts_if_it_is_still_there(tmp_path: Path) -> None:
    assert replayed(tmp_path, RECORDED).evaluation == EvaluationConfig(language="de")
    (tmp_path / "ours").mkdir()
    assert replayed(tmp_path, RECORDED).evaluation == EvaluationConfig(language="de", teaching="ours")
    assert replayed(tmp_path, EvaluationConfig()).evaluation == EvaluationConfig()


def test_what_is_taught_is_never_read_from_outside_the_data_folder(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "theirs").mkdir()
    for teaching in ("../theirs", str(tmp_path / "theirs")):
        assert replayed(tmp_path / "data", EvaluationConfig(teaching=teaching)).evaluation == EvaluationConfig()


def test_a_replay_has_addresses_of_its_own_and_no_spares(tmp_path: Path) -> None:
    site = replayed(tmp_path, RECORDED)
    assert site.tablet == PAGE
    assert site.bus.endpoint != SITE.bus.endpoint
    assert not site.supervisor.spares
    assert site.name == SITE.name
