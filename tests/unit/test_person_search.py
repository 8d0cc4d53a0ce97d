"""The search for people among everybody whom all cameras see: right, and bounded in its work."""

from dataclasses import replace

import numpy as np
import pytest

from models.messages.observation import Observation
from services.fusion import association
from services.fusion.association import PersonSearch
from services.fusion.candidates import Candidates
from services.fusion.triangulation import triangulate
from services.fusion.views import Views, sightings
from tests.synthetic.gym import Gym, ring_rig
from tests.synthetic.person import Person
from tests.synthetic.play import DEFAULT

OTHERS = tuple(
    Person(centre_m=place, phase=0.37 * (number + 1), radius_m=0.3)
    for number, place in enumerate([(1.9, 0.8), (-1.6, -1.7), (-1.8, 1.5), (1.5, -1.8), (0.2, 2.4)])
)


class Scene:
    """A second of a gym in which every camera sees everybody, and what is asked of its last instant."""

    def __init__(self, cameras: int, people: int, seed: int = 0) -> None:
        rig = ring_rig(cameras)
        everywhere = tuple(range(cameras))
        others = tuple((person, everywhere) for person in OTHERS[: people - 1])
        gym = Gym(rig=rig, seconds=1.0, bystanders=others, seed=seed).quiet()
        self.views, self.candidates, self.t_s = Views.of(rig), Candidates(cameras), 0.0
        for event in gym.events():
            if isinstance(event, Observation):
                for sighting in sightings(event, self.views, DEFAULT.sighting):
                    self.candidates.add(sighting)
                    self.t_s = max(self.t_s, sighting.t_s)
        self.people = [gym.truth(round(self.t_s * 1e9)), *(other.joints(self.t_s - 5000.0) for other in OTHERS[: people - 1])]

    def search(self, max_hypotheses: int = DEFAULT.association.max_hypotheses) -> PersonSearch:
        config = replace(DEFAULT, association=replace(DEFAULT.association, max_hypotheses=max_hypotheses))
        return PersonSearch(self.views, self.candidates, self.t_s, config)


class Work:
    """Counts triangulations of whole persons."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.triangulations = 0
        monkeypatch.setattr(association, "triangulate", self._count)

    def _count(self, *arguments: object) -> object:
        self.triangulations += 1
        return triangulate(*arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("people", [1, 2, 3])
@pytest.mark.parametrize("cameras", [4, 8])
def test_looking_for_the_pupil_costs_about_two_triangulations_a_person_however_many_cameras(
    cameras: int, people: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, work = Scene(cameras, people), Work(monkeypatch)
    found = scene.search().best(frozenset())
    assert found is not None
    assert len(found.slots) == cameras
    assert work.triangulations <= 2 * people + 4


def test_a_crowd_before_many_cameras_is_searched_only_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, work = Scene(8, 6), Work(monkeypatch)
    assert scene.search(max_hypotheses=5).best(frozenset()) is not None
    assert work.triangulations <= 10


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("cameras", [3, 4, 8])
def test_everyone_is_found_once_and_in_all_pictures(cameras: int, seed: int) -> None:
    scene = Scene(cameras, 3, seed)
    everyone = list(scene.search().everyone())
    assert len(everyone) == 3
    tracks = [{scene.candidates.identity(slot)[1] for slot in person.slots.values()} for person in everyone]
    assert sorted(map(len, tracks)) == [1, 1, 1], "a person is put together from different people"
    assert len(set.union(*tracks)) == 3
    for truth in scene.people:
        errors = [np.nanmedian(np.linalg.norm(person.joints.points_m - truth, axis=1)) for person in everyone]
        assert min(errors) < 0.06


def test_nobody_is_found_where_nobody_is() -> None:
    views = Views.of(ring_rig(4))
    search = PersonSearch(views, Candidates(4), 1.0, DEFAULT)
    assert search.best(frozenset()) is None
    assert list(search.everyone()) == []
