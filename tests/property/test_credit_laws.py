"""Laws of newest-first delivery, over every order of offering, sending and acknowledging."""

import pytest
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from services.tablet.credit import NewestFirst


class Lane(RuleBasedStateMachine):
    @initialize(credit=st.integers(1, 4))
    def begin(self, credit: int) -> None:
        self.credit = credit
        self.lane: NewestFirst[int] = NewestFirst(credit)
        self.offered = 0
        self.received: list[int] = []

    @rule()
    def offer(self) -> None:
        self.offered += 1
        self.lane.offer(self.offered)

    @rule()
    def take(self) -> None:
        item = self.lane.take()
        if item is not None:
            assert item == self.offered, "what is sent is the newest there is"
            self.received.append(item)

    @precondition(lambda self: self.lane.under_way > 0)
    @rule(data=st.data())
    def acknowledge(self, data: st.DataObject) -> None:
        self.lane.acknowledge(data.draw(st.integers(self.lane.acknowledged, self.lane.sent)))

    @invariant()
    def never_more_under_way_than_the_credit(self) -> None:
        assert 0 <= self.lane.under_way <= self.credit

    @invariant()
    def nothing_comes_twice_or_out_of_order(self) -> None:
        assert self.received == sorted(set(self.received))

    @invariant()
    def everything_is_sent_replaced_or_waits(self) -> None:
        assert 0 <= self.offered - self.lane.sent - self.lane.replaced <= 1


TestLane = pytest.mark.slow(Lane.TestCase)
