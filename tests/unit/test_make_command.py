"""What people are told to run must fill the data folder that lacks something, not another one."""

import subprocess
from pathlib import Path

import pytest

from models.make_command import make_command
from models.networks import installed
from tests.installed import ROOT


def test_the_data_folder_that_make_takes_by_itself_is_not_named() -> None:
    assert make_command("networks", Path("build")) == "`make networks`"


@pytest.mark.parametrize("data", [Path("/srv/gym"), Path("other/build")])
def test_make_fills_the_folder_that_is_named(data: Path) -> None:
    told = make_command("networks", data).strip("`")
    plan = subprocess.run(
        ["sh", "-c", f"{told} --dry-run --no-print-directory --always-make"], capture_output=True, text=True, cwd=ROOT, check=False
    )
    assert f"models.networks.build.install --data {data}" in plan.stdout, plan.stderr


def test_the_remedy_of_networks_names_their_data_folder() -> None:
    file = Path("/srv/gym") / installed.FOLDER / installed.FILE_NAME
    assert installed.remedy(file) == f"delete {file} and run `make networks DATA=/srv/gym`"
