"""What the doctor says to do about a bad standard of the school's own can be done, and helps."""

import shlex
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from models.regular_file import MOST_TEXT_BYTES
from services.cli.standard_commands import standard_app
from services.doctor.configuration import gather_configuration, gather_inspected
from services.evaluation.inspect import inspect
from services.support.own_standards import OwnStandards
from tests.installed import ROOT
from tests.taught import shipped

SITE = ROOT / "deploy/sites/simulated/site.toml"


def faults(data: Path, site: Path | None = None) -> list[str]:
    """Of all that is taught, as the doctor asks for them."""
    found = gather_inspected(gather_configuration(site), data, (inspect,))
    return [each.fault for each in found if each.fault]


def with_one_kept(own: Path) -> OwnStandards:
    """A school that had a squat of its own, and has another one."""
    standards = OwnStandards(own)
    for origin in ("before", "now"):
        standards.put(replace(shipped().standards["squat"], origin=origin))
    return standards


def site_with(folder: Path, teaching: str) -> Path:
    site = folder / "the site.toml"
    shutil.copy(SITE.parent / "rig.toml", folder)
    site.write_text(f'{SITE.read_text()}\n[evaluation]\nteaching = "{teaching}"\n')
    return site


@pytest.mark.parametrize(("named", "kept"), [(True, True), (True, False), (False, True)])
def test_the_command_for_a_damaged_standard_brings_back_the_one_before_in_the_folder_that_was_looked_at(
    tmp_path: Path, named: bool, kept: bool
) -> None:
    data = tmp_path / "two words"
    data.mkdir()
    site, own = (site_with(tmp_path, "ours"), data / "ours") if named else (None, data / "school")
    standards = with_one_kept(own)
    if not kept:
        shutil.rmtree(standards.folder / "versions")
    standards.file("squat").write_bytes(b"damaged")
    (fault,) = faults(data, site)
    words = shlex.split(fault.split("`")[1])
    done = CliRunner().invoke(standard_app, words[2:])
    assert (words[:2], done.exit_code) == (["kinebox", "standard"], 0)
    assert faults(data, site) == []
    assert standards.counts("squat").origin == ("before" if kept else shipped().standards["squat"].origin)


def test_the_command_names_no_site_file_that_cannot_be_read(tmp_path: Path) -> None:
    with_one_kept(tmp_path / "school").file("squat").write_bytes(b"damaged")
    (fault,) = faults(tmp_path, tmp_path / "gone.toml")
    assert fault.endswith(f"; run `kinebox standard restore squat --data {tmp_path}`: the one before counts again")


def test_nothing_is_to_be_brought_back_if_the_one_before_is_damaged_too(tmp_path: Path) -> None:
    standards = with_one_kept(tmp_path / "school")
    for file in (standards.file("squat"), standards.kept("squat")[0].file):
        file.write_bytes(b"damaged")
    (fault,) = faults(tmp_path)
    assert fault.endswith("squat.npz: is no standard's file, or is damaged; export or record it again")


def test_what_cannot_be_opened_is_not_to_be_replaced_by_a_command_that_has_to_open_it(tmp_path: Path) -> None:
    with with_one_kept(tmp_path / "school").file("squat").open("wb") as file:
        file.truncate(MOST_TEXT_BYTES + 1)
    (fault,) = faults(tmp_path)
    assert fault.endswith("; correct its permissions, or remove it")
