"""A school's own standards: what counts, what is kept, which folder is meant, and that no version is ever lost."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import UserError
from models.teaching.standard import LAST_VERSION, Exemplar, Standard, encode
from services.evaluation.check import check
from services.site_file.reading import read_site
from services.support.own_standards import OwnStandards
from services.support.teaching_files import folder_of_own, load_standards, load_teachings, own_folder
from tests.installed import ROOT

SQUAT = load_standards(None)["squat"]
ROOM = read_site(ROOT / "deploy/sites/simulated/site.toml")


def named(origin: str) -> Standard:
    return replace(SQUAT, origin=origin)


def holds(own: Path) -> dict[str, bytes]:
    """All files, hidden ones too."""
    return {str(path.relative_to(own)): path.read_bytes() for path in sorted(own.rglob("*")) if path.is_file()}


def origins(own: OwnStandards) -> set[str]:
    """Of everything that counts or is kept."""
    counting = own.own("squat")
    return {one.read().origin for one in own.kept("squat")} | (set() if counting is None else {counting.origin})


def test_each_new_one_counts_with_a_number_of_its_own_and_those_before_are_kept(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path / "school")
    assert [own.put(named(origin)).standard.version for origin in ("a", "b", "c")] == [2, 3, 4]
    assert sorted(holds(tmp_path)) == [
        "school/standards/squat.npz",
        "school/standards/versions/squat-2.npz",
        "school/standards/versions/squat-3.npz",
    ]
    assert own.counts("squat").origin == "c"
    assert [(one.number, one.read().origin, one.read().version) for one in own.kept("squat")] == [(2, "a", 2), (3, "b", 3)]
    assert load_standards(tmp_path / "school")["squat"].version == 4
    assert OwnStandards(tmp_path / "school").counts("run").version == 1


def test_a_version_that_is_brought_back_is_as_it_was_and_numbers_go_on_growing(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    for origin in ("a", "b", "c"):
        own.put(named(origin))
    before = own.kept("squat")[0].file.read_bytes()
    own.bring_back("squat", 2)
    assert own.file("squat").read_bytes() == before
    assert origins(own) == {"a", "b", "c"}
    assert own.put(named("d")).standard.version == 5
    own.bring_back_shipped("squat")
    assert own.own("squat") is None
    assert own.counts("squat").version == SQUAT.version
    assert origins(own) == {"a", "b", "c", "d"}
    assert own.put(named("e")).standard.version == 6


def test_a_version_that_is_not_kept_or_of_another_action_is_refused(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    own.put(named("b"))
    before = holds(tmp_path)
    with pytest.raises(UserError, match="version 7 of 'squat' is not kept"):
        own.bring_back("squat", 7)
    (tmp_path / "standards/versions/run-9.npz").write_bytes(encode(SQUAT))
    with pytest.raises(UserError, match="is of another action"):
        own.bring_back("run", 9)
    (tmp_path / "standards/versions/run-9.npz").unlink()
    assert holds(tmp_path) == before


def test_a_file_that_somebody_brought_is_kept_also_if_its_number_is_taken(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    for origin in ("a", "b"):
        own.put(named(origin))
    own.file("squat").write_bytes(encode(replace(named("of another school"), version=2)))
    placed = own.put(named("c"))
    assert placed.standard.version > 3
    assert [one.read().origin for one in own.kept("squat") if one.number == placed.before] == ["of another school"]
    # Version 3, "b", was overwritten by hand: of what was here all is there.
    assert origins(own) >= {"a", "of another school", "c"}
    numbers = [one.number for one in own.kept("squat")]
    assert len(set(numbers)) == len(numbers)
    assert all(one.read().version == one.number for one in own.kept("squat"))


def test_only_the_very_same_one_counts_again_and_not_one_of_the_same_number(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    for origin in ("a", "b"):
        own.put(named(origin))
    (kept,) = own.kept("squat")
    assert not own.is_counting("squat", kept)
    own.file("squat").write_bytes(encode(replace(named("of another school"), version=kept.number)))
    assert not own.is_counting("squat", kept)
    own.bring_back("squat", kept.number)
    assert own.is_counting("squat", kept)
    assert origins(own) == {"a", "of another school"}
    own.bring_back_shipped("squat")
    assert not own.is_counting("squat", kept)


@pytest.mark.parametrize("data", [b"", b"damaged", encode(SQUAT)[:-50], encode(replace(SQUAT, action="run"))])
def test_what_cannot_be_read_is_kept_as_it_is_and_another_can_take_its_place(tmp_path: Path, data: bytes) -> None:
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    own.file("squat").write_bytes(data)
    with pytest.raises(UserError, match=r"squat\.npz"):
        own.counts("squat")
    for _ in range(2):
        own.bring_back_shipped("squat")
        own.file("squat").write_bytes(data)
    assert own.put(named("b")).standard.version == 2
    kept = [path for path in (tmp_path / "standards/versions").iterdir() if "unreadable" in path.name]
    assert [path.read_bytes() for path in kept] == [data]
    assert own.counts("squat").origin == "b"
    assert own.kept("squat") == ()


def test_other_files_and_hidden_ones_neither_count_nor_are_touched(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    others = {"standards/.squat.npz.part": b"of a power cut", "standards/notes.txt": b"mine", "standards/versions/squat.npz": b"?"}
    for name, data in others.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(data)
    own.put(named("b"))
    left = holds(tmp_path)
    assert all(left[name] == data for name, data in others.items() if not name.endswith(".part"))
    assert [one.number for one in own.kept("squat")] == [2]
    assert load_standards(tmp_path)["squat"].origin == "b"


def test_an_action_of_the_schools_own_has_standards_too(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    with pytest.raises(UserError, match=r"there is no action 'handstand'; there are: badminton_clear, .*volleyball_spike$"):
        own.counts("handstand")
    assert own.put(replace(SQUAT, action="handstand")).standard.version == 1
    assert own.put(replace(SQUAT, action="handstand")).standard.version == 2
    assert own.shipped("handstand") is None
    own.file("handstand").unlink()
    with pytest.raises(UserError, match="no standard of 'handstand' counts; 'kinebox standard restore handstand'"):
        own.counts("handstand")
    own.bring_back("handstand", 1)
    assert own.counts("handstand").version == 1


def test_the_usual_folder_counts_when_it_is_there_and_a_named_one_must_be(tmp_path: Path) -> None:
    assert own_folder(tmp_path, "") is None
    assert folder_of_own(tmp_path, "") == tmp_path / "school"
    OwnStandards(folder_of_own(tmp_path, "")).put(named("a"))
    assert own_folder(tmp_path, "") == tmp_path / "school"
    with pytest.raises(UserError, match="ours does not exist; make it, or correct 'teaching'"):
        own_folder(tmp_path, "ours")
    (tmp_path / "ours").mkdir()
    assert own_folder(tmp_path, "ours") == tmp_path / "ours"


@pytest.mark.parametrize("named_folder", ["/elsewhere", "../elsewhere", "ours/../../elsewhere", ".."])
def test_a_folder_outside_of_the_data_folder_is_none(tmp_path: Path, named_folder: str) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "elsewhere").mkdir()
    for function in (own_folder, folder_of_own):
        with pytest.raises(UserError, match=r"is not in the data folder .*; correct 'teaching' under \[evaluation\]"):
            function(tmp_path / "data", named_folder)


def test_a_link_that_somebody_made_in_the_data_folder_may_lead_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "shared").mkdir()
    (tmp_path / "data/ours").symlink_to(tmp_path / "shared")
    assert own_folder(tmp_path / "data", "ours") == tmp_path / "data/ours"


@pytest.mark.parametrize("teaching", ["", "school"])
@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("file", "is a file, and no folder; move it away"),
        ("link to nowhere", "is a link that leads nowhere, and no folder; move it away"),
        ("link to itself", "is a link that leads nowhere, and no folder; move it away"),
    ],
)
def test_what_is_no_folder_is_not_taken_for_a_school_without_one(tmp_path: Path, kind: str, told: str, teaching: str) -> None:
    school = tmp_path / "school"
    if kind == "file":
        school.write_text("")
    else:
        school.symlink_to("elsewhere" if kind == "link to nowhere" else "school")
    with pytest.raises(UserError, match=f"{school} {told}"):
        own_folder(tmp_path, teaching)
    with pytest.raises(UserError, match=f"{school} {told}"):
        check(*ROOM, tmp_path)


def words(own: Path) -> object:
    """What is taught there."""
    return load_teachings(own, None)


@pytest.mark.parametrize(("kind", "read"), [("actions", words), ("standards", load_standards)])
def test_a_file_in_the_place_of_a_folder_in_it_is_named(tmp_path: Path, kind: str, read: Callable[[Path], object]) -> None:
    (tmp_path / kind).write_text("")
    with pytest.raises(UserError, match=f"{tmp_path / kind} is a file, and no folder; move it away"):
        read(tmp_path)


def test_a_list_of_standards_names_a_file_in_the_place_of_their_folder(tmp_path: Path) -> None:
    (tmp_path / "standards").write_text("")
    with pytest.raises(UserError, match=r"standards is a file, and no folder"):
        _ = OwnStandards(tmp_path).actions


@pytest.mark.parametrize("name", ["squat.npz", "versions/squat-999999.npz"])
def test_after_the_last_number_that_there_is_a_new_one_is_one_line_and_no_defect(tmp_path: Path, name: str) -> None:
    (tmp_path / "standards/versions").mkdir(parents=True)
    (tmp_path / "standards" / name).write_bytes(encode(replace(SQUAT, version=LAST_VERSION)))
    before = holds(tmp_path)
    with pytest.raises(UserError, match="a standard of 'squat' has the last number that there is, 999999; move its file away"):
        OwnStandards(tmp_path).put(named("a"))
    assert holds(tmp_path) == before


def test_a_standard_that_shows_nothing_is_named_wherever_it_is_read(tmp_path: Path) -> None:
    own = OwnStandards(tmp_path)
    own.put(named("a"))
    own.put(named("b"))
    nothing = replace(SQUAT, performance=Exemplar(np.zeros_like(SQUAT.joints_m), SQUAT.moments_s))
    own.kept("squat")[0].file.write_bytes(encode(nothing))
    with pytest.raises(UserError, match=r"squat-2\.npz: its performance hardly moves between its keyframes; take"):
        own.bring_back("squat", 2)
    own.file("squat").write_bytes(encode(nothing))
    for read in (lambda: own.counts("squat"), lambda: load_standards(tmp_path)):
        with pytest.raises(UserError, match=r"squat\.npz: its performance hardly moves between its keyframes; take"):
            read()


def test_a_folder_that_cannot_be_read_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "standards").write_text("no folder")
    with pytest.raises(UserError, match=r"standards cannot be written: (Not a directory|File exists)"):
        OwnStandards(tmp_path).put(named("a"))
