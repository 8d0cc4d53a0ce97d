"""What `kinebox doctor` asks a part of the box: to look closely at what it needs, and tell all of it, good or bad.

A check (`models.process.Check`) is made before every start, so it is quick and ends with the first fault. An inspection is made
when a person wants to know what is wrong: it reads every byte and finds every fault.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from models.camera.rig import Rig
from models.config.site import Site


@dataclass(frozen=True)
class Inspected:
    """One thing that a part looked at.

    Attributes:
        what: "network nanodet", "camera 'cam01'".
        known_by: how it was looked at: "comparing its hash with the installation's".
        fault: what is wrong and what to do, as in a `UserError`; empty if it is good.
    """

    what: str
    known_by: str
    fault: str = ""


Inspection = Callable[[Site | None, Rig | None, Path, Path | None], list[Inspected]]
"""Looks at a part's things in the data folder; without a site at those that every site needs.

Given are the site, its rig, the data folder, and the site's file, for commands that are told to people; None without a site.
"""
