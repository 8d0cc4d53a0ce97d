"""A lesson plan says everything about a lesson; what it cannot mean is refused by the name of its key."""

import re
from pathlib import Path
from typing import get_args

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from edge.simulation.command import find_plan
from edge.simulation.lesson.plan import Pastime, Plan, decode_plan, encode_plan, fingerprint, schema
from edge.simulation.lesson.plan_check import require_sound
from edge.simulation.lesson.presets import PRESETS, acceptance, six_actions, tiny
from edge.simulation.rigs.arrangements import NAMES
from edge.simulation.split import SPLITS
from models.errors import UserError
from models.motions.between import PASTIMES
from tests.lesson_folder import plan_with

HEAD = 'version = 1\nname = "lesson"\nseed = 3\n'
PUPIL = '[[pupils]]\nname = "p1"\n'
SQUAT = '[[pupils.performs]]\naction = "squat"\n'


def sound(text: str) -> Plan:
    plan = decode_plan(text.encode(), "my.toml")
    require_sound(plan, "my.toml")
    return plan


@pytest.mark.parametrize(
    ("text", "key"),
    [
        (HEAD, "pupils"),
        (HEAD + "pupils = []\n", r"\$\.pupils"),
        ("seed = = 3", "no TOML"),
        (HEAD.replace("1", "2") + PUPIL, r"version 2 .* this KineBox, .*1"),
        (HEAD + "lenght_s = 3\n" + PUPIL, "lenght_s"),
        (HEAD + "length_s = 0\n" + PUPIL, r"\$\.length_s"),
        (HEAD + "size_px = [1280]\n" + PUPIL, r"\$\.size_px"),
        (HEAD + 'split = "train"\n' + PUPIL, r"\$\.split"),
        (HEAD + 'rig = "circle"\n' + PUPIL, "no rig 'circle'; there are corners"),
        (HEAD + "cameras = 5\n" + PUPIL, "cameras: rig 'corners' has 4, not 5"),
        (HEAD + PUPIL + "age_years = 3\n", r"\$\.pupils\[0\]\.age_years"),
        (HEAD + PUPIL + PUPIL, "pupils: 'p1' occurs twice"),
        (HEAD + PUPIL + SQUAT.replace("squat", "fly"), r"pupils\[0\]\.performs\[0\]: there is no action 'fly'; there are "),
        (HEAD + PUPIL + SQUAT + "tempo = 3.0\n", r"\$\.pupils\[0\]\.performs\[0\]\.tempo"),
        (HEAD + PUPIL + SQUAT + "faults = {laughs = 1.0}\n", r"pupils\[0\]\.performs\[0\]: squat has no fault 'laughs'; it has "),
        (HEAD + PUPIL + SQUAT + "faults = {shallow = 7.0}\n", r"\$\.pupils\[0\]\.performs\[0\]\.faults"),
        (HEAD + PUPIL + SQUAT + "begins_s = 4.0\n" + SQUAT + "begins_s = 2.0\n", r"pupils\[0\]\.performs\[1\]\.begins_s"),
        (HEAD + PUPIL + "[shutter]\nexposure_ms = 50\n", r"\$\.shutter\.exposure_ms"),
        (HEAD + PUPIL + '[[bumps]]\ncamera = "cam09"\nat_s = 1\n', r"bumps\[0\]\.camera: rig 'corners' has no camera 'cam09'"),
        (HEAD + PUPIL + '[[faults]]\ncamera = "cam07"\nkind = "drop"\nat_s = 1\nfor_s = 1\n', r"faults\[0\]\.camera"),
        (HEAD + PUPIL + '[[faults]]\ncamera = "cam01"\nkind = "late"\nby_s = -1\nat_s = 1\nfor_s = 1\n', "late needs by_s"),
        (HEAD + PUPIL + '[[swaps]]\ncameras = ["cam01", "cam01"]\nat_s = 1\n', r"swaps\[0\]: .* with itself"),
    ],
)
def test_what_a_plan_cannot_mean_is_refused_in_one_line_that_names_file_and_key(text: str, key: str) -> None:
    with pytest.raises(UserError, match=rf"^lesson plan my\.toml: .*{key}") as raised:
        sound(text)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize("plan", [*(preset.make() for preset in PRESETS.values()), *(acceptance(7, split) for split in SPLITS)])
def test_every_plan_that_comes_with_kinebox_is_sound_and_the_same_after_a_trip_through_its_file(plan: Plan) -> None:
    again = sound(encode_plan(plan).decode())
    assert again == plan
    assert fingerprint(again, "recipe") == fingerprint(plan, "recipe")


def test_lessons_of_all_seeds_rigs_and_splits_have_names_of_their_own() -> None:
    plans = [acceptance(seed, split, rig) for seed in (1, 10, 100, 2**31 - 1) for split in SPLITS for rig in NAMES]
    assert len({plan.name for plan in plans}) == len(plans)
    for plan in plans:
        assert decode_plan(encode_plan(plan), "plan").name == plan.name


def test_presets_are_found_by_name_and_what_is_none_is_said() -> None:
    assert find_plan("six_actions") == six_actions()
    with pytest.raises(UserError, match=r"no lesson plan 'sevn_actions'.*six_actions"):
        find_plan("sevn_actions")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("cameras = 1\n", "cameras is 1; .* 2 or more"),
        ("cameras = 0\n", "cameras is 0; .* 2 or more"),
        ("cameras = -1\n", "cameras is -1; .* 2 or more"),
        ("rate_hz = 120\nshutter = { exposure_ms = 9, readout_ms = 2 }\n", r"shutter\.exposure_ms is 9, but at 120 Hz .* 8\.33 ms"),
        (
            'rig = "h36m_s9"\nswaps = [{ cameras = ["cam01", "cam02"], at_s = 1 }]\n',
            r"swaps\[0\]\.cameras: .* cam01 and cam02 are not of one size",
        ),
        ("rate_hz = 120\n", r"shutter\.readout_ms is 16, but at 120 Hz"),
    ],
)
def test_what_no_camera_can_film_and_no_box_can_play_is_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text(HEAD + text + PUPIL)
    with pytest.raises(UserError, match=rf"^lesson plan .*my\.toml: {said}"):
        find_plan(str(tmp_path / "my.toml"))


def test_a_plan_in_another_encoding_is_said_to_be_and_the_mark_of_some_editors_is_none(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    for encoding in ("utf-16", "latin-1"):
        path.write_bytes((HEAD + "# p\u00e4dagogisch\n" + PUPIL).encode(encoding))
        with pytest.raises(UserError, match=r"my\.toml is not in UTF-8 \(its byte \d+ is not\); save it"):
            find_plan(str(path))
    path.write_bytes((HEAD + PUPIL).encode("utf-8-sig"))
    assert find_plan(str(path)).name == "lesson"


@pytest.mark.parametrize(
    "text",
    [
        HEAD.replace("lesson", "lesson\\n") + PUPIL,
        HEAD + PUPIL.replace("p1", "p1\\n"),
        *(
            HEAD + PUPIL + '[[faults]]\ncamera = "cam01"\nkind = "drop"\n' + times
            for times in ("at_s = inf\nfor_s = 1\n", "at_s = 0\nfor_s = inf\n", "at_s = 0\nfor_s = 1\nevery_s = 1e-9\n")
        ),
    ],
)
def test_names_of_two_lines_and_faults_without_end_or_pause_are_refused(text: str) -> None:
    with pytest.raises(UserError, match=r"my\.toml: .*\$\.(name|pupils\[0\]\.name|faults\[0\])"):
        sound(text)


def test_a_plan_knows_every_pastime() -> None:
    assert get_args(Pastime) == PASTIMES


def test_the_fingerprint_changes_with_whatever_could_change_a_picture() -> None:
    base = tiny()
    others = [
        msgspec.structs.replace(base, seed=2),
        msgspec.structs.replace(base, split="development"),
        msgspec.structs.replace(base, length_s=1.1),
        plan_with(),
    ]
    digests = [fingerprint(plan, "a") for plan in (base, *others)] + [fingerprint(base, "b")]
    assert len(set(digests)) == len(digests)


@given(st.integers(0, 2**31 - 1), st.integers(0, 2**31 - 1))
def test_lessons_of_the_two_splits_and_of_different_seeds_draw_different_lots(seed: int, other: int) -> None:
    lots = {(split, each): acceptance(each, split).lot("noise", "cam01") for split in SPLITS for each in {seed, other}}
    assert len(set(lots.values())) == len(lots)


def test_each_performance_varies_in_its_own_way_unless_a_seed_is_given() -> None:
    plan = acceptance(3)
    seeds = {plan.performance(0, number).seed for number in range(6)}
    assert len(seeds) == 6
    first = msgspec.structs.replace(plan.pupils[0].performs[0], seed=11)
    fixed = msgspec.structs.replace(plan, pupils=[msgspec.structs.replace(plan.pupils[0], performs=[first])])
    assert fixed.performance(0, 0).seed == 11


def test_the_page_about_lesson_plans_names_every_key_and_its_example_is_sound() -> None:
    page = (Path(__file__).parents[2] / "docs/simulation.md").read_text()
    missing = [key for table in schema()["$defs"].values() for key in table["properties"] if f"`{key}`" not in page]
    assert set(missing) <= {"every_s", "for_s", "by_s", "ppm", "share"}, "keys of [[faults]] are those of the site file"
    (example,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    assert sound(example).pupils[0].performs[1].action == "forward_roll"
