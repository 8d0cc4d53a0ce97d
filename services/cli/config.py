"""`kinebox config`: look at a site file and bring it to the newest version."""

import datetime as dt
import difflib
from pathlib import Path

from models.errors import UserError
from services.logs.printable import printable
from services.site_file import rendering
from services.site_file.migration import MigratedText, migrate_file, migrated_text
from services.site_file.reading import read_file, read_site
from services.support.teaching_files import is_outside


def check(file: Path) -> str:
    """What there is to say of a good site file; UserError for one that is not."""
    site, rig = read_site(file)
    teaching = site.evaluation.teaching
    if is_outside(teaching):  # The box refuses it at its start; a lesson from elsewhere that has it can be read.
        allowed = "a folder in the data folder, relative to it"
        raise UserError(f'site file {file}: [evaluation] teaching: found "{teaching}", but allowed is {allowed}; correct it')
    return f"{file} is good: '{printable(site.name)}' with {len(rig)} calibrated cameras ({', '.join(rig.names)})\n"


def show(file: Path) -> str:
    """The site file with every value that it leaves to its default."""
    site, _ = read_site(file)
    return rendering.render(site)


def migrate(file: Path, dry_run: bool) -> str:
    """Migrate a site file, or only tell what would become different; what there is to say of it."""
    if dry_run:
        texts = migrated_text(read_file(file, "site file"), file)
        return _difference(texts, file) or _nothing_to_do(file, texts)
    texts, backup = migrate_file(file, dt.datetime.now(dt.UTC))
    if backup is None:
        return _nothing_to_do(file, texts)
    return f"{_difference(texts, file)}{file} is migrated; what it was is in {backup}\n"


def _difference(texts: MigratedText, file: Path) -> str:
    old, new = (text.splitlines(keepends=True) for text in (texts.old, texts.new))
    lines = difflib.unified_diff(old, new, f"{file} (version {texts.old_version})", f"{file} (migrated)")
    return "".join(line if line.endswith("\n") else f"{line}\n" for line in lines)


def _nothing_to_do(file: Path, texts: MigratedText) -> str:
    return f"{file} is of version {texts.old_version}, the newest; nothing to do\n"
