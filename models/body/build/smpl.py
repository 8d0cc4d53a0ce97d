"""Converts an official SMPL file to ours, so that a licensee can use it: axes turned, pelvis at the origin, nothing else.

    python -m models.body.build.smpl basicModel_neutral_lbs_10_207_0_v1.0.0.pkl body_smpl.npz

SMPL may not be shipped with KineBox: its licence is the user's own. The file is a pickle; only the kinds of object that belong
in it are built, whatever else it asks for is refused. chumpy, by which the oldest files were written, is not needed.
"""

import argparse
import io
import pickle
import sys
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import sparse

from models.body.build import archive
from models.body.file import FORMAT, POSE_FEATURES, VERSION, decode
from models.errors import USER_ERROR_CODE, UserError
from models.skeleton import smpl

_NEEDED = ("v_template", "shapedirs", "posedirs", "weights", "J_regressor", "f", "kintree_table")
_AXES = (2, 0, 1)
"""Our x, y and z are SMPL's z, x and y: to the front, to the left, up."""
_ALLOWED = {
    ("numpy", "ndarray"),
    ("numpy", "dtype"),
    ("numpy.core.multiarray", "_reconstruct"),
    ("numpy._core.multiarray", "_reconstruct"),
    ("numpy.core.multiarray", "scalar"),
    ("numpy._core.multiarray", "scalar"),
    ("numpy._core.numeric", "_frombuffer"),
    ("numpy.core.numeric", "_frombuffer"),
    ("_codecs", "encode"),
}
_SPARSE_MODULES = (
    "scipy.sparse.csc",
    "scipy.sparse._csc",
    "scipy.sparse.csr",
    "scipy.sparse._csr",
    "scipy.sparse.coo",
    "scipy.sparse._coo",
)
_SPARSE = {"csc_matrix": sparse.csc_matrix, "csr_matrix": sparse.csr_matrix, "coo_matrix": sparse.coo_matrix}

_UNREADABLE = (
    *(pickle.UnpicklingError, zipfile.BadZipFile, zlib.error, OSError),
    *(ValueError, EOFError, AttributeError, ImportError, IndexError, KeyError, TypeError),
)
"""What reading a file that is something else may raise."""


class _Chumpy:
    """Stands for a chumpy array: the numbers are in its state under "x"."""

    x: npt.NDArray[Any]

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.x = np.asarray(state["x"])


class _Unpickler(pickle.Unpickler):
    def find_class(self, module: str, name: str) -> Any:
        if (module, name) in _ALLOWED:
            return super().find_class(module, name)
        if module in _SPARSE_MODULES and name in _SPARSE:
            return _SPARSE[name]
        if module.partition(".")[0] == "chumpy" and name == "Ch":
            return _Chumpy
        raise pickle.UnpicklingError(f"{module}.{name} does not belong in a body's file")


def main() -> int:
    """Convert one file. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("official", type=Path, help="SMPL's .pkl or .npz")
    parser.add_argument("converted", type=Path, help="the .npz to write")
    arguments = parser.parse_args()
    try:
        data = convert(read(arguments.official.read_bytes(), arguments.official.name), arguments.official.name)
        arguments.converted.write_bytes(data)
    except (UserError, OSError) as error:
        sys.stderr.write(f"kinebox: {error}\n")
        return USER_ERROR_CODE
    return 0


def read(data: bytes, name: str) -> Mapping[str, Any]:
    """The content of SMPL's .pkl or .npz, without running what a pickle may carry.

    Raises:
        UserError: it is neither, or asks for objects that do not belong in it.
    """
    try:
        if data[:2] == b"PK":
            with np.load(io.BytesIO(data), allow_pickle=False) as content:
                return dict(content)
        content = _Unpickler(io.BytesIO(data), encoding="latin1").load()
    except _UNREADABLE as error:
        raise UserError(f"{name}: is no SMPL file ({error}); give the .pkl or .npz as downloaded") from error
    if not isinstance(content, dict):
        raise UserError(f"{name}: is no SMPL file (it holds a {type(content).__name__}); give the .pkl or .npz as downloaded")
    return content


def convert(official: Mapping[str, Any], name: str) -> bytes:
    """A file of ours with the same body.

    Joints come from `J_regressor`, pose correctives from `posedirs`. Our shape coefficients and rotation vectors are SMPL's, the
    vectors with their components in the order (z, x, y).

    Raises:
        UserError: a key is missing or wrong; the error names it.
    """
    for key in _NEEDED:
        if key not in official:
            raise UserError(f"{name}: {key} is missing; give SMPL's file with 24 joints, as downloaded")
    arrays = {key: _dense(official[key]) for key in _NEEDED}
    regressor = arrays["J_regressor"]
    if arrays["v_template"].ndim != 2 or regressor.shape != (smpl.COUNT, len(arrays["v_template"])):
        raise UserError(f"{name}: J_regressor has the shape {regressor.shape}, needed (24, vertices); is it SMPL-H or SMPL-X?")
    if arrays["posedirs"].shape != (*arrays["v_template"].shape, POSE_FEATURES):
        raise UserError(f"{name}: posedirs has the shape {arrays['posedirs'].shape}, needed (vertices, 3, {POSE_FEATURES})")
    template = arrays["v_template"][:, _AXES]
    shapedirs = arrays["shapedirs"][:, _AXES]
    joints, joint_shapedirs = regressor @ template, np.tensordot(regressor, shapedirs, axes=1)
    data = archive.encode(
        {
            "format": np.array(FORMAT),
            "version": np.array(VERSION),
            "source": np.array(f"Converted from {name}; SMPL, Max Planck Society, under the licence of whoever converted it"),
            "v_template": (template - joints[0]).astype(np.float32),
            "shapedirs": (shapedirs - joint_shapedirs[0]).astype(np.float32),
            "posedirs": _turned(arrays["posedirs"]).astype(np.float32),
            "weights": arrays["weights"].astype(np.float32),
            "f": arrays["f"].astype(np.uint32),
            "kintree_table": arrays["kintree_table"].astype(np.int64).astype(np.uint32),
            "J_template": (joints - joints[0]).astype(np.float32),
            "J_shapedirs": (joint_shapedirs - joint_shapedirs[0]).astype(np.float32),
            "J_regressor": regressor.astype(np.float32),
        }
    )
    decode(data, name)
    return data


def _dense(value: Any) -> npt.NDArray[Any]:
    if isinstance(value, _Chumpy):
        return value.x
    return np.asarray(value.toarray() if sparse.issparse(value) else value)


def _turned(posedirs: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The same correctives for rotations written in our axes: entry (r, c) of ours is entry (axes[r], axes[c]) of SMPL's."""
    features = posedirs[:, _AXES].reshape(len(posedirs), 3, smpl.COUNT - 1, 3, 3)
    return features[:, :, :, _AXES][..., _AXES].reshape(posedirs.shape)


if __name__ == "__main__":
    sys.exit(main())
