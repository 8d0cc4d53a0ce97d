"""What was prepared: names, sizes and hashes, so that a truncated or changed file is found without decoding it."""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from edge.simulation.lesson.files import FOLDER, SHIPPED
from models.make_command import make_command

INDEX_NAME = "installed.json"


@dataclass(frozen=True)
class Index:
    """The files of a folder as they were when they were prepared; `recipe` names the way they were made."""

    recipe: str
    files: dict[str, tuple[int, str]]

    @classmethod
    def of(cls, recipe: str, paths: list[Path]) -> "Index":
        """Measure files that were just written."""
        return cls(recipe, {path.name: (path.stat().st_size, sha256(path)) for path in paths})

    @classmethod
    def read(cls, folder: Path) -> "Index | None":
        """The folder's index; None if there is none that can be read, which means: prepare again."""
        try:
            record = json.loads((folder / INDEX_NAME).read_text(encoding="utf-8"))
            files = {str(name): (int(entry["bytes"]), str(entry["sha256"])) for name, entry in record["files"].items()}
            return cls(str(record["recipe"]), files)
        except (OSError, ValueError, LookupError, TypeError, AttributeError):
            return None

    def write(self, folder: Path) -> None:
        """Write the index last and at once, so that its presence says that everything was finished."""
        files = {name: {"bytes": size, "sha256": digest} for name, (size, digest) in self.files.items()}
        part = folder / f"{INDEX_NAME}.part"
        part.write_text(json.dumps({"recipe": self.recipe, "files": files}, indent=1) + "\n", encoding="utf-8")
        part.replace(folder / INDEX_NAME)

    def damaged(self, folder: Path) -> list[str]:
        """Names of files that are missing or not as they were, in order."""
        return [name for name, (size, digest) in self.files.items() if not _is_as(folder / name, size, digest)]


def _is_as(path: Path, size: int, digest: str) -> bool:
    return path.is_file() and path.stat().st_size == size and sha256(path) == digest


def sha256(path: Path) -> str:
    """Hexadecimal digits of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def remedy(folder: Path) -> str:
    """What to do about a prepared footage or a lesson in `folder` that is harmed."""
    if folder.parent.name != FOLDER:
        return f"delete {folder / INDEX_NAME} and run {make_command(f'footage SOURCE={folder.name}', folder.parent)}"
    if folder.name != SHIPPED:
        return f"delete {folder} and run `kinebox simulate` again"
    return f"delete {folder / INDEX_NAME} and run {make_command('simulated', folder.parent.parent)}"
