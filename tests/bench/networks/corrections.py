"""Writes the landmark bias into the code that fusion may take it from."""

from pathlib import Path
from typing import Final

import numpy as np

from models.skeleton import coco
from tests.bench.networks.landmarks import Bias, as_points

PATH: Final = Path(__file__).parents[3] / "services/fusion/landmark_bias.py"
_HEAD: Final = '''"""Where a pose network's points lie on the body, against the body's own COCO points: the landmark bias.

Written by `python -m tests.bench.networks --data build --corrections`, from PUPILS simulated development pupils who perform every
action; do not edit by hand. Of each COCO point: front, left and up in the axes of its segment
(`models.skeleton.segment_axes`), over the length of the trunk. Fusion takes it off if `FusionConfig.landmark_bias` says so.
"""

from typing import Final

THUNDER: Final = (
'''


def source_of(biases: dict[str, Bias], pupils: int) -> str:
    """The module's text."""
    rows = np.round(as_points(biases), 4) + 0.0
    lines = [f"    ({row[0]}, {row[1]}, {row[2]}),  # {name}\n" for name, row in zip(coco.NAMES, rows.tolist(), strict=True)]
    return f"{_HEAD.replace('PUPILS', str(pupils))}{''.join(lines)})\n"


def write_corrections(biases: dict[str, Bias], pupils: int) -> str:
    """Write the module; what was written."""
    text = source_of(biases, pupils)
    PATH.write_text(text)
    return text
