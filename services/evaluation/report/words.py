# ruff: noqa: RUF001 - Chinese has a punctuation of its own
"""Every word on the printed page, in the languages of the box. What is taught brings its own; see `models.teaching.schema`."""

from dataclasses import dataclass
from typing import Final, Literal

from models.messages.feedback import Colour, Silence, Verdict
from models.teaching.measure import Side
from models.teaching.schema import Language

Seen = Literal["side", "front"]
"""From where a figure is drawn."""


@dataclass(frozen=True)
class Words:
    """Of one language.

    Attributes:
        day: `strftime` format of a day.
        comma: decimal sign.
        report: title of the page.
        pupil, nobody: heading of a pupil's part, and what stands there without a code.
        length: of the lesson.
        attempts: count of attempts, heading of a column.
        attempt: heading of an attempt, with {number}.
        action, mean_score, most_often: headings of columns.
        of: "3 of 8"; with {count} and {all}.
        scores: title of the drawing of scores.
        good: before what was good.
        next_time: before what to correct.
        silence: in the place of what to correct.
        rest: the same where something was good, and too little else was seen.
        score: before a score.
        not_known: in the place of a number.
        no_time: in the place of when a keyframe was that nobody saw.
        of_height: behind a percentage of the pupil's height.
        should_be: what is good; with {range}.
        verdicts, colours: what they mean.
        model: what the shadow is.
        phases: start, exertion, peak, end.
        seen_from: from where the figures are drawn.
        handed: right, left; the side that leads.
        sides: which limb.
        band: what the band of a curve is; with {tolerance}.
        curve_sigma: how sure a curve is; with {sigma}.
        curve_gap: where there is no curve.
        no_curve: no angle was seen.
        plus_minus: what stands behind it.
        not_measured: what per cent are of, and what nothing is said about.
        again: the motion was evaluated again.
        seconds: axis of time.
    """

    day: str
    comma: str
    report: str
    pupil: str
    nobody: str
    length: str
    attempts: str
    attempt: str
    action: str
    mean_score: str
    most_often: str
    of: str
    scores: str
    good: str
    next_time: str
    silence: dict[Silence, str]
    rest: str
    score: str
    not_known: str
    no_time: str
    of_height: str
    should_be: str
    verdicts: dict[Verdict, str]
    colours: dict[Colour, str]
    model: str
    phases: tuple[str, str, str, str]
    seen_from: dict[Seen, str]
    handed: dict[str, str]
    sides: dict[Side, str]
    band: str
    curve_sigma: str
    curve_gap: str
    no_curve: str
    plus_minus: str
    not_measured: str
    again: str
    seconds: str


def _verdicts(good: str, fair: str, poor: str, unknown: str) -> dict[Verdict, str]:
    return {"good": good, "fair": fair, "poor": poor, "unknown": unknown}


def _silence(fine: str, unsure: str, unseen: str) -> dict[Silence, str]:
    return {"fine": fine, "unsure": unsure, "unseen": unseen}


def _sides(lead: str, other: str, both: str, left: str, right: str) -> dict[Side, str]:
    return {"lead": lead, "other": other, "both": both, "left": left, "right": right}


def _colours(green: str, yellow: str, red: str, grey: str) -> dict[Colour, str]:
    return {Colour.GREEN: green, Colour.YELLOW: yellow, Colour.RED: red, Colour.GREY: grey}


WORDS: Final[dict[Language, Words]] = {
    "en": Words(
        day="%Y-%m-%d",
        comma=".",
        report="Lesson report",
        pupil="Pupil",
        nobody="Pupils not named",
        length="Length",
        attempts="Attempts",
        attempt="Attempt {number}",
        action="Activity",
        mean_score="Mean score",
        most_often="Most often to correct",
        of="{count} of {all}",
        scores="Score of each attempt",
        good="Good",
        next_time="Next time",
        silence=_silence("No correction this time", "Nothing clear to correct this time", "Not seen well enough to judge"),
        rest="The rest was not seen well enough",
        score="Score",
        not_known="not known",
        no_time="time not known",
        of_height="of height",
        should_be="good: {range}",
        verdicts=_verdicts("Good", "Nearly", "Work on it", "Not known"),
        colours=_colours("As it should be", "A little off", "Off", "Not sure"),
        model="Model",
        phases=("Start", "Effort", "Peak", "End"),
        seen_from={"side": "Seen from the side", "front": "Seen from the front"},
        handed={"right": "right leads", "left": "left leads"},
        sides=_sides("leading side", "other side", "mean of both sides", "left", "right"),
        band="grey: within {tolerance} of the model",
        curve_sigma="black: pupil, ± {sigma}",
        curve_gap="hatched: not sure",
        no_curve="No angle was seen well enough for a curve.",
        plus_minus="± is one standard deviation: two measurements in three are no further off.",
        not_measured="% is of the pupil's height. Feet and hands are not measured.",
        again="Evaluated again from the recorded motion, by what is taught today.",
        seconds="seconds from the start",
    ),
    "zh": Words(
        day="%Y年%m月%d日",
        comma=".",
        report="课堂报告",
        pupil="学生",
        nobody="未指定学生",
        length="时长",
        attempts="次数",
        attempt="第 {number} 次",
        action="项目",
        mean_score="平均得分",
        most_often="最常要纠正的",
        of="{all} 次中 {count} 次",
        scores="每次得分",
        good="做得好",
        next_time="下一次",
        silence=_silence("这次没有要纠正的", "这次没有明确要纠正的", "看得不够清楚，无法评价"),
        rest="其余部分看得不够清楚",
        score="得分",
        not_known="未知",
        no_time="时间未知",
        of_height="身高",
        should_be="良好：{range}",
        verdicts=_verdicts("好", "接近", "要练习", "未知"),
        colours=_colours("符合要求", "略有偏差", "偏差大", "不确定"),
        model="示范",
        phases=("开始", "发力", "关键", "结束"),
        seen_from={"side": "侧面图", "front": "正面图"},
        handed={"right": "右侧为主", "left": "左侧为主"},
        sides=_sides("主侧", "另一侧", "两侧平均", "左", "右"),
        band="灰色：与示范相差不超过 {tolerance}",
        curve_sigma="黑线：学生，± {sigma}",
        curve_gap="斜线处：不确定",
        no_curve="没有看得足够清楚、可以画成曲线的角度。",
        plus_minus="± 表示一个标准差：约三分之二的测量误差不超过此值。",
        not_measured="% 以学生身高为基准。脚和手不测量。",
        again="根据录下的动作，按今天的教学内容重新评价。",
        seconds="从开始起的秒数",
    ),
    "de": Words(
        day="%d.%m.%Y",
        comma=",",
        report="Stundenbericht",
        pupil="Schüler/in",
        nobody="Ohne Zuordnung",
        length="Länge",
        attempts="Versuche",
        attempt="Versuch {number}",
        action="Übung",
        mean_score="Punkte im Mittel",
        most_often="Am häufigsten zu verbessern",
        of="{count} von {all}",
        scores="Punkte je Versuch",
        good="Gut",
        next_time="Nächstes Mal",
        silence=_silence(
            "Diesmal keine Korrektur", "Diesmal nichts Klares zu korrigieren", "Nicht gut genug gesehen, um zu urteilen"
        ),
        rest="Der Rest war nicht gut genug zu sehen",
        score="Punkte",
        not_known="nicht bekannt",
        no_time="Zeit nicht bekannt",
        of_height="der Größe",
        should_be="gut: {range}",
        verdicts=_verdicts("Gut", "Fast", "Daran üben", "Nicht bekannt"),
        colours=_colours("Wie es sein soll", "Etwas daneben", "Daneben", "Nicht sicher"),
        model="Vorbild",
        phases=("Start", "Einsatz", "Höhepunkt", "Ende"),
        seen_from={"side": "Von der Seite gesehen", "front": "Von vorn gesehen"},
        handed={"right": "rechts führt", "left": "links führt"},
        sides=_sides("führende Seite", "andere Seite", "Mittel beider Seiten", "links", "rechts"),
        band="grau: bis {tolerance} vom Vorbild",
        curve_sigma="schwarz: Schüler/in, ± {sigma}",
        curve_gap="schraffiert: nicht sicher",
        no_curve="Kein Winkel war gut genug für eine Kurve zu sehen.",
        plus_minus="± ist eine Standardabweichung: Zwei von drei Messungen liegen nicht weiter daneben.",
        not_measured="% bezieht sich auf die Körpergröße. Füße und Hände werden nicht gemessen.",
        again="Aus der aufgezeichneten Bewegung neu ausgewertet, nach dem, was heute gelehrt wird.",
        seconds="Sekunden ab Beginn",
    ),
    "es": Words(
        day="%d/%m/%Y",
        comma=",",
        report="Informe de la clase",
        pupil="Alumno/a",
        nobody="Sin asignar",
        length="Duración",
        attempts="Intentos",
        attempt="Intento {number}",
        action="Actividad",
        mean_score="Puntos de media",
        most_often="Lo que más hay que corregir",
        of="{count} de {all}",
        scores="Puntos de cada intento",
        good="Bien",
        next_time="La próxima vez",
        silence=_silence(
            "Esta vez, sin correcciones",
            "Esta vez, nada claro que corregir",
            "No se vio lo bastante bien para evaluarlo",
        ),
        rest="El resto no se vio lo bastante bien",
        score="Puntos",
        not_known="desconocido",
        no_time="tiempo desconocido",
        of_height="de estatura",
        should_be="bien: {range}",
        verdicts=_verdicts("Bien", "Casi", "A trabajar", "Desconocido"),
        colours=_colours("Como debe ser", "Algo desviado", "Desviado", "No seguro"),
        model="Modelo",
        phases=("Inicio", "Impulso", "Clave", "Fin"),
        seen_from={"side": "Visto de lado", "front": "Visto de frente"},
        handed={"right": "domina la derecha", "left": "domina la izquierda"},
        sides=_sides("lado dominante", "otro lado", "media de ambos lados", "izquierda", "derecha"),
        band="gris: a menos de {tolerance} del modelo",
        curve_sigma="negro: alumno/a, ± {sigma}",
        curve_gap="rayado: no es seguro",
        no_curve="Ningún ángulo se vio lo bastante bien para una curva.",
        plus_minus="± es una desviación típica: dos de cada tres mediciones no se alejan más.",
        not_measured="El % es de la estatura. Los pies y las manos no se miden.",
        again="Evaluado de nuevo a partir del movimiento grabado, según lo que se enseña hoy.",
        seconds="segundos desde el inicio",
    ),
}

ANGLES: Final[dict[str, dict[Language, str]]] = {
    "knee_flexion": {"en": "Knee bend", "zh": "膝关节弯曲", "de": "Kniebeugung", "es": "Flexión de rodilla"},
    "elbow_flexion": {"en": "Elbow bend", "zh": "肘关节弯曲", "de": "Ellbogenbeugung", "es": "Flexión de codo"},
    "hip_flexion": {"en": "Hip bend", "zh": "髋关节弯曲", "de": "Hüftbeugung", "es": "Flexión de cadera"},
    "hip_abduction": {"en": "Leg to the side", "zh": "腿部外展", "de": "Bein zur Seite", "es": "Pierna hacia fuera"},
    "knee_valgus": {"en": "Knee fallen in", "zh": "膝内扣", "de": "Knie nach innen", "es": "Rodilla hacia dentro"},
    "shoulder_elevation": {"en": "Upper arm raised", "zh": "上臂抬起", "de": "Oberarm gehoben", "es": "Brazo elevado"},
    "shoulder_abduction": {"en": "Upper arm to the side", "zh": "上臂外展", "de": "Oberarm zur Seite", "es": "Brazo hacia fuera"},
    "shoulder_flexion": {"en": "Upper arm forward", "zh": "上臂前举", "de": "Oberarm nach vorn", "es": "Brazo hacia delante"},
    "upper_arm_azimuth": {
        "en": "Direction of the upper arm",
        "zh": "上臂方向",
        "de": "Richtung des Oberarms",
        "es": "Dirección del brazo",
    },
    "forearm_inclination": {
        "en": "Forearm off upright",
        "zh": "前臂倾斜",
        "de": "Neigung des Unterarms",
        "es": "Inclinación del antebrazo",
    },
    "head_flexion": {"en": "Chin down", "zh": "低头", "de": "Kinn gesenkt", "es": "Barbilla abajo"},
    "trunk_inclination": {"en": "Trunk off upright", "zh": "躯干倾斜", "de": "Neigung des Rumpfes", "es": "Inclinación del tronco"},
    "trunk_forward": {"en": "Trunk leant forward", "zh": "躯干前倾", "de": "Rumpf nach vorn", "es": "Tronco hacia delante"},
    "trunk_side": {"en": "Trunk leant aside", "zh": "躯干侧倾", "de": "Rumpf zur Seite", "es": "Tronco hacia un lado"},
    "trunk_twist": {"en": "Trunk twisted", "zh": "躯干扭转", "de": "Rumpf verdreht", "es": "Giro del tronco"},
    "heading": {"en": "Body turned", "zh": "身体转向", "de": "Körper gedreht", "es": "Giro del cuerpo"},
}
"""What angles are called on the page; signals that are no angles have no curve."""
