"""The page to print holds everything itself, says nothing that nobody knows, and lets nobody write into it."""

import csv
import io
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any, get_args

import msgspec
import numpy as np
import pytest

from models.messages.feedback import Colour, Judgement, MeasureResult
from models.skeleton import coco
from models.teaching.measure import Phase
from models.teaching.schema import Language
from services.evaluation.report import csv_file, curve_chart, page
from services.evaluation.report.body import Trunk, parts_of, together
from services.evaluation.report.curve import curves_of
from services.evaluation.report.figures import figures
from services.evaluation.report.numbers import between, estimate
from services.evaluation.report.sheet import Tried, sheet_of
from services.evaluation.report.words import ANGLES, WORDS, Words
from services.evaluation.signals.catalogue import CATALOGUE
from services.tablet.attempts import shown_of
from tests.installed import ROOT
from tests.reported import FACTS, attempt, sheet
from tests.taught import shipped

VOID = {"meta", "link", "br", "img"}
ACTIONS = sorted(shipped().teachings)
GOLDEN = ROOT / "tests/golden"


class Reader(HTMLParser):
    """What a browser would make of it."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).replace("\u00a0", " ").split())


def html(*attempts: object, language: Language = "en") -> str:
    return page.encode(sheet(*attempts, language=language)).decode()  # type: ignore[arg-type]


def test_it_loads_nothing_and_runs_nothing() -> None:
    source = html(attempt(), attempt("squat"))
    reader = Reader(source)
    assert reader.open == []
    assert {tag for tag, _ in reader.tags} & {"script", "link", "img", "iframe", "object", "image", "use", "foreignobject"} == set()
    named = {name for _, attributes in reader.tags for name in attributes}
    assert named & {"src", "href", "xlink:href", "onload", "onclick", "srcset", "data"} == set()
    assert re.findall(r"url\((?!#)", source) == []
    assert "@import" not in source
    assert "//" not in source.replace("<!doctype html>", "")
    (policy,) = [attributes["content"] for _, attributes in reader.tags if "http-equiv" in attributes]
    assert policy == "default-src 'none'; style-src 'unsafe-inline'"


def test_patterns_that_it_paints_with_are_in_it() -> None:
    source = html(attempt())
    assert set(re.findall(r"url\(#(\w+)\)", source)) <= set(re.findall(r'<pattern id="(\w+)"', source))


def test_nobody_writes_into_it() -> None:
    evil = '"><script>alert(1)</script><b x="'
    facts = replace(FACTS, title=evil, name=evil)
    source = page.encode(sheet_of(facts, [Tried(attempt(), evil)], shipped().teachings, "en")).decode()
    assert "<script" not in source
    assert {tag for tag, _ in Reader(source).tags} >= {"article", "svg"}
    assert evil in Reader(source).text


def test_an_attempt_shows_its_score_words_and_measures_each_with_its_sigma() -> None:
    measures = (
        MeasureResult("knee_bend", 34.2, 4.1, "deg", "poor", 45, 90),
        MeasureResult("hand_height", 13.52, 0.86, "pct", "good", 9, 22),
    )
    said = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="elbow_out", score=80.7, score_sigma=2.6)
    told = msgspec.structs.replace(said, measures=measures, shown=("knee_bend", "hand_height"))
    text = Reader(html(told)).text
    taught = shipped().teachings["basketball_shot"]
    faults = {fault.name: fault for fault in taught.fault}
    assert "Score 81 ± 3" in text
    assert "34 ± 4°" in text
    assert "13.5 ± 0.9 %" in text
    assert text.index(faults["elbow_out"].praise.en) < text.rindex(faults["no_knee_bend"].cue.en)
    assert all(silence not in text for silence in WORDS["en"].silence.values())


def test_numbers_are_written_as_the_language_does() -> None:
    measures = (MeasureResult("knee_bend", -13.52, 0.86, "deg", "poor", 45, 90.5),)
    told = attempt(measures=measures, shown=("knee_bend",))
    assert "\u221213,5 ± 0,9°" in Reader(html(told, language="de")).text
    assert "\u221213.5 ± 0.9°" in Reader(html(told, language="zh")).text


def test_measured_values_are_written_as_on_the_page() -> None:
    """`tests/text.test.ts` of the page reads the same table."""
    for case in json.loads((GOLDEN / "numbers/estimates.json").read_text()):
        assert estimate(case["value"], case["sigma"], case["unit"], WORDS["en"]).replace("\u00a0", " ") == case["text"], case


@pytest.mark.parametrize(
    ("low", "high", "unit", "text"),
    [
        (0.25, 0.45, "s", "0.25 … 0.45 s"),
        (45, 90, "deg", "45 … 90°"),
        (-4.0, 4.0, "deg", "\u22124 … 4°"),
        (12.5, None, "pct", "≥ 12.5 % of height"),
        (None, 1.125, "m_s", "≤ 1.125 m/s"),
        (None, None, "deg", ""),
    ],
)
def test_what_is_good_is_written_as_the_teaching_file_has_it(low: float | None, high: float | None, unit: str, text: str) -> None:
    assert between(low, high, unit, WORDS["en"]).replace("\u2009", " ").replace("\u00a0", " ") == text


def test_a_number_that_is_known_and_says_nothing_for_sure_is_not_called_unknown() -> None:
    measures = (MeasureResult("knee_bend", 62.0, 30.0, "deg", "unknown", 45, 90),)
    text = Reader(html(attempt(measures=measures, shown=("knee_bend",)))).text
    assert "62 ± 30° ? Not sure" in text
    assert "Not known" not in text


def test_a_percentage_says_what_it_is_of() -> None:
    measures = (MeasureResult("hand_height", 13.52, 0.86, "pct", "good", 9, 22),)
    told = attempt(measures=measures, shown=("hand_height",))
    for language in get_args(Language):
        assert f"22 % {WORDS[language].of_height}" in Reader(html(told, language=language)).text


def test_attempts_of_nobody_have_no_mean_score_which_would_be_taken_for_somebodys() -> None:
    told = (attempt(score=80.0, score_sigma=4.0), attempt(score=60.0, score_sigma=6.0))
    assert WORDS["en"].mean_score not in html(*told)
    named = html(*((one, "7") for one in told))
    assert WORDS["en"].mean_score in named
    assert "70 ± 5" in Reader(named).text


def test_what_is_not_known_is_said_and_no_number_stands_there() -> None:
    measures = (MeasureResult("knee_bend", None, None, "deg", "unknown", 45, 90),)
    told = attempt(measures=measures, shown=("knee_bend",), score=None, score_sigma=None, cue="", cue_certainty=0.0, praise="")
    text = Reader(html(told)).text
    assert "Score: not known" in text
    assert "not known good: 45 … 90°" in text.replace("\u2009", " ")
    assert "Not seen well enough to judge" in text
    assert "Good " not in text.split("Attempt 1")[1].split("Seen from")[0]
    assert " 0 ± " not in text


def test_silence_is_not_praise() -> None:
    text = Reader(html(attempt(cue="", cue_certainty=0.0, praise="", score=90.0, score_sigma=3.0))).text
    assert WORDS["en"].silence["unsure"] in text
    assert "✓ Good" not in text.split("Attempt 1")[1].split("Seen from")[0]


@pytest.mark.parametrize("language", get_args(Language))
def test_silence_says_what_it_means_and_the_same_as_the_tablet(language: Language) -> None:
    words = WORDS[language]
    unseen: dict[str, Any] = {"cue": "", "cue_certainty": 0.0, "score": None, "score_sigma": None, "measures": (), "shown": ()}
    seen = {**unseen, "score": 90.0, "score_sigma": 3.0, "judgements": (Judgement("elbow_out", 0.0, 0.1),), "praise": ""}
    every = {*words.silence.values(), words.rest}
    for told, silence, said in (
        ({**seen, "fine": True}, "fine", words.silence["fine"]),
        ({**seen, "praise": "elbow_out", "fine": True}, "fine", words.silence["fine"]),
        (seen, "unsure", words.silence["unsure"]),
        ({**unseen, "praise": ""}, "unseen", words.silence["unseen"]),
        ({**unseen, "praise": "elbow_out"}, "unseen", words.rest),
    ):
        made = attempt(**told)
        assert shown_of(made).silence == sheet(made).report.attempts[0].silence == silence
        article = html(made, language=language).partition("<article>")[2]
        assert {one for one in every if one in article} == {said}


def test_in_the_table_nothing_to_correct_is_said_only_of_what_was_fine_each_time() -> None:
    fine = attempt("squat")
    silent: dict[str, Any] = {"cue": "", "cue_certainty": 0.0}
    unsure, unseen = attempt("squat", **silent), attempt("squat", **silent, score=None, score_sigma=None)
    assert [one.silence for one in (fine, unsure, unseen)] == ["fine", "unsure", "unseen"]
    for attempts, said in (((fine, fine), "fine"), ((fine, unseen), "unsure"), ((unsure,), "unsure"), ((unseen, unseen), "unseen")):
        table = Reader(html(*attempts)).text.split("Score of each attempt")[0]
        assert {one for one in WORDS["en"].silence.values() if one in table} == {WORDS["en"].silence[said]}  # type: ignore[index]


def test_each_pupil_has_a_sheet_of_his_own_on_which_nobody_else_is() -> None:
    source = html((attempt(), "P12"), (attempt("squat"), "P07"), attempt())
    sections = re.findall(r"<section>.*?</section>", source, re.DOTALL)
    assert len(sections) == 3
    assert [("P07" in one, "P12" in one) for one in sections] == [(True, False), (False, True), (False, False)]


def drawn(told: object, class_: str) -> int:
    source = figures(told, WORDS["en"], "")  # type: ignore[arg-type]
    return len(re.findall(rf'class="{class_} edge"', source))


def test_the_time_since_the_start_is_as_unsure_below_the_figure_as_in_the_gradebook() -> None:
    told = attempt()
    (row,) = csv.DictReader(io.StringIO(csv_file.encode(sheet(told).report).decode("utf-8-sig"), newline=""))
    said = estimate(float(row["duration_s"]), float(row["duration_s_sigma"]), "s", WORDS["en"])
    assert said.endswith("±\u00a00.03\u00a0s")
    captions = re.findall(r">([^<]*±[^<]*)</text>", figures(told, WORDS["en"], ""))
    assert len(captions) == 3
    assert captions[-1] == said
    assert {caption.split("±")[1] for caption in captions} == {said.split("±")[1]}


@pytest.mark.parametrize(
    ("unseen", "vague"), [((), []), (("peak",), [2]), (("end", "exertion"), [1, 3]), (("start",), [0, 1, 2, 3])]
)
def test_when_a_keyframe_was_that_nobody_saw_is_grey_and_has_no_number(unseen: tuple[Phase, ...], vague: list[int]) -> None:
    words = WORDS["en"]
    source = figures(attempt(keyframes_unseen=unseen), words, "")
    captions = [re.search(rf">{number}  [^<]*</text>(.*?)(?=<line|$)", source) for number in range(1, 5)]
    said = [caption.group(1) if caption else "" for caption in captions]
    assert [place for place, one in enumerate(said) if f'class="when vague" text-anchor="middle">{words.no_time}<' in one] == vague
    assert [place for place, one in enumerate(said) if "±" in one] == sorted({1, 2, 3} - set(vague))


def test_a_figure_is_painted_as_its_joints_are_judged() -> None:
    told = attempt()
    for colour, class_ in ((Colour.GREEN, "good"), (Colour.YELLOW, "near"), (Colour.RED, "off")):
        painted = attempt(colours=np.full_like(told.colours, colour))
        assert drawn(painted, class_) > 40
        assert sum(drawn(painted, other) for other in {"good", "near", "off", "unsure"} - {class_}) == 0


def test_what_was_guessed_is_hollow_and_what_is_unknown_is_not_drawn() -> None:
    whole = attempt()
    guessed = attempt(guessed=("left_knee",))
    assert drawn(whole, "unsure") == 0
    # The halves of thigh and shank at the knee, at each of the four keyframes.
    assert drawn(guessed, "unsure") == 8
    hidden = attempt(hidden=("left_knee",))
    assert drawn(hidden, "unsure") == 0
    parts = [sum(drawn(one, class_) for class_ in ("good", "near", "off")) for one in (whole, hidden)]
    assert parts[0] - parts[1] == 16


def test_somebody_who_was_not_seen_at_all_is_a_question_mark_and_no_figure() -> None:
    told = attempt()
    nothing = np.zeros_like(told.states)
    nobody = attempt(states=nothing, colours=nothing, standard_m=np.full_like(told.standard_m, np.nan))
    source = figures(nobody, WORDS["en"], "")
    assert source.count(">?</text>") == 4
    assert "edge" not in source
    assert "shadow" not in source
    assert "NaN" not in html(nobody)
    assert "nan" not in html(nobody)


@pytest.mark.parametrize("action", ACTIONS)
@pytest.mark.parametrize("handed", ["right", "left"])
def test_every_action_is_drawn_within_its_paper(action: str, handed: str) -> None:
    told = attempt(action, handed=handed)  # type: ignore[arg-type]
    tags = Reader(figures(told, WORDS["en"], "")).tags
    width, height = (float(str(tags[0][1][name]).removesuffix("mm")) for name in ("width", "height"))
    shapes = [attributes["points"] for tag, attributes in tags if tag in {"polyline", "polygon"}]
    assert len(shapes) > 80
    for shape in shapes:
        points = np.array([pair.split(",") for pair in str(shape).split()], np.float64)
        assert (points >= 0).all()
        assert (points <= (width, height)).all()
    assert len(curves_of(told, shipped().teachings[action])) == 2


def test_a_head_is_as_bad_as_the_worst_of_its_points_and_good_if_two_of_them_are() -> None:
    """`tests/figure.test.ts` of the page reads the same table."""
    for case in json.loads((GOLDEN / "head/levels.json").read_text()):
        assert together(np.array(case["points"], np.uint8)) == case["head"], case


def test_each_corner_of_the_trunk_is_as_its_own_joint_is_judged() -> None:
    told = attempt()
    grey = np.full(coco.COUNT, Colour.GREY, np.uint8)
    grey[coco.INDEX["left_shoulder"]] = Colour.RED
    (trunk,) = (part for part in parts_of(told.joints_m[0].astype(np.float64), grey) if isinstance(part, Trunk))
    assert trunk.colours == (Colour.RED, Colour.GREY, Colour.GREY, Colour.GREY)
    colours = told.colours.copy()
    colours[:] = Colour.GREEN
    colours[:, coco.INDEX["left_shoulder"]] = Colour.RED
    painted = attempt(colours=colours)
    # At each of the four keyframes the near half of an upper arm, and a quarter of the trunk.
    assert drawn(painted, "off") == 8


@pytest.mark.parametrize(("far", "class_"), [(Colour.RED, "off"), (Colour.GREY, "unsure")])
def test_nothing_good_lies_on_top_of_a_shoulder_that_is_not(far: Colour, class_: str) -> None:
    """Who leads with the right is seen from there, and his left shoulder lies behind the right one."""
    colours = np.full_like(attempt("squat").colours, Colour.GREEN)
    colours[:, coco.INDEX["left_shoulder"]] = far
    tags = Reader(figures(attempt("squat", colours=colours, cue="", cue_certainty=0.0), WORDS["en"], "")).tags
    trunks = [
        str(attributes["class"]).split()[0] for tag, attributes in tags if tag == "polygon" and "edge" in str(attributes["class"])
    ]
    assert trunks == ["good", "good", class_] * 4


@pytest.mark.parametrize("action", ACTIONS)
def test_stars_and_wheels_are_seen_from_the_front_and_all_else_from_the_side(action: str) -> None:
    source = figures(attempt(action, cue="", cue_certainty=0.0), WORDS["en"], "")
    front = action in {"star_jump", "cartwheel"}
    assert (WORDS["en"].seen_from["front"] in source, WORDS["en"].seen_from["side"] in source) == (front, not front)


def test_what_was_wrong_aside_is_seen_from_the_front() -> None:
    told = attempt("squat", cue="knees_in", cue_certainty=0.9, praise="")
    across = told.standard_m[0, coco.INDEX["left_hip"]] - told.standard_m[0, coco.INDEX["right_hip"]]
    fallen = told.joints_m.copy()
    fallen[:, coco.INDEX["left_knee"]] -= 0.8 * across
    seen = [figures(msgspec.structs.replace(told, joints_m=joints), WORDS["en"], "") for joints in (told.standard_m, fallen)]
    assert [WORDS["en"].seen_from["front"] in one for one in seen] == [False, True]


def test_who_leads_with_the_left_is_seen_from_the_left() -> None:
    """On paper the nose of who throws with the right is to the right of his head, and the other way round."""
    for handed, way in (("right", 1), ("left", -1)):
        told = attempt(handed=handed, cue="", cue_certainty=0.0)  # type: ignore[arg-type]
        heads = [attributes for tag, attributes in Reader(figures(told, WORDS["en"], "")).tags if tag == "circle"]
        noses = [float(str(one["cx"])) for one in heads if one["class"] == "nose"]
        middles = [float(str(one["cx"])) for one in heads if "edge" in str(one["class"])]
        assert len(noses) == len(middles) == 4
        assert all(way * (nose - middle) > 0 for nose, middle in zip(noses, middles, strict=True))


def test_curves_are_of_what_the_cue_is_about() -> None:
    told = attempt(cue="no_knee_bend", cue_certainty=0.9, praise="")
    first = curves_of(told, shipped().teachings["basketball_shot"])[0]
    assert first.signal == "knee_flexion"


def test_the_pupils_curve_lies_in_the_band_when_he_does_as_the_model() -> None:
    told = attempt("squat", exemplar=0, cue="", cue_certainty=0.0)
    for curve in curves_of(told, shipped().teachings["squat"]):
        low, high = curve.band_deg
        known = np.isfinite(curve.pupil_deg)
        assert known.mean() > 0.9
        inside = (curve.pupil_deg >= low - curve.sigma_deg) & (curve.pupil_deg <= high + curve.sigma_deg)
        assert inside[known].mean() > 0.95
        assert 0 < curve.sigma_deg < 15


def test_an_arm_that_circles_once_more_than_the_model_is_drawn_beside_it_again_and_no_line_leads_across() -> None:
    told = attempt("volleyball_spike", exemplar=0, cue="", cue_certainty=0.0)
    peak, circled = told.frame_of(told.keyframes_ns[2]), 12
    joints = told.joints_m.copy()
    shoulder = joints[:, coco.INDEX["right_shoulder"]]
    for frame in range(peak, peak + circled):
        turn = 2 * np.pi * (frame - peak) / circled
        about_z = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
        for name in ("right_elbow", "right_wrist"):
            arm = joints[frame, coco.INDEX[name]] - shoulder[frame]
            joints[frame, coco.INDEX[name]] = shoulder[frame] + about_z @ arm
    circles = msgspec.structs.replace(told, joints_m=joints)
    curve = next(one for one in curves_of(circles, shipped().teachings["volleyball_spike"]) if one.signal == "upper_arm_azimuth")
    apart = np.abs(curve.pupil_deg - curve.standard_deg)
    assert np.nanmax(apart) <= 180 + 1e-6
    assert np.nanmedian(apart[peak + circled :]) < 30
    drawn = curve_chart.chart(curve, circles, "arm", WORDS["en"])
    heights = [
        np.array([float(place.split(",")[1]) for place in line.split()])
        for line in re.findall(r'<polyline points="([^"]*)" class="pupil"', drawn)
    ]
    assert len(heights) > 1
    assert max(np.abs(np.diff(line)).max(initial=0) for line in heights) < curve_chart.HEIGHT_MM / 2


def test_an_angle_that_was_not_seen_has_no_curve() -> None:
    legs = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in ("knee", "ankle"))
    told = attempt("squat", hidden=legs)
    assert all("knee" not in curve.signal for curve in curves_of(told, shipped().teachings["squat"]))
    assert all("knee" not in curve.signal for curve in curves_of(told, None))


@pytest.mark.parametrize("language", get_args(Language))
def test_every_word_is_there_in_every_language(language: Language) -> None:
    words, english = WORDS[language], WORDS["en"]
    assert set(WORDS) == set(get_args(Language))
    for name in Words.__dataclass_fields__:
        said, original = getattr(words, name), getattr(english, name)
        assert type(said) is type(original)
        if isinstance(said, dict):
            assert said.keys() == original.keys()
            assert all(said.values())
        else:
            assert said
            assert set(re.findall(r"\{\w+\}", str(said))) == set(re.findall(r"\{\w+\}", str(original)))


def test_every_angle_has_a_name_in_every_language() -> None:
    angles = {signal.name for signal in CATALOGUE.values() if signal.unit == "deg"}
    assert {name: set(ANGLES.get(name, {})) for name in angles} == {name: set(get_args(Language)) for name in angles}
    assert ANGLES.keys() <= angles


@pytest.mark.parametrize("language", get_args(Language))
def test_paper_and_tablet_call_the_same_by_the_same_words(language: Language) -> None:
    words = WORDS[language]
    tablet = (ROOT / f"services/tablet/web/src/text/{language}.ts").read_text()
    said = [
        *words.verdicts.values(),
        *words.colours.values(),
        *words.phases,
        words.model,
        *words.silence.values(),
        words.rest,
        words.next_time,
        words.of_height,
    ]
    assert [one for one in (*said, words.score, words.action) if f"'{one}'" not in tablet] == []
