"""Where the page is that `make web` builds."""

from pathlib import Path
from typing import Final

from models.errors import UserError

PAGE: Final = Path(__file__).parent / "web" / "dist"


def require_page(folder: Path) -> None:
    """Raise UserError unless there is a page in a folder."""
    if not (folder / "index.html").is_file():
        raise UserError("tablet: the page is not built (services/tablet/web/dist is missing); run 'make web'")
