"""Exports the cycle of a run to a table of harmonics.

    python -m models.motions.build.export

writes `models/motions/actions/run_cycle.py`; with `--check` it compares with what is there. See README.md.
"""

import argparse
import ast
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np

import models.motions.actions
from models.arrays import Float
from models.motions.build import humanoid
from models.skeleton import smpl

TABLE = Path(models.motions.actions.__file__).parent / "run_cycle.py"
HARMONICS = 4
_JOINTS = ("pelvis", "spine1", "left_hip", "left_knee", "left_ankle", "left_shoulder", "left_elbow")
_SAME_RAD = 2e-4
_HEAD = '''"""How a runner's joints turn over two steps; written by `models.motions.build.export`, not by hand.

From humanoid3d_run.txt of PyPI's pybullet 3.2.7 (zlib licence, see NOTICE); altered: retargeted, mirrored, smoothed.
"""

from typing import Final

# fmt: off
HARMONICS: Final[dict[str, tuple[tuple[float, ...], ...]]] = {
'''
_TAIL = '''}
# fmt: on
"""By joint and component of its rotation vector (radians): mean, then cosine and sine of each harmonic of the cycle's phase.

The right side does the same half a cycle later, mirrored; so do pelvis and spine themselves. spine2 and spine3 turn as spine1 does.
"""
'''


def main() -> int:
    """Write or check the table. Returns the exit code."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="compare with the table that is there and write nothing")
    check = arguments.parse_args().check
    text = (files("pybullet_data") / "data/motions/humanoid3d_run.txt").read_text()
    recording = humanoid.read(text)
    table = harmonics(recording.rotations_rad[:-1])
    if check:
        return _compare(table)
    TABLE.write_text(_source(table))
    sys.stdout.write(f"written: {TABLE.name}\n")
    return 0


def harmonics(cycle: Float) -> dict[str, Float]:
    """(3, 1 + 2 HARMONICS) of each joint of `_JOINTS`, from one (T, 24, 3) cycle with T even."""
    mirrored = np.roll(cycle, len(cycle) // 2, axis=0)[:, list(smpl.MIRROR)] * (-1.0, 1.0, -1.0)
    spectrum = np.fft.rfft((cycle + mirrored) / 2, axis=0)[: HARMONICS + 1] / len(cycle)
    spectrum[1:] *= 2
    table = {}
    for joint in _JOINTS:
        of_joint = spectrum[:, smpl.INDEX[joint]]
        waves = np.stack((of_joint[1:].real, -of_joint[1:].imag), axis=1).reshape(2 * HARMONICS, 3)
        table[joint] = np.vstack((of_joint[:1].real, waves)).T
    return table


def _source(table: dict[str, Float]) -> str:
    lines = []
    for joint, rows in table.items():
        lines.append(f'    "{joint}": (')
        lines += [f"        ({', '.join(f'{number + 0.0:.4f}' for number in np.round(row, 4))})," for row in rows]
        lines.append("    ),")
    return _HEAD + "\n".join(lines) + "\n" + _TAIL


def _compare(table: dict[str, Float]) -> int:
    for node in ast.parse(TABLE.read_text()).body:
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.target.id == "HARMONICS" and node.value:
            there = ast.literal_eval(node.value)
            same = there.keys() == table.keys() and all(np.abs(np.array(there[j]) - table[j]).max() < _SAME_RAD for j in table)
            sys.stdout.write(f"{TABLE.name}: {'as exported' if same else 'differs from a fresh export'}\n")
            return 0 if same else 1
    sys.stdout.write(f"{TABLE.name}: holds no table\n")
    return 1


if __name__ == "__main__":
    sys.exit(main())
