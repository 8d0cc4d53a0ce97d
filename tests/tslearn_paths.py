"""What tslearn makes of equation 19, as a program of its own: what it imports and compiles takes longer than all tests of ours.

In: an .npz file with the pairs `ours<n>` and `theirs<n>`, (T, D) each, and `radius<n>` of the band, -1 for none. Out: JSON, a list
of [path, cost]. Without a compiler its loops are short enough.
"""

import json
import os
import sys

os.environ["NUMBA_DISABLE_JIT"] = "1"

import numpy as np
from tslearn.metrics import dtw_path


def main(file: str) -> None:
    """Align every pair of the file."""
    found = []
    with np.load(file) as pairs:
        for number in range(len(pairs.files) // 3):
            radius = int(pairs[f"radius{number}"])
            band = {} if radius < 0 else {"global_constraint": "sakoe_chiba", "sakoe_chiba_radius": radius}
            path, distance = dtw_path(pairs[f"ours{number}"], pairs[f"theirs{number}"], **band)
            found.append([[[int(i), int(j)] for i, j in path], float(distance) ** 2])
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1])
