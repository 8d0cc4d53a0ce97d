"""Fit the twin to rendered lessons and print how far it can be trusted: `make twin`.

It is fitted to lessons of development pupils and judged on lessons of test pupils, of whom it therefore knows nothing. What has to
be rendered and looked at first takes some minutes a lesson, once. `--leave-out` fits to the test pupils' lessons instead, judges
each by a twin that was fitted to the others, and writes no file: a quick look where only those are rendered.
"""

import argparse
import sys
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Final

from edge.simulation.lesson.presets import acceptance
from edge.simulation.split import Split
from models.errors import UserError
from tests.bench.kept import keep
from tests.bench.reconstruct.lesson import Lesson
from tests.bench.reconstruct.observed import DELAY_NS, LIVE_HZ, Looking, observed
from tests.bench.reconstruct.rendered import render_all, rendered_lesson
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.twin.agreement import BAR_PCT, Agreement, Case, agree
from tests.twin.fit import Choice, fit, to_file
from tests.twin.rendered import streams_of
from tests.twin.truth import Stream
from tests.twin.twin import FILE, Twin

_DELAY_S: Final = DELAY_NS * 1e-9
_BARS: Final = {f"twin.{name}_gap_pct": ("within", BAR_PCT) for name in ("mpjpe", "jitter")}


def main() -> int:
    """Fit, judge, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--seeds", type=int, default=COUNT, help="lessons of each kind")
    parser.add_argument("--keep", action="store_true", help="judge the twin that is there; fit nothing")
    parser.add_argument("--leave-out", action="store_true", help="fit to the lessons that are judged, leaving each out in its turn")
    options = parser.parse_args()
    try:
        report = Report("twin", seeds_of("test", options.seeds))
        agreement = left_out(options) if options.leave_out else judged(options)
    except UserError as error:
        sys.stderr.write(f"twin: {error}\n")
        return 2
    report.add(agreement.figures())
    report.tables += agreement.tables()
    return report.conclude(_BARS, options.data)


def judged(options: argparse.Namespace) -> Agreement:
    """A twin of development pupils, on test pupils."""
    if options.keep:
        twin = Twin.load()
    else:
        twin = fit(_streams(cases("development", options.seeds, options.data)), shown=_told)
        keep(FILE, to_file(twin))
        print(f"fitted to {len(twin.library)} pictures, written to {FILE}")
    return agree(cases("test", options.seeds, options.data), lambda _: twin, shown=_done)


def left_out(options: argparse.Namespace) -> Agreement:
    """For each test pupil a twin of the others."""
    known = cases("test", options.seeds, options.data)

    @cache
    def without(seed: int) -> Twin:
        return fit([stream for stream in _streams(known) if stream.seed != seed], shown=_told)

    return agree(known, lambda lesson: without(lesson.seed), shown=_done)


def cases(split: Split, seeds: int, data: Path) -> list[Case]:
    """Rendered, and looked at at the live rate, both from the cache if they are there."""
    plans = [acceptance(seed, split) for seed in seeds_of(split, seeds)]
    render_all(plans, data)
    return [_case(rendered_lesson(plan, data), data) for plan in plans]


def _case(lesson: Lesson, data: Path) -> Case:
    looking = Looking(lesson.rig.names, LIVE_HZ)
    events = observed(lesson, looking, data).events
    print(f"{lesson.name}: looked at")
    return Case(lesson, looking.cameras, events, _DELAY_S)


def _streams(known: Sequence[Case]) -> list[Stream]:
    return [stream for case in known for stream in streams_of(case.lesson, case.cameras, case.events, case.delay_s)]


def _told(choice: Choice) -> None:
    apart = ", ".join(f"{name} {value:.3f}" for name, value in choice.apart.items())
    print(f"{choice.settings.partition}, {choice.settings.neighbours} neighbours: apart from left-out lessons by {apart}")


def _done(case: Case) -> None:
    print(f"{case.lesson.name}: judged")


if __name__ == "__main__":
    sys.exit(main())
