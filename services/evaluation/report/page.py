"""A report as one page to print: A4, no script, nothing from elsewhere. Each pupil begins a new sheet, which he may be given."""

import datetime as dt
from collections.abc import Iterator
from typing import Final

from models.messages.feedback import Colour, Silence, Verdict
from services.evaluation.report import curve_chart, scores
from services.evaluation.report.curve import curves_of
from services.evaluation.report.document import ActionSummary, Attempt, Measure, PupilSummary, Report
from services.evaluation.report.figures import HATCHED, PAINT, figures
from services.evaluation.report.hatching import hatched
from services.evaluation.report.numbers import between, clock, escaped, estimate
from services.evaluation.report.sheet import Sheet, Tried
from services.evaluation.report.style import STYLE
from services.evaluation.report.svg import element
from services.evaluation.report.words import WORDS, Words

_POLICY: Final = "default-src 'none'; style-src 'unsafe-inline'"
_MARKS: Final[dict[Verdict, str]] = {"good": "✓", "fair": "≈", "poor": "!", "unknown": "?"}


def encode(sheet: Sheet) -> bytes:
    """The file: HTML, UTF-8."""
    report = sheet.report
    words = WORDS[report.language]
    title = report.lesson.title or report.lesson.name
    body = "".join(_pupil(sheet, summary, words) for summary in report.pupils)
    lines = (
        "<!doctype html>",
        f'<html lang="{report.language}">',
        "<head>",
        '<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">',
        '<meta name="viewport" content="width=device-width">',
        f"<title>{escaped(f'{words.report}: {title}')}</title>",
        f"<style>{STYLE}</style>",
        "</head>",
        f"<body><main>{body}</main></body>",
        "</html>",
    )
    return ("\n".join(lines) + "\n").encode()


def _pupil(sheet: Sheet, summary: PupilSummary, words: Words) -> str:
    own = [
        (attempt, tried)
        for attempt, tried in zip(sheet.report.attempts, sheet.tried, strict=True)
        if attempt.pupil == summary.pupil
    ]
    attempts = "".join(_attempt(sheet, attempt, tried, words) for attempt, tried in own)
    head = _lesson(sheet.report, summary, words)
    return f"<section>{head}{_summary(summary, [attempt for attempt, _ in own], words)}{attempts}</section>\n"


def _lesson(report: Report, summary: PupilSummary, words: Words) -> str:
    lesson = report.lesson
    begun = dt.datetime.fromisoformat(lesson.begun)
    who = words.nobody if summary.pupil is None else f"{words.pupil} {summary.pupil}"
    facts = [who, f"{begun.strftime(words.day)} {begun:%H:%M}", f"{words.length} {clock(lesson.seconds)}"]
    again = f'<p class="notes">{escaped(words.again)}</p>' if report.source == "evaluated" else ""
    return (
        f'<header class="lesson"><h1>{escaped(lesson.title or lesson.name)}</h1>'
        f'<p class="facts">{escaped(" · ".join(facts))}</p>{again}</header>'
    )


def _summary(summary: PupilSummary, attempts: list[Attempt], words: Words) -> str:
    named = summary.pupil is not None
    tried = {action.action: [one for one in attempts if one.action == action.action] for action in summary.actions}
    rows = "".join(_row(place, action, tried[action.action], words, named=named) for place, action in enumerate(summary.actions))
    mean = f'<th class="number">{escaped(words.mean_score)}</th>' if named else ""
    head = (
        f'<tr><th>{escaped(words.action)}</th><th class="number">{escaped(words.attempts)}</th>'
        f"{mean}<th>{escaped(words.most_often)}</th></tr>"
    )
    drawing = scores.chart(summary, attempts, words.scores)
    return (
        f"<table><thead>{head}</thead><tbody>{rows}</tbody></table><h2>{escaped(words.scores)}</h2>{drawing}"
        f'<p class="notes">{escaped(words.plus_minus)} {escaped(words.not_measured)}</p>'
    )


def _row(place: int, action: ActionSummary, tried: list[Attempt], words: Words, *, named: bool) -> str:
    """Without a mean score where nobody was named: it would be taken for somebody's."""
    mean = f'<td class="number">{_points(action.score, action.score_sigma, words)}</td>' if named else ""
    if action.cue is None:
        cue = words.silence[_together(tried)]
    else:
        often = words.of.format(count=action.cue_count, all=action.attempts).replace(" ", "\u00a0")
        cue = f"{action.cue_text or _plain(action.cue)} ({often})"
    return (
        f'<tr><td><span class="key">{scores.letter(place)}</span>{escaped(action.title or _plain(action.action))}</td>'
        f'<td class="number">{action.attempts}</td>{mean}<td>{escaped(cue)}</td></tr>'
    )


def _together(tried: list[Attempt]) -> Silence:
    """What it means that none of these attempts was corrected: only what is said of all is said of them together."""
    said = {attempt.silence for attempt in tried}
    return "fine" if said == {"fine"} else "unseen" if said == {"unseen"} else "unsure"


def _attempt(sheet: Sheet, attempt: Attempt, tried: Tried, words: Words) -> str:
    title = attempt.title or _plain(attempt.action)
    begun = dt.datetime.fromisoformat(attempt.begun)
    who = [] if attempt.pupil is None else [f"{words.pupil} {attempt.pupil}"]
    facts = " · ".join([words.attempt.format(number=attempt.number), *who, f"{begun:%H:%M:%S}", words.handed[attempt.handed]])
    drawn = figures(tried.feedback, words, f"{title}: {', '.join(words.phases)}")
    return (
        f'<article><div class="head"><h2>{escaped(title)}</h2><p class="facts">{escaped(facts)}</p>{_score(attempt, words)}</div>'
        f"{_said(attempt, words)}{drawn}{_legend(words)}"
        f'<div class="below"><ul class="measures">{"".join(_measure(one, words) for one in attempt.measures if one.shown)}</ul>'
        f"{''.join(_curves(sheet, tried, words))}</div></article>\n"
    )


def _score(attempt: Attempt, words: Words) -> str:
    if attempt.score is None:
        return f'<span class="points unknown">{escaped(words.score)}: {escaped(words.not_known)}</span>'
    value, _, sigma = _points(attempt.score, attempt.score_sigma, words).partition("\u00a0")
    return f'<span class="points">{escaped(words.score)} <b>{value}</b>\u00a0{sigma}</span>'


def _said(attempt: Attempt, words: Words) -> str:
    return f'<div class="said">{_good(attempt, words)}{_next(attempt, words)}</div>'


def _good(attempt: Attempt, words: Words) -> str:
    if attempt.praise is None:
        return ""
    text = attempt.praise.text or _plain(attempt.praise.point)
    return f'<p class="praise"><b>✓ {escaped(words.good)}</b><span>{escaped(text)}</span></p>'


def _next(attempt: Attempt, words: Words) -> str:
    """What to correct, or what it means that there is nothing."""
    if attempt.cue is not None:
        text = attempt.cue.text or _plain(attempt.cue.fault)
        return f'<p class="next"><b>→ {escaped(words.next_time)}</b><span>{escaped(text)}</span></p>'
    silence = attempt.silence or "unsure"
    text = words.rest if silence == "unseen" and attempt.praise is not None else words.silence[silence]
    return f'<p class="next silent"><span>{escaped(text)}</span></p>'


def _measure(measure: Measure, words: Words) -> str:
    known = measure.value is not None
    # The number may be known and still say nothing for sure.
    said = words.colours[Colour.GREY] if measure.verdict == "unknown" else words.verdicts[measure.verdict]
    mark = f"{_MARKS[measure.verdict]} {said}" if known else ""
    value = _estimate(measure.value, measure.sigma, measure.unit, words)
    wanted = between(measure.low, measure.high, measure.unit, words)
    lines = (
        f'<span class="what">{escaped(measure.title or _plain(measure.name))}</span>',
        f'<span class="value{"" if known else " unknown"}">{value}</span>',
        f'<span class="verdict{" unknown" if measure.verdict == "unknown" else ""}">{escaped(mark)}</span>',
        f'<span class="range">{escaped(words.should_be.format(range=wanted))}</span>' if wanted else "",
    )
    return f"<li>{' '.join(lines)}</li>"


def _curves(sheet: Sheet, tried: Tried, words: Words) -> Iterator[str]:
    feedback = tried.feedback
    found = curves_of(feedback, sheet.teachings.get(feedback.action))
    if not found:
        yield f'<p class="unknown">{escaped(words.no_curve)}</p>'
    for curve in found:
        title = curve_chart.title_of(curve, sheet.report.language, words)
        legend = curve_chart.legend_of(curve, words)
        drawn = curve_chart.chart(curve, feedback, title, words)
        yield (
            f'<figure class="curve"><figcaption class="name">{escaped(title)}</figcaption>{drawn}'
            f"<figcaption>{escaped(legend)}</figcaption></figure>"
        )


def _legend(words: Words) -> str:
    order = (Colour.GREEN, Colour.YELLOW, Colour.RED, Colour.GREY)
    entries = [(PAINT[colour], words.colours[colour]) for colour in order] + [("shadow", words.model)]
    return '<p class="legend">' + "".join(f"<span>{_swatch(class_)}{escaped(name)}</span>" for class_, name in entries) + "</p>"


def _swatch(paint: str) -> str:
    box = element("rect", x=0.2, y=0.2, width=4.6, height=2.2, rx=1.1, class_=paint if paint == "shadow" else f"{paint} edge")
    marks = hatched([(0.5, 0.2), (4.5, 0.2), (4.5, 2.4), (0.5, 2.4)], HATCHED[paint]) if paint in HATCHED else ""
    return f'<svg viewBox="0 0 5 2.6" aria-hidden="true">{box}{marks}</svg>'


def _estimate(value: float | None, sigma: float | None, unit: str, words: Words) -> str:
    return escaped(estimate(value, sigma, unit, words))


def _points(score: float | None, sigma: float | None, words: Words) -> str:
    """No score is known better than to a point."""
    return _estimate(score, None if sigma is None else max(sigma, 1.0), "", words)


def _plain(name: str) -> str:
    """Of what is not taught any more there is only the name."""
    return name.replace("_", " ")
