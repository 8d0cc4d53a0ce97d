"""Writes the description of the server's interfaces, from which the page's types are generated.

Run `python -m services.tablet.openapi`, then `npm run types` in `web/`, after a change of `messages.py`; tests compare both files.
"""

import json
from pathlib import Path

from services.tablet.room_state import RoomState
from services.tablet.server import TabletServer, create_app

FILE = Path(__file__).parent / "web" / "openapi.json"


def description() -> str:
    """The OpenAPI document as text, the same on every machine."""
    server = TabletServer(RoomState("", (), 0.0, 0), clock_ns=lambda: 0)
    return json.dumps(create_app(server, page=None).openapi(), indent=2) + "\n"


if __name__ == "__main__":
    FILE.write_text(description(), encoding="utf-8")
