"""What the Shelf benchmark computes: grouping, the baseline, PCP-3D; and on the data, where it is, what it promises."""

from pathlib import Path

import numpy as np
import pytest

from models.arrays import Float
from services.fusion.views import Views
from tests.bench.shelf import __main__ as bench
from tests.bench.shelf import measure as measuring
from tests.bench.shelf.data import PARTS, Shelf, as_shelf, load_shelf, right_parts
from tests.bench.shelf.follow import PictureTracks, follow
from tests.bench.shelf.greedy import greedy_persons
from tests.bench.shelf.measure import ALL_CAMERAS, FEW_CAMERAS, measure
from tests.bench.shelf.openpose import JOINTS, LIMBS, Picture, group
from tests.installed import ROOT
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person

_TO_BODY25 = {0: 0, 16: 1, 15: 2, 18: 3, 17: 4, 5: 5, 2: 6, 6: 7, 3: 8, 7: 9, 4: 10, 12: 11, 9: 12, 13: 13, 10: 14, 14: 15, 11: 16}
PEOPLE = (Person(radius_m=0.3), Person(centre_m=(1.1, 0.8), radius_m=0.3, phase=0.2))
RIG = ring_rig(3)


def body25(points_px: Float) -> Float:
    """(25, 2) OpenPose's joints from COCO's (17, 2); feet at the ankles."""
    out = np.empty((JOINTS, 2))
    for joint in range(JOINTS):
        out[joint] = points_px[_TO_BODY25.get(joint, 15 if joint in (19, 20, 21) else 16)]
    out[1], out[8] = points_px[[5, 6]].mean(axis=0), points_px[[11, 12]].mean(axis=0)
    return out


def picture(persons_px: list[Float], confusion: float = 0.3) -> Picture:
    """All joints of all persons as candidates; those of one person fit well, those of two people somewhat."""
    bodies = [body25(person) for person in persons_px]
    candidates = tuple(np.array([[*body[joint], 0.9] for body in bodies]) for joint in range(JOINTS))
    affinity = np.full((len(bodies), len(bodies)), confusion) + (0.9 - confusion) * np.eye(len(bodies))
    return Picture(candidates, tuple(affinity for _ in LIMBS))


def scene(t_s: float) -> list[Picture]:
    return [picture([camera.project(person.joints(t_s)) for person in PEOPLE]) for camera in RIG]


def test_candidates_are_grouped_into_whole_people_whatever_lies_between_them() -> None:
    first, second = (RIG.cameras[0].project(person.joints(0.0)) for person in PEOPLE)
    grouped = group(picture([first, second]))
    assert len(grouped) == 2
    for person, truth in zip(
        sorted(grouped, key=lambda p: float(p.points_px[0, 0])), sorted((first, second), key=lambda p: p[0, 0]), strict=True
    ):
        assert person.points_px == pytest.approx(truth)
        assert (person.score == 0.9).all()


def test_a_limb_that_is_not_seen_leaves_two_parts_and_never_joins_two_people() -> None:
    whole = picture([RIG.cameras[0].project(person.joints(0.0)) for person in PEOPLE])
    torn = Picture(whole.candidates, tuple(paf * (limb != (1, 8)) for limb, paf in zip(LIMBS, whole.affinities, strict=True)))
    grouped = group(torn)
    assert sorted(int((person.score > 0).sum()) for person in grouped) == [6, 6, 11, 11]
    assert group(Picture(tuple(np.zeros((0, 3)) for _ in range(JOINTS)), tuple(np.zeros((0, 0)) for _ in LIMBS))) == []


def test_the_baseline_finds_both_people_exactly_where_nothing_is_wrong() -> None:
    persons = greedy_persons(Views.of(RIG), [group(view) for view in scene(0.0)])
    assert len(persons) == 2
    for truth in (person.joints(0.0) for person in PEOPLE):
        assert min(np.abs(person - truth).max() for person in persons) < 1e-6


@pytest.mark.slow
def test_ours_follows_both_people_with_the_lag_that_it_says_and_nothing_from_the_future() -> None:
    frames = [[group(view) for view in scene(k / 25)] for k in range(40)]
    whole = follow(Views.of(RIG), frames)
    for k in range(10, 40):
        assert len(whole.smooth[k]) == 2
        for truth in (person.joints(k / 25) for person in PEOPLE):
            assert min(np.median(np.linalg.norm(person - truth, axis=1)) for person in whole.smooth[k].values()) < 0.03
    until = follow(Views.of(RIG), frames[:30])
    for k in range(24):
        for number, person in until.smooth[k].items():
            np.testing.assert_array_equal(person, whole.smooth[k][number])


def test_a_picture_gives_a_person_the_track_of_the_last_one() -> None:
    tracks = PictureTracks()
    first = group(scene(0.0)[0])
    assert tracks.numbers(first, 0) == [0, 1]
    assert tracks.numbers(group(scene(0.04)[0])[::-1], 1) == [1, 0]
    assert tracks.numbers([], 2) == []
    assert tracks.numbers(first[:1], 20) == [2]


def standing() -> Float:
    return as_shelf(PEOPLE[0].joints(0.0))


def test_pcp_allows_half_a_parts_length_in_the_mean_of_its_ends_and_counts_what_is_missing_as_wrong() -> None:
    truth = standing()
    assert right_parts(truth, [truth]).all()
    assert not right_parts(truth, []).any()
    shank = np.linalg.norm(truth[0] - truth[1])
    moved = truth.copy()
    moved[0, 0] += 0.99 * shank  # mean of both ends just within half its length
    assert right_parts(truth, [moved]).all()
    moved[0, 0] += 0.02 * shank
    wrong = [part for part, right in zip(PARTS, right_parts(truth, [moved]), strict=True) if not right]
    assert wrong == ["right_shank"]
    unknown = truth.copy()
    unknown[7] = np.nan
    wrong = [part for part, right in zip(PARTS, right_parts(truth, [unknown]), strict=True) if not right]
    assert wrong == ["right_forearm", "right_upper_arm"]


def test_pcp_judges_the_nearest_person_and_a_person_without_joints_is_none() -> None:
    truth = standing()
    assert right_parts(truth, [truth + 1.0, np.full((15, 3), np.nan), truth]).all()
    assert not right_parts(truth, [np.full((15, 3), np.nan)]).any()


def test_without_the_data_one_line_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["shelf", "--data", str(tmp_path), "--shared", str(tmp_path)])
    assert bench.main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "shelf_dev" in line
    assert "SHARED=" in line


@pytest.mark.parametrize(("ours", "code"), [(98.0, 1), (99.0, 0)], ids=["3 points", "4 points"])
def test_too_small_a_margin_over_the_baseline_ends_the_command_with_1(
    ours: float, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["shelf", "--data", str(tmp_path)])
    monkeypatch.setattr(bench, "load_shelf", lambda _: Shelf(RIG, [[]], []))
    monkeypatch.setattr(measuring, "warm_up", lambda: None)
    monkeypatch.setattr(measuring, "parts", lambda *_: {})
    monkeypatch.setattr(measuring, "measure", lambda *to: {f"pcp.limbs{to[-1]}": ours, f"baseline.pcp.limbs{to[-1]}": 95.0})
    assert bench.main() == code
    assert ("missed: margin.cams024.limbs" in capsys.readouterr().out) == bool(code)


@pytest.fixture
def shelf_data() -> Shelf:
    folder = ROOT.parent / "shared/data/shelf_dev"
    if not folder.is_dir():
        pytest.skip("the Shelf data may not be redistributed; it is not beside this checkout")
    return load_shelf(folder)


@pytest.mark.shared_data
@pytest.mark.slow
def test_on_the_shelf_limbs_are_right_by_more_than_the_baselines_and_nobody_is_mixed_up(shelf_data: Shelf) -> None:
    grouped = [[group(view) for view in pictures] for pictures in shelf_data.pictures]
    # The margins are a little less than what is held, 0.44 and 1.70: the benchmark's bar of 4 points is not.
    for cameras, least, margin in ((ALL_CAMERAS, 98.5, 0.3), (FEW_CAMERAS, 97.0, 1.5)):
        figures = measure(shelf_data, grouped, cameras, "")
        assert figures["pcp.limbs"] >= least
        assert figures["pcp.limbs"] - figures["baseline.pcp.limbs"] >= margin
        assert figures["identity_switches"] == 0
