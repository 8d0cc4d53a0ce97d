"""A site file brought to the newest version: the person's comments and order kept, the old file beside it, never half written.

The migrations themselves (`models.config.migrations`) know nothing of comments. Here what they changed is carried over into the
text, and the text is read again before anything is written: it must say exactly what the migrations said, and load.
"""

import datetime as dt
import os
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import tomlkit
from tomlkit.container import Container
from tomlkit.items import AbstractTable, AoT, Array, SingleKey

from models.config.migrations import migrate
from models.config.site import decode_site, site_version
from models.errors import UserError
from services.site_file.reading import read_file
from services.support.sync import sync_folder

Table = dict[str, Any]


class MigratedText(NamedTuple):
    """A site file before and after."""

    old_version: int
    old: str
    new: str


def migrated_text(data: bytes, origin: Path | str) -> MigratedText:
    """What a site file becomes; the same text if it is of the newest version.

    Raises:
        UserError: the file is no TOML, of an unknown version, or would not load after its migration; the line names the key.
    """
    version = site_version(data, origin)
    text = data.decode()
    old = tomllib.loads(text)
    try:
        new = migrate(old)
    except UserError as error:
        raise UserError(f"site file {origin}: {error}") from error
    if new == old:
        return MigratedText(version, text, text)
    written = rewritten(text, new)
    decode_site(written.encode(), f"{origin}, once migrated, would be refused and was left as it is")
    return MigratedText(version, text, written)


def rewritten(text: str, new: Table) -> str:
    """The text of a TOML file changed so that it says `new`; what stays keeps its place and its comments.

    A layout that the library for comments cannot change loses its comments, never a value.
    """
    document = tomlkit.parse(text)
    _carry_over(document, tomllib.loads(text), new)
    changed = tomlkit.dumps(document)
    return changed if _says(changed, new) else tomlkit.dumps(new)


def _says(text: str, wanted: Table) -> bool:
    try:
        return tomllib.loads(text) == wanted
    except tomllib.TOMLDecodeError:
        return False


def migrate_file(path: Path, now: dt.datetime) -> tuple[MigratedText, Path | None]:
    """Migrate a site file in its place; the texts and where the old one was put, None if there was nothing to do.

    Args:
        path: the site file; of a link, the file that it leads to.
        now: the time, for the name of the backup.

    Raises:
        UserError: as `migrated_text`, or the backup or the file cannot be written, and then the file is as it was; or the file is
            migrated, but not safe against a power cut.
    """
    file = path.resolve()
    texts = migrated_text(read_file(path, "site file"), path)
    if texts.new == texts.old:
        return texts, None
    backup = file.with_name(f"{file.name}.bak-{texts.old_version}-{now.astimezone(dt.UTC):%Y%m%dT%H%M%SZ}")
    named = backup if path.is_symlink() else path.with_name(backup.name)  # As the person named the file; of a link, where it is.
    try:
        _write_new(backup, file.read_bytes(), file.stat().st_mode)
        _replace(file, texts.new.encode())
    except OSError as error:
        raise UserError(
            f"site file {path} cannot be migrated: {error.strerror} ({error.filename or file}) and was left as it is; "
            "make room on its disk or correct its folder's owner and rights, then do it again"
        ) from error
    try:
        sync_folder(file.parent)
    except OSError as error:
        raise UserError(
            f"site file {path} was migrated, but a power cut may still undo it: {error.strerror}; mend its disk, "
            f"and see that the file says 'version = {site_version(texts.new.encode(), path)}' (the old one is {named})"
        ) from error
    return texts, named


def _carry_over(container: Container | AbstractTable, old: Table, new: Table) -> None:
    """Change the text of a table, which says `old`, to what `new` says: keys renamed, values set, each in its place."""
    gone = [key for key in old if key not in new]
    for added in (key for key in new if key not in old):
        renamed = next((key for key in gone if old[key] == new[added]), None)
        if renamed is None:
            container[added] = new[added]
        else:
            gone.remove(renamed)
            _rename(container, renamed, added)
    for key in gone:
        container.remove(key)
    for key in old.keys() & new.keys():
        _carry_over_value(container, key, old[key], new[key])


def _carry_over_value(container: Container | AbstractTable, key: str, old: object, new: object) -> None:
    if old == new:
        return
    item = container[key]
    if isinstance(item, AoT | Array) and isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for table, before, after in zip(item, old, new, strict=True):
            if isinstance(table, AbstractTable) and before != after:
                _carry_over(table, before, after)
    elif isinstance(item, Container | AbstractTable) and isinstance(old, dict) and isinstance(new, dict):
        _carry_over(item, old, new)
    else:
        container[key] = new


def _rename(container: Container | AbstractTable, old: str, new: str) -> None:
    """Rename a key where it stands. To remove and add it would move it to the table's end, behind the next table's comments."""
    body = (container.value if isinstance(container, AbstractTable) else container).body
    for index, (key, item) in enumerate(body):
        if key is not None and key.key == old:
            written = key.as_string().replace(old, new, 1) if old in key.as_string() else None
            body[index] = (SingleKey(new, sep=key.sep, original=written), item)


def _replace(file: Path, data: bytes) -> None:
    temporary = file.with_name(f".{file.name}.{os.getpid()}.tmp")
    try:
        _write_new(temporary, data, file.stat().st_mode)
        temporary.replace(file)
    finally:
        temporary.unlink(missing_ok=True)


def _write_new(path: Path, data: bytes, mode: int) -> None:
    """A file that was not there before, safe on the disc; nothing of it is left if that fails."""
    try:
        with path.open("xb") as file:
            os.fchmod(file.fileno(), mode & 0o777)
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
    except FileExistsError:
        raise
    except OSError:
        path.unlink(missing_ok=True)
        raise
    sync_folder(path.parent)
