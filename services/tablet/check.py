"""What the page's server needs, checked before anything is started.

`kinebox run` finds this by the entry point group `kinebox.checks`.
"""

from pathlib import Path

from models.camera.rig import Rig
from models.config.site import Site
from services.tablet.page import PAGE, require_page


def check(_site: Site, _rig: Rig, _data: Path) -> None:
    """Raise UserError if the page is not built."""
    require_page(PAGE)
