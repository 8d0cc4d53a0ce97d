"""Troubles of the packages, the page and the kernels."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from services.doctor.finding import Examined
from services.doctor.installation import Installation, gather_installation
from services.tablet.page import PAGE
from tests.installed import DATA
from tests.integration.doctor_troubles.trouble import Stage, Trouble, examined
from tests.integration.house import House, build_house


def installed(spoil: Callable[[House], Installation]) -> Stage:
    """An installation that is looked at anew, spoilt."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        house = build_house(folder)
        yield examined(house, installation=lambda _: spoil(house))

    return stage


def _with_module(name: str, source: str) -> Callable[[House], Installation]:
    def spoil(house: House) -> Installation:
        folder = house.folder / "shadow"
        folder.mkdir()
        (folder / f"{name}.py").write_text(source)
        before = os.environ.get("PYTHONPATH")
        os.environ["PYTHONPATH"] = f"{folder}{os.pathsep}{before or ''}"
        try:
            return gather_installation(DATA)
        finally:
            os.environ.pop("PYTHONPATH") if before is None else os.environ.update(PYTHONPATH=before)

    return spoil


def _page_without_its_program(house: House) -> Installation:
    page = house.folder / "dist"
    page.mkdir()
    (page / "index.html").write_text('<script type="module" src="/assets/index-1.js"></script>')
    return gather_installation(DATA, page)


INSTALLATION: dict[str, Trouble] = {
    "the page is not built": Trouble(
        installed(lambda house: gather_installation(DATA, house.folder / "none")),
        "page",
        r"index\.html is missing",
        "run `make web`",
    ),
    "a file of the page is missing": Trouble(
        installed(_page_without_its_program), "page", r"assets/index-1\.js is missing", "run `make web`"
    ),
    "the kernels are not compiled": Trouble(
        installed(lambda house: gather_installation(house.data, PAGE)),
        "kernels",
        r"(\d+) of \1 numerical kernels are not compiled",
        "run `make kernels DATA=",
        "warning",
    ),
    "a package cannot be imported": Trouble(
        installed(_with_module("mcap", "import a_library_that_is_gone")),
        "package mcap",
        "cannot be imported: ModuleNotFoundError: .*a_library_that_is_gone",
        "run `make setup`",
    ),
    "a library is made for another processor": Trouble(
        installed(_with_module("av", "import os, signal; os.kill(os.getpid(), signal.SIGILL)")),
        "package av",
        r"cannot be imported: it ended its process \(SIGILL\)",
        "run `make setup`",
    ),
}
