"""What pictures depend on beside the plan: the code that makes them, whatever is written about it, and the data that it reads.

So a rendered lesson is found again for as long as it would come out the same, and made anew when it would not, without anybody
having to remember to raise a number.
"""

import ast
import hashlib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_ROOT = Path(__file__).parents[3]
_CODE = ("edge/simulation", "models/body", "models/camera", "models/motions", "models/skeleton")
_FILES = ("edge/footage/transcode.py", "models/compiled.py")
_DATA = ("models/body/data", "models/motions/data")
_NO_PICTURES = {"command.py", "lesson_rig.py", "presets.py", "recipe.py", "render_lesson.py", "strip.py", "workers.py"}
_NOT_RUN = {"build", "recorded", "shipped"}


@cache
def recipe() -> str:
    """64 hexadecimal digits that change with the code, not with its comments and docstrings."""
    digest = hashlib.sha256()
    for path in sorted(_files()):
        content = _program(path) if path.suffix == ".py" else path.read_bytes()
        digest.update(f"{path.relative_to(_ROOT)} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def _files() -> Iterator[Path]:
    for folder in _CODE:
        for path in (_ROOT / folder).rglob("*.py"):
            if path.name not in _NO_PICTURES and not _NOT_RUN & set(path.relative_to(_ROOT).parts):
                yield path
    yield from (_ROOT / name for name in _FILES)
    for folder in _DATA:
        yield from (path for path in (_ROOT / folder).glob("*") if path.is_file())


def _program(path: Path) -> bytes:
    """What a module does, without what is said about it."""
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            node.body = [part for part in node.body if not _is_text(part)]
    return ast.dump(tree).encode()


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
