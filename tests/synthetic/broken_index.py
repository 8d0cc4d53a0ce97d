"""An index of lessons that opens and reads like a good one, and is malformed where it is written to."""

import sqlite3
from pathlib import Path

from services.lesson import index


def break_index(folder: Path) -> None:
    """Garble the page in which the index of a folder looks names up."""
    file = folder / index.NAME
    connection = sqlite3.connect(file)
    (page_size,) = connection.execute("PRAGMA page_size").fetchone()
    (page,) = connection.execute("SELECT rootpage FROM sqlite_schema WHERE type = 'index'").fetchone()
    connection.close()
    with file.open("r+b") as opened:
        opened.seek((page - 1) * page_size)
        opened.write(b"\xff" * 100)
