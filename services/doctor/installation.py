"""What was installed: Python, its packages, the page, the compiled kernels."""

import json
import os
import re
import sys
from dataclasses import dataclass, field, replace
from importlib import metadata
from pathlib import Path

from packaging.specifiers import SpecifierSet

from models.make_command import make_command
from services.doctor.apart import REMEDY, import_finding, import_problems, run_module
from services.doctor.finding import Examined, Fact, Finding
from services.support.environment import process_environment
from services.support.requirements import DISTRIBUTION, installed_version, required_packages
from services.support.version import kinebox_version
from services.tablet.page import PAGE

_ASSET = re.compile(r'(?:src|href)="/(assets/[^"]+)"')


@dataclass(frozen=True)
class Package:
    """A package that KineBox needs.

    Attributes:
        wanted: the versions that will do, as in the project's description.
        installed: its version; None if it is not there.
        fits: whether that version will do.
        problem: why it cannot be imported; empty if it can.
    """

    name: str
    wanted: str
    installed: str | None
    fits: bool
    problem: str = ""


@dataclass(frozen=True)
class Installation:
    """What was gathered.

    Attributes:
        python, python_wanted: the version that runs, and those that will do.
        page_lacks: files of the built page that are missing.
        kernels: how many have to be compiled; None if that cannot be known, for `kernels_problem`.
        kernels_lacking: those that are not, or for another processor or version of the code.
        kernel_folder: where they are kept.
    """

    version: str
    python: str
    python_wanted: str
    packages: tuple[Package, ...]
    page: Path
    page_lacks: tuple[str, ...]
    kernels: int | None
    kernel_folder: Path
    kernels_lacking: tuple[str, ...] = ()
    kernels_problem: str = ""
    python_fits: bool = field(default=True)


def gather_installation(data: Path, page: Path = PAGE) -> Installation:
    """Look at what this Python has, importing every package once in processes of their own."""
    python = ".".join(map(str, sys.version_info[:3]))
    wanted = metadata.metadata(DISTRIBUTION)["Requires-Python"]
    kernels, lacking, problem = _kernels(data)
    return Installation(
        version=kinebox_version(),
        python=python,
        python_wanted=wanted,
        python_fits=SpecifierSet(wanted).contains(python, prereleases=True),
        packages=_packages(),
        page=page,
        page_lacks=_page_lacks(page),
        kernels=kernels,
        kernels_lacking=lacking,
        kernels_problem=problem,
        kernel_folder=data / "kernels",
    )


def judge_installation(installation: Installation) -> Examined:
    """What is wrong with it, and what it is."""
    findings = [
        *_judge_python(installation),
        *_judge_packages(installation),
        *_judge_page(installation),
        *_judge_kernels(installation),
    ]
    good = sum(package.fits and not package.problem for package in installation.packages)
    compiled = (installation.kernels or 0) - len(installation.kernels_lacking)
    facts = (
        Fact("KineBox", f"{installation.version} on Python {installation.python}"),
        Fact("packages", f"{good} of {len(installation.packages)} are there and can be imported"),
        Fact("page", "not built" if installation.page_lacks else "built, with every file"),
        Fact("kernels", f"{compiled} of {'?' if installation.kernels is None else installation.kernels} are compiled"),
    )
    return Examined(tuple(findings), facts)


def _judge_python(installation: Installation) -> list[Finding]:
    if installation.python_fits:
        return []
    words = f"Python is {installation.python}, but KineBox needs {installation.python_wanted}"
    return [Finding("fault", "Python", words, "the running interpreter", "install one of those, delete .venv and run `make setup`")]


def _judge_packages(installation: Installation) -> list[Finding]:
    findings = []
    for package in installation.packages:
        where = f"package {package.name}"
        if package.installed is None:
            findings.append(Finding("fault", where, f"{package.name} is not installed", "the list of installed packages", REMEDY))
        elif package.problem:
            findings.append(import_finding(package.name, package.problem, package.installed))
        elif not package.fits:
            words = f"{package.name} is {package.installed}, but KineBox needs {package.wanted}"
            findings.append(Finding("fault", where, words, "the list of installed packages", REMEDY))
    return findings


def _judge_page(installation: Installation) -> list[Finding]:
    if not installation.page_lacks:
        return []
    first, *others = installation.page_lacks
    more = f" and {len(others)} other files" if others else ""
    words = f"the page is not built whole: {installation.page / first}{more} is missing"
    return [Finding("fault", "page", words, "the files that its first one names", "run `make web`")]


def _judge_kernels(installation: Installation) -> list[Finding]:
    folder = installation.kernel_folder
    make = make_command("kernels", folder.parent)
    if installation.kernels is None:
        words = f"the numerical kernels cannot be looked at: {installation.kernels_problem}"
        return [Finding("fault", "kernels", words, "loading them in a process of its own", f"run {make}")]
    if not installation.kernels_lacking:
        return []
    names = ", ".join(installation.kernels_lacking[:3]) + (" ..." if len(installation.kernels_lacking) > 3 else "")
    words = (
        f"{len(installation.kernels_lacking)} of {installation.kernels} numerical kernels are not compiled for this code and "
        f"processor ({names}); the next start takes about a minute longer"
    )
    return [Finding("warning", "kernels", words, f"numba's index in {folder}", f"delete {folder} and run {make}")]


def _packages() -> tuple[Package, ...]:
    modules = {name: module for module, names in metadata.packages_distributions().items() for name in map(_canonical, names)}
    found = []
    for requirement in required_packages():
        installed = installed_version(requirement.name)
        fits = installed is not None and requirement.specifier.contains(installed, prereleases=True)
        found.append(Package(requirement.name, str(requirement.specifier), installed, fits))
    imported = {each.name: module for each in found if (module := modules.get(_canonical(each.name)))}
    problems = import_problems(imported.values())
    return tuple(replace(each, problem=problems.get(imported.get(each.name, ""), "")) for each in found)


def _kernels(data: Path) -> tuple[int | None, tuple[str, ...], str]:
    """How many kernels there are, which are not compiled, and why that cannot be known."""
    ended = run_module("services.doctor.kernels", environment=dict(os.environ) | process_environment(data))
    try:
        told = json.loads(ended.output)
        return int(told["kernels"]), tuple(told["lacking"]), ""
    except (ValueError, LookupError, TypeError):
        return None, (), (ended.errors.strip().splitlines() or [ended.how])[-1]


def _page_lacks(page: Path) -> tuple[str, ...]:
    try:
        first = (page / "index.html").read_text(encoding="utf-8")
    except OSError:
        return ("index.html",)
    return tuple(name for name in _ASSET.findall(first) if not (page / name).is_file())


def _canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()
