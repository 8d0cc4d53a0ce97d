"""Which KineBox this is."""

from importlib.metadata import version


def kinebox_version() -> str:
    """The version of the installed package."""
    return version("kinebox")
