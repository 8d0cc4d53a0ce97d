"""Where lessons are kept: whether the recorder can begin one there, and whether their list can be kept."""

import os
from dataclasses import dataclass
from pathlib import Path

from models.config.site import LessonsConfig, Site
from services.doctor.finding import Examined, Fact, Finding
from services.doctor.folders import KNOWN_BY, try_folder


@dataclass(frozen=True)
class LessonsFolder:
    """What was gathered.

    Attributes:
        folder: of the lessons.
        place: the folder, or what is there of the way to it: the recorder makes the rest.
        problem: why the place cannot be used; empty if it can.
        index: what is no file and lies in the place of the list's; None if there is nothing of the kind.
    """

    folder: Path
    place: Path
    problem: str
    index: Path | None


def gather_lessons(site: Site | None, data: Path) -> LessonsFolder | None:
    """Look where a site has its lessons, without a site where they are by default; None if there is no data folder to look in."""
    if not data.is_dir():
        return None
    folder = data / (LessonsConfig() if site is None else site.lessons).folder
    place = next(each for each in (folder, *folder.parents) if os.path.lexists(each))
    problem = "" if place == data else try_folder(place)  # The data folder is examined anyway.
    return LessonsFolder(folder, place, problem, None if problem else _index(folder))


def judge_lessons(lessons: LessonsFolder | None) -> Examined:
    """What is wrong with it, and where it is."""
    if lessons is None:
        return Examined()
    if lessons.problem:
        words = f"nothing can be recorded: {lessons.place} {lessons.problem}"
        remedy = "give it another name, mount its disk, or correct its owner and rights; or correct lessons.folder in the site file"
        return Examined((Finding("fault", "lessons", words, KNOWN_BY, remedy),))
    facts = (Fact("lessons", f"can be recorded in {lessons.folder}"),)
    if lessons.index is None:
        return Examined(facts=facts)
    words = f"the list of lessons cannot be kept: {lessons.index} is no file; every look at the list reads all lessons"
    remedy = "give it another name; the list is made anew"
    return Examined((Finding("warning", "lessons", words, "looking for the list's file", remedy),), facts)


def _index(folder: Path) -> Path | None:
    try:
        from services.lesson.index import NAME  # noqa: PLC0415 - needs packages that may be what is broken
    except ImportError:
        return None  # It is found of the packages.
    index = folder / NAME
    return index if index.exists() and not index.is_file() else None
