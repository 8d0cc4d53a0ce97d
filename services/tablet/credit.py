"""Newest-first delivery with credit: what keeps a slow tablet current.

Handing bytes to a socket is no sign that anybody reads them: the buffers on the way hold seconds of motion. So a client
acknowledges what it has drawn, at most `credit` items are under way to it, and while it owes an answer only the newest item
waits. There is no queue to grow and none to catch up with.
"""

from typing import Generic, TypeVar

Item = TypeVar("Item")


class CreditError(ValueError):
    """An acknowledgement of something that was never sent, or that takes back an earlier one."""


class NewestFirst(Generic[Item]):
    """One lane to one client.

    Attributes:
        sent: items handed out since the start.
        acknowledged: of these, how many the client has answered.
        replaced: items that gave way to a newer one before they could be sent.
    """

    def __init__(self, credit: int) -> None:
        if credit < 1:
            raise ValueError(f"a credit of {credit} never sends anything")
        self._credit = credit
        self._waiting: Item | None = None
        self.sent = 0
        self.acknowledged = 0
        self.replaced = 0

    @property
    def under_way(self) -> int:
        """Items sent and not yet acknowledged, at most the credit."""
        return self.sent - self.acknowledged

    def offer(self, item: Item) -> None:
        """Have `item` wait to be sent, in the place of an older one."""
        if self._waiting is not None:
            self.replaced += 1
        self._waiting = item

    def take(self) -> Item | None:
        """The item to send now, if one waits and the client has credit."""
        if self._waiting is None or self.under_way >= self._credit:
            return None
        item, self._waiting = self._waiting, None
        self.sent += 1
        return item

    def acknowledge(self, count: int) -> None:
        """The client has dealt with `count` items since it connected (cumulative, so a lost answer does no harm).

        Raises:
            CreditError: `count` is more than was sent or less than was acknowledged before.
        """
        if not self.acknowledged <= count <= self.sent:
            raise CreditError(f"acknowledged {count} items after {self.acknowledged}, {self.sent} were sent")
        self.acknowledged = count
