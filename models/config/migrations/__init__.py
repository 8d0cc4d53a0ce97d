"""From the site file of an older KineBox to today's: one function a version, each from a whole file to a whole file.

A site file is here what its TOML says, as dictionaries, lists and scalars: it may be wrong in any way, since its schema is checked
only after the last migration. What a migration does not know it passes on, and the schema then names it.

To add version n: write `to_n.py`, append it to `MIGRATIONS`, raise `SITE_VERSION`, and put a file of version n - 1 into
`tests/golden/sites`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from models.config.migrations import to_2

Table = dict[str, Any]


@dataclass(frozen=True)
class Migration:
    """One step.

    Attributes:
        version: what the step leads to, from the one before it.
        change: what became different and why, for the people who write site files.
        apply: the step; it leaves its argument as it is. Raises UserError if it would lose what somebody wrote.
    """

    version: int
    change: str
    apply: Callable[[Table], Table]


MIGRATIONS = (Migration(2, to_2.CHANGE, to_2.apply),)
FIRST_VERSION = MIGRATIONS[0].version - 1


def migrate(site: Table) -> Table:
    """The same site in the newest version; a newer one, or one whose version is none, is returned as it is.

    Raises:
        UserError: a step would lose what somebody wrote; the line names the key.
    """
    for step in MIGRATIONS:
        version = site.get("version")
        # In TOML `true` is no number, but in Python it equals 1.
        if type(version) is int and version == step.version - 1:
            site = step.apply(site) | {"version": step.version}
    return site
