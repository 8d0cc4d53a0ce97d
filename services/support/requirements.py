"""The packages that KineBox needs, and which versions of them are installed."""

from importlib import metadata

from packaging.requirements import Requirement

DISTRIBUTION = "kinebox"


def required_packages() -> list[Requirement]:
    """What this Python on this machine must have; without extras, which are for those who develop."""
    requirements = [Requirement(line) for line in metadata.requires(DISTRIBUTION) or ()]
    return [each for each in requirements if each.marker is None or each.marker.evaluate({"extra": ""})]


def installed_version(package: str) -> str | None:
    """Its version; None if it is not installed."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None
