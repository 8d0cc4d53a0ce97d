"""Several people at once: nobody is mixed up when they pass one another, and who comes or goes is noticed."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from models.arrays import Float
from models.messages.observation import Observation
from services.fusion.persons import NOBODY, Persons, share_out
from services.fusion.pipeline import Tick
from services.fusion.views import Views, sightings
from tests.synthetic.gym import T0_NS, Gym, ring_rig
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT, after, errors_mm, play

FIRST, SECOND = Person(centre_m=(-0.5, 0.0)), Person(centre_m=(0.5, 0.0), phase=0.148)
"""They walk on two circles that cross, and pass 20 cm from each other 1.4 s after the start and again later."""


@dataclass
class Followed:
    """Who was said to be where."""

    numbers: list[dict[int, set[int]]] = field(default_factory=list)
    places: list[tuple[float, dict[int, Float]]] = field(default_factory=list)


def follow(gym: Gym) -> Followed:
    """Play a gym; `numbers` tells at each observation which tracks each number was given to."""
    views, persons, followed = Views.of(gym.rig), None, Followed()
    persons = Persons(views)
    for event in gym.events():
        if isinstance(event, Tick):
            t_s = event.t_ns * 1e-9
            persons.tick(t_s - 0.1, DEFAULT)
            places = {known.number: known.estimates.skeleton(t_s - 0.1)[0] for known in persons.people}
            followed.places.append((t_s - 0.1, places))
        elif isinstance(event, Observation):
            seen = sightings(event, views, DEFAULT.sighting)
            numbers = persons.observe(views.index[event.camera], event.t_mid_ns * 1e-9, seen, DEFAULT)
            given: dict[int, set[int]] = {}
            for number, sighting in zip(numbers.tolist(), seen, strict=True):
                given.setdefault(number, set()).add(sighting.track)
            followed.numbers.append(given)
    return followed


def crossing(cameras: int, seed: int, seconds: float = 6.0) -> Gym:
    return Gym(rig=ring_rig(cameras), pupil=FIRST, bystanders=((SECOND, tuple(range(cameras))),), seconds=seconds, seed=seed)


def test_the_two_do_pass_each_other_closely() -> None:
    apart = [np.linalg.norm(FIRST.joints(t).mean(axis=0) - SECOND.joints(t).mean(axis=0)) for t in np.arange(1.0, 6.0, 0.02)]
    assert min(apart) < 0.25
    assert max(apart) > 0.8


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("cameras", [3, 4])
def test_two_people_who_pass_each_other_keep_their_numbers(cameras: int, seed: int) -> None:
    followed = follow(crossing(cameras, seed))
    late = followed.numbers[len(followed.numbers) // 6 :]
    tracks: dict[int, set[int]] = {}
    for given in late:
        for number, seen in given.items():
            tracks.setdefault(number, set()).update(seen)
    tracks.pop(NOBODY, None)
    assert sorted(tracks) == [0, 1], "somebody was lost and found again under another number"
    assert sorted(map(sorted, tracks.values())) == [[1], [10]]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("cameras", [3, 4])
def test_the_pupil_is_held_while_somebody_passes_him(cameras: int, seed: int) -> None:
    gym = crossing(cameras, seed)
    played = play(gym.rig, gym.events())
    pupil = errors_mm(after(played.smooth, 1.0), gym.truth)
    other = errors_mm(after(played.smooth, 1.0), lambda t_ns: SECOND.joints((t_ns - T0_NS) * 1e-9))
    chosen = min(pupil, other, key=lambda errors: np.nanmean(errors[0]))
    assert np.nanmedian(chosen) < 30
    assert (np.nanmedian(chosen, axis=1) < 80).all(), "the figure went over to the one who passed"


def test_of_two_expected_people_each_gets_one_sighting_even_if_both_are_nearest_to_the_same() -> None:
    gym = crossing(4, 0, seconds=1.0)
    views = Views.of(gym.rig)
    event = next(event for event in gym.quiet().events() if isinstance(event, Observation))
    seen = sightings(event, views, DEFAULT.sighting)
    persons = Persons(views)
    assert [share_out(seen, [], 0.2).tolist(), share_out((), [], 0.2).tolist()] == [[NOBODY, NOBODY], []]
    assert persons.observe(0, 1.0, seen, DEFAULT).tolist() == [NOBODY, NOBODY]


def test_who_leaves_is_forgotten_and_nobody_is_made_of_what_stays() -> None:
    leaver = Person(centre_m=(1.6, -1.2), radius_m=0.2)
    gym = Gym(bystanders=((leaver, (0, 1, 2, 3)),), pupil=FIRST, seconds=2.0).quiet()
    views = Views.of(gym.rig)
    persons = Persons(views)
    for event in gym.events():
        if isinstance(event, Tick):
            persons.tick(event.t_ns * 1e-9 - 0.1, DEFAULT)
        elif isinstance(event, Observation):
            stays = event.t_mid_ns - T0_NS < 1_000_000_000
            seen = sightings(event, views, DEFAULT.sighting)
            persons.observe(views.index[event.camera], event.t_mid_ns * 1e-9, seen if stays else seen[:1], DEFAULT)
    (left,) = persons.people
    truth = FIRST.joints(2.0 - 0.1)
    places, known = left.estimates.skeleton((T0_NS + 1_900_000_000) * 1e-9)
    assert known.all()
    assert np.linalg.norm(places - truth, axis=1).mean() < 0.1
