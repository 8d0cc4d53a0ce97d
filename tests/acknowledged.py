"""What a tablet answers: how much of what must not pile up for it, figures and statuses, it has dealt with."""

import json


class Acknowledged:
    """Counts what one connection brings. A list of attempts, which comes seldom, is not acknowledged."""

    def __init__(self) -> None:
        self._counts = {"motions": 0, "statuses": 0}

    def after(self, message: str | bytes) -> str:
        """The answer to the next message."""
        if isinstance(message, bytes):
            self._counts["motions"] += 1
        elif json.loads(message)["type"] == "status":
            self._counts["statuses"] += 1
        return json.dumps({"type": "ack", **self._counts})
