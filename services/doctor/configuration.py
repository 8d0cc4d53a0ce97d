"""The site: its file, its calibration, and what the parts of the box need for it."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from models.camera.rig import Rig
from models.config.site import Site
from models.errors import UserError
from models.inspection import Inspected, Inspection
from services.doctor.finding import Examined, Fact, Finding, fault_of
from services.site_file.reading import read_site


@dataclass(frozen=True)
class Configuration:
    """What was gathered.

    Attributes:
        file: the site file; None if none was given.
        site, rig: what it says; None if it cannot be used.
        error: why not.
    """

    file: Path | None
    site: Site | None = None
    rig: Rig | None = None
    error: str = ""


def gather_configuration(file: Path | None) -> Configuration:
    """Read the site file and its calibration."""
    if file is None:
        return Configuration(None)
    try:
        site, rig = read_site(file)
    except UserError as error:
        return Configuration(file, error=str(error))
    return Configuration(file, site, rig)


def judge_configuration(configuration: Configuration) -> Examined:
    """What is wrong with it, and what it is."""
    if configuration.error:
        where = "calibration" if "calibration" in configuration.error.split(":", 1)[0] else "site file"
        return Examined((fault_of(where, configuration.error, "reading it as a start of the box does"),))
    if configuration.site is None or configuration.rig is None:
        return Examined(facts=(Fact("site", "none was given; name its file with --site to have it examined"),))
    names = ", ".join(configuration.rig.names)
    facts = (Fact("site", f"'{configuration.site.name}', {len(configuration.rig)} calibrated cameras: {names}"),)
    return Examined(_rehearsal(configuration.site), facts)


def _rehearsal(site: Site) -> tuple[Finding, ...]:
    if not site.faults:
        return ()
    sick = ", ".join(sorted({fault.camera for fault in site.faults}))
    words = f"the site file asks for faults on demand: {sick} will fall ill on purpose"
    return (Finding("warning", "site file", words, "its tables [[faults]]", "remove them before a lesson"),)


def gather_inspected(configuration: Configuration, data: Path, inspections: Iterable[Inspection]) -> list[Inspected]:
    """Have every part look at its things."""
    site, rig = configuration.site, configuration.rig
    file = None if site is None else configuration.file  # No command can go by one that cannot be read.
    return [each for inspect in inspections for each in inspect(site, rig, data, file)]


def judge_inspected(inspected: Iterable[Inspected]) -> Examined:
    """What is wrong with the parts' things, and what is good."""
    things = list(inspected)
    findings: tuple[Finding, ...] = tuple(fault_of(each.what, each.fault, each.known_by) for each in things if each.fault)
    good = [each.what for each in things if not each.fault]
    facts = (Fact("files", f"unharmed: {', '.join(good)}"),) if good else ()
    return Examined(findings, facts)
