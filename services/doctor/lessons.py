"""Where lessons are kept: whether the recorder can begin one there, and whether their list can be kept."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from models.config.site import LessonsConfig, Site
from services.doctor.finding import Examined, Fact, Finding
from services.doctor.folders import KNOWN_BY, try_folder
from services.doctor.machine import DISK
from services.lesson.disk_room import make_room, shortage


@dataclass(frozen=True)
class LessonsFolder:
    """What was gathered.

    Attributes:
        folder: of the lessons.
        place: the folder, or what is there of the way to it: the recorder makes the rest.
        problem: why the place cannot be used; empty if it can, and if room is all that it lacks.
        lacking: why its disk takes no lesson; empty if it does.
        remedy: what to do if it takes none.
        beside_data: its disk is that of the data folder.
        index: what is no file and lies in the place of the list's; None if there is nothing of the kind.
    """

    folder: Path
    place: Path
    problem: str
    lacking: str
    remedy: str
    beside_data: bool
    index: Path | None


def gather_lessons(site: Site | None, data: Path, free_disk_mib: Callable[[Path], float]) -> LessonsFolder | None:
    """Look where a site has its lessons, without a site where they are by default; None if there is no data folder to look in."""
    if not data.is_dir():
        return None
    config = LessonsConfig() if site is None else site.lessons
    folder = data / config.folder
    place = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
    found = None if place == data else try_folder(place)  # The data folder is examined anyway.
    full = found is not None and found.full
    problem = "" if found is None or full else found.words
    lacking = shortage(free_disk_mib(folder), config) or (f"{place} {found.words}" if found is not None and full else "")
    index = None if problem else _index(folder)
    return LessonsFolder(folder, place, problem, lacking, make_room(folder, config), _one_disk(place, data), index)


def judge_lessons(lessons: LessonsFolder | None) -> Examined:
    """What is wrong with it, and where it is."""
    if lessons is None:
        return Examined()
    if lessons.problem:
        words = f"nothing can be recorded: {lessons.place} {lessons.problem}"
        remedy = "give it another name, mount its disk, or correct its owner and rights; or correct lessons.folder in the site file"
        return Examined((Finding("fault", "lessons", words, KNOWN_BY, remedy),))
    findings = [each for each in (_room(lessons), _list(lessons)) if each is not None]
    facts = () if lessons.lacking else (Fact("lessons", f"can be recorded in {lessons.folder}"),)
    return Examined(tuple(findings), facts)


def _room(lessons: LessonsFolder) -> Finding | None:
    if not lessons.lacking:
        return None
    words = f"nothing can be recorded in {lessons.folder}: {lessons.lacking}"
    cause = DISK if lessons.beside_data else ""
    return Finding("fault", "lessons", words, "the file system of the folder of lessons", lessons.remedy, cause)


def _list(lessons: LessonsFolder) -> Finding | None:
    if lessons.index is None:
        return None
    words = f"the list of lessons cannot be kept: {lessons.index} is no file; every look at the list reads all lessons"
    return Finding("warning", "lessons", words, "looking for the list's file", "give it another name; the list is made anew")


def _one_disk(one: Path, other: Path) -> bool:
    try:
        return one.stat().st_dev == other.stat().st_dev
    except OSError:
        return False  # A link that leads nowhere, of which more is told.


def _index(folder: Path) -> Path | None:
    try:
        from services.lesson.index import NAME  # noqa: PLC0415 - needs packages that may be what is broken
    except ImportError:
        return None  # It is found of the packages.
    index = folder / NAME
    return index if index.exists() and not index.is_file() else None
