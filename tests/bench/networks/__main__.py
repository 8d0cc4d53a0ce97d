"""How well the pose networks see simulated pupils: `make bench-networks`.

Five test pupils, each in a gym and before a rig of his own, perform every action. A point is right if it is within 5 % of the
body's height of the body's own COCO point, both at the body's distance; only joints that can be seen count, and only the time of
attempts. Crops are told by the truth, with the margin that fusion's predictions have: upright, or (`.rotated`) turned with the
trunk, as the box turns them. `within5_pct.thunder.upright` is over all visible joints of the eight upright actions.

`bias_mm.<joint>`: length of the landmark bias, of Thunder in rotated crops over all actions (see
`tests.bench.networks.landmarks`); a joint stands for left and right. `--corrections` measures it on development pupils and writes
`services/fusion/landmark_bias.py`.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from models.errors import UserError
from models.motions.actions.library import ACTIONS
from models.skeleton import coco
from tests.bench.networks.corrections import write_corrections
from tests.bench.networks.judge import UPRIGHT_ACTIONS, Errors, bias_looks, by_joint, errors, within5_pct
from tests.bench.networks.landmarks import AXES, Bias, all_biases
from tests.bench.networks.looks import NETWORKS, TURNS, Looked, Name, Turn
from tests.bench.networks.plans import plan_of
from tests.bench.networks.work import look_at_all
from tests.bench.reconstruct.lesson import Lesson
from tests.bench.reconstruct.rendered import render_all, rendered_lesson
from tests.bench.report import Report
from tests.bench.seeds import COUNT, seeds_of
from tests.bench.table import Cell, ResultTable, spread, table_of

BARS: Final = {"within5_pct.thunder.upright": (">=", 93.0)}


def main() -> int:
    """Measure, print, write; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--corrections", action="store_true", help="write services/fusion/landmark_bias.py")
    parser.add_argument("--seeds", type=int, default=COUNT, help="pupils; the figures of record are of five")
    options = parser.parse_args()
    try:
        return (corrections if options.corrections else bench)(options.data, options.seeds)
    except UserError as error:
        sys.stderr.write(f"bench-networks: {error}\n")
        return 2


def corrections(data: Path, pupils: int) -> int:
    """The landmark bias of Thunder on development pupils, for fusion to take off."""
    plans = [plan_of(seed, "development") for seed in seeds_of("development", pupils)]
    render_all(plans, data)
    lessons = [rendered_lesson(plan, data) for plan in plans]
    looked = look_at_all(plans, data, ["thunder"], ["rotated"])
    thunder = [(lesson, looked[plan.name, "thunder", "rotated"]) for plan, lesson in zip(plans, lessons, strict=True)]
    print(write_corrections(biases(thunder, []), len(plans)))
    return 0


def bench(data: Path, pupils: int) -> int:
    """All networks on the test pupils; returns the exit code, 1 if a bar was missed."""
    seeds = seeds_of("test", pupils)
    report = Report("bench-networks", seeds)
    plans = [plan_of(seed, "test") for seed in seeds]
    render_all(plans, data)
    looked = look_at_all(plans, data, NETWORKS, TURNS)
    lessons = {plan.name: rendered_lesson(plan, data) for plan in plans}
    found = [each for (name, network, turn), of in looked.items() for each in errors(lessons[name], of, network, turn)]
    for network in NETWORKS:
        report.add_seeds([figures(found, network, seed) for seed in seeds])
    report.tables += [by_action(found), by_camera(found), by_pupil(found), by_joint_table(found)]
    thunder = [(lessons[plan.name], looked[plan.name, "thunder", "rotated"]) for plan in plans]
    overall = biases(thunder, [])
    report.add({f"bias_mm.{joint}": float((bias.mm**2).sum() ** 0.5) for joint, bias in overall.items()})
    report.tables += bias_tables(thunder, overall)
    return report.conclude(BARS, data)


def figures(found: Sequence[Errors], network: Name, seed: int) -> dict[str, float]:
    """One seed's figures of a network by their fixed names."""
    named: dict[str, float] = {}
    for turn, suffix in zip(TURNS, ("", ".rotated"), strict=True):
        chosen = [each for each in found if (each.network, each.turn, each.seed) == (network, turn, seed)]
        named |= {f"within5_pct.{network}.{action}{suffix}": within5_pct(chosen, (action,)) for action in ACTIONS}
        named[f"within5_pct.{network}.upright{suffix}"] = within5_pct(chosen, UPRIGHT_ACTIONS)
    return named


def by_action(found: Sequence[Errors]) -> ResultTable:
    """A row an action, a column a network and way of cropping; mean ± deviation over the pupils."""
    seeds = sorted({each.seed for each in found})
    rows: dict[str, dict[str, Cell]] = {}
    for action in (*ACTIONS, "the eight upright ones"):
        chosen = (action,) if action in ACTIONS else UPRIGHT_ACTIONS
        rows[action] = {
            f"{n}, {t}": spread([within5_pct(_of(found, n, t, seed), chosen) for seed in seeds]) for n in NETWORKS for t in TURNS
        }
    return table_of("visible joints within 5 % of body height, percent", "action", rows)


def by_camera(found: Sequence[Errors]) -> ResultTable:
    """Thunder by action and camera of the rig."""
    cameras = sorted({each.camera for each in found})
    rows: dict[str, dict[str, Cell]] = {
        action: {
            f"{camera}, {turn}": within5_pct([each for each in _of(found, "thunder", turn) if each.camera == camera], (action,))
            for turn in TURNS
            for camera in cameras
        }
        for action in ACTIONS
    }
    return table_of("Thunder by camera, percent within 5 %", "action", rows)


def by_pupil(found: Sequence[Errors]) -> ResultTable:
    """Thunder by action and pupil."""
    pupils = dict.fromkeys((each.seed, each.pupil) for each in found)
    rows: dict[str, dict[str, Cell]] = {
        action: {
            f"{pupil}, {turn}": within5_pct(_of(found, "thunder", turn, seed), (action,))
            for turn in TURNS
            for seed, pupil in pupils
        }
        for action in ACTIONS
    }
    return table_of("Thunder by pupil, percent within 5 %", "action", rows)


def by_joint_table(found: Sequence[Errors]) -> ResultTable:
    """Every network by joint, over the eight upright actions."""
    rows: dict[str, dict[str, Cell]] = {
        name: {network: by_joint(_of(found, network, "upright"), UPRIGHT_ACTIONS, joint) for network in NETWORKS}
        for joint, name in enumerate(coco.NAMES)
    }
    return table_of("by joint, eight upright actions, upright crops, percent within 5 %", "joint", rows)


def biases(thunder: Sequence[tuple[Lesson, dict[str, Looked]]], actions: Sequence[str]) -> dict[str, Bias]:
    """Over some actions; none named is all of them."""
    wanted = frozenset(actions or ACTIONS)
    return all_biases([each for lesson, looked in thunder for each in bias_looks(lesson, looked, wanted.__contains__)])


def bias_tables(thunder: Sequence[tuple[Lesson, dict[str, Looked]]], overall: dict[str, Bias]) -> list[ResultTable]:
    """The bias over all actions by axis, and its length by action."""
    rows: dict[str, dict[str, Cell]] = {
        joint: {
            **{f"{axis} mm": float(value) for axis, value in zip(AXES, bias.mm, strict=True)},
            "standard error mm": float(bias.sigma_mm.max()),
            "keypoints": float(bias.count),
        }
        for joint, bias in overall.items()
    }
    lengths: dict[str, dict[str, Cell]] = {joint: {} for joint in overall}
    for action in ACTIONS:
        for joint, bias in biases(thunder, [action]).items():
            front, outwards, up = bias.mm
            lengths[joint][action] = f"{front:+.0f} {outwards:+.0f} {up:+.0f}"
    return [
        table_of("landmark bias of Thunder in the axes of the joint's segment, all actions", "joint", rows),
        table_of("landmark bias of Thunder by action: front, outwards, up in mm", "joint", lengths),
    ]


def _of(found: Sequence[Errors], network: Name, turn: Turn, seed: int | None = None) -> list[Errors]:
    return [each for each in found if (each.network, each.turn) == (network, turn) and seed in {None, each.seed}]


if __name__ == "__main__":
    sys.exit(main())
