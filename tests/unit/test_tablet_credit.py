"""A slow client gets the newest frames and owes at most its credit."""

import pytest

from services.tablet.credit import CreditError, NewestFirst


def test_a_client_that_never_answers_gets_two_frames_and_no_more() -> None:
    lane: NewestFirst[int] = NewestFirst(credit=2)
    sent = []
    for frame in range(100):
        lane.offer(frame)
        item = lane.take()
        if item is not None:
            sent.append(item)
    assert sent == [0, 1]
    assert lane.replaced == 97


def test_after_its_answer_a_slow_client_gets_the_newest_frame() -> None:
    lane: NewestFirst[int] = NewestFirst(credit=1)
    lane.offer(0)
    lane.take()
    for frame in range(1, 50):
        lane.offer(frame)
    lane.acknowledge(1)
    assert lane.take() == 49
    assert lane.take() is None


@pytest.mark.parametrize("count", [-1, 0, 3])
def test_an_acknowledgement_of_the_future_or_the_past_is_refused(count: int) -> None:
    lane: NewestFirst[int] = NewestFirst(credit=2)
    for frame in range(2):
        lane.offer(frame)
        lane.take()
    lane.acknowledge(1)
    with pytest.raises(CreditError):
        lane.acknowledge(count)
    assert lane.under_way == 1


def test_a_credit_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="credit of 0"):
        NewestFirst(0)
