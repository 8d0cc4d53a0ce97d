"""Reads a body's file: an .npz with SMPL's keys and ours. Pure: bytes in; nothing is unpickled.

| Key | Shape | What |
|---|---|---|
| `format`, `version`, `source` | | "kinebox-body", 1, where it comes from and under which licence |
| `v_template` | (V, 3) | mean body in the T-pose, metres, in the frame of `models.body`, pelvis at the origin |
| `shapedirs` | (V, 3, S) | its change by each shape coefficient |
| `posedirs` | (V, 3, 207) | its change by the pose features; all zero for a body without |
| `weights` | (V, 24) | skinning weights; rows sum to 1 |
| `f` | (F, 3) | triangles of a closed surface, counter-clockwise from outside |
| `kintree_table` | (2, 24) | parents and joints, as SMPL's |
| `J_template`, `J_shapedirs` | (24, 3), (24, 3, S) | joints of the mean body and their change by the shape |
| `J_regressor` | (24, V) | the same joints as sums of vertices, for readers that know SMPL's keys only |
| `coco_regressor` | (23, V) | COCO points and points of the feet as sums of vertices; may be missing |
| `part_names`, `v_part` | (P,), (V,) | parts of the body; may be missing |
| `prior_ages`, `prior_mean`, `prior_cov` | (A,), (2, A, S), (2, A, S, S) | shape prior; may be missing |
"""

import io
import zipfile
import zlib
from typing import Any

import numpy as np
import numpy.typing as npt

from models.arrays import Float
from models.body.landmarks import Skin, from_vertices
from models.body.model import BodyModel
from models.body.prior import SEXES, ShapePrior
from models.errors import UserError
from models.skeleton import coco_feet, smpl

FORMAT = "kinebox-body"
VERSION = 1
POSE_FEATURES = 9 * (smpl.COUNT - 1)
ROOT_PARENT = 2**32 - 1
"""What SMPL's kintree_table has for the parent of the pelvis, -1 as an unsigned number."""

_REQUIRED = (
    "source", "v_template", "shapedirs", "posedirs", "weights", "f", "kintree_table", "J_template", "J_shapedirs", "J_regressor",
)  # fmt: skip
_PRIOR = ("prior_ages", "prior_mean", "prior_cov")
_PARTS = ("part_names", "v_part")
_OPTIONAL = ("coco_regressor", *_PARTS, *_PRIOR)
_SUM_TOLERANCE = 2e-3
_JOINT_TOLERANCE_M = 1e-3
_ORIGIN_TOLERANCE_M = 1e-5

Array = npt.NDArray[Any]


def decode(data: bytes, name: str) -> BodyModel:
    """Read a body's file.

    Args:
        data: content of the .npz.
        name: how errors call the file.

    Raises:
        UserError: no such file, another version, or a key that is missing, unknown or wrong; the error names the key.
    """
    arrays = _arrays(data, name)
    reader = _Reader(arrays, name)
    reader.check_version()
    template = reader.floats("v_template", (None, 3))
    vertices = len(template)
    shapedirs = reader.floats("shapedirs", (vertices, 3, None))
    coefficients = shapedirs.shape[2]
    posedirs = reader.posedirs(vertices)
    joints = reader.floats("J_template", (smpl.COUNT, 3))
    joint_shapedirs = reader.floats("J_shapedirs", (smpl.COUNT, 3, coefficients))
    if max(np.abs(joints[0]).max(), np.abs(joint_shapedirs[0]).max()) > _ORIGIN_TOLERANCE_M:
        reader.refuse("J_template", "must have the pelvis at the origin in every shape; export or convert the file again")
    joints[0], joint_shapedirs[0] = 0.0, 0.0
    reader.check_tree()
    reader.check_joint_regressor(template, joints)
    skin = Skin(template, shapedirs, posedirs, *_largest(reader.rows_that_sum_to_one("weights", (vertices, smpl.COUNT))))
    landmarks = None
    if "coco_regressor" in arrays:
        regressor = reader.rows_that_sum_to_one("coco_regressor", (coco_feet.COUNT, vertices))
        landmarks = from_vertices(regressor, skin, joints, joint_shapedirs)
    part_names, vertex_parts = reader.parts(vertices)
    return BodyModel(
        source=str(reader.scalar("source")),
        skin=skin,
        faces=reader.indices("f", (None, 3), vertices),
        joints=joints,
        joint_shapedirs=joint_shapedirs,
        landmarks=landmarks,
        part_names=part_names,
        vertex_parts=vertex_parts,
        prior=reader.prior(template, shapedirs),
    )


def coco_regressor(data: bytes, name: str) -> Float:
    """(23, V) the regressor by which `decode` makes the landmarks, for bodies that are altered from the file's.

    Raises:
        UserError: as `decode`; also a file without this key.
    """
    reader = _Reader(arrays := _arrays(data, name), name)
    reader.check_version()
    if "coco_regressor" not in arrays:
        reader.refuse("coco_regressor", "is missing, which an altered body needs; use the body that KineBox ships")
    vertices = len(reader.floats("v_template", (None, 3)))
    return np.asarray(reader.rows_that_sum_to_one("coco_regressor", (coco_feet.COUNT, vertices)))


def _arrays(data: bytes, name: str) -> dict[str, Array]:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return {key: archive[key] for key in archive}
    except (ValueError, EOFError, KeyError, TypeError, AttributeError, OSError, zipfile.BadZipFile, zlib.error) as error:
        raise UserError(f"{name}: is no body's file, or is damaged; export or convert it again") from error


def _largest(weights: Float) -> tuple[npt.NDArray[np.int64], Float]:
    """Joints and weights of each vertex, as many columns as the vertex with most joints needs."""
    columns = int((weights > 0).sum(1).max())
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :columns]
    return joints, np.take_along_axis(weights, joints, axis=1)


class _Reader:
    """Checks one key after the other; every refusal names the file and the key."""

    def __init__(self, arrays: dict[str, Array], name: str) -> None:
        self._arrays = arrays
        self._name = name

    def refuse(self, key: str, what: str) -> None:
        raise UserError(f"{self._name}: {key} {what}")

    def check_version(self) -> None:
        if "format" not in self._arrays or "version" not in self._arrays or self.scalar("format") != FORMAT:
            raise UserError(
                f"{self._name}: is not a body's file of KineBox (format '{FORMAT}'); "
                "convert an official SMPL file with models.body.build.smpl"
            )
        if self.scalar("version") != VERSION:
            self.refuse("version", f"is {self.scalar('version')}, this KineBox reads {VERSION}; export the file again")
        for key in _REQUIRED:
            if key not in self._arrays:
                self.refuse(key, "is missing; export or convert the file again")
        for key in self._arrays:
            if key not in {"format", "version", *_REQUIRED, *_OPTIONAL}:
                self.refuse(key, "is unknown; remove it")
        for group in (_PARTS, _PRIOR):
            there = [key for key in group if key in self._arrays]
            if there and len(there) < len(group):
                self.refuse(next(key for key in group if key not in there), f"is missing beside {there[0]}")

    def scalar(self, key: str) -> str | int:
        value = self._arrays[key]
        if value.shape != () or value.dtype.kind not in "Uiu":
            self.refuse(key, "must be one text or one whole number")
        return str(value) if value.dtype.kind == "U" else int(value)

    def array(self, key: str, shape: tuple[int | None, ...]) -> Array:
        value = self._arrays[key]
        if len(value.shape) != len(shape) or any(
            wanted not in {None, there} for wanted, there in zip(shape, value.shape, strict=True)
        ):
            wanted = "(" + ", ".join("any" if size is None else str(size) for size in shape) + ")"
            self.refuse(key, f"has the shape {value.shape}, needed {wanted}")
        if value.size == 0:
            self.refuse(key, "is empty")
        return value

    def floats(self, key: str, shape: tuple[int | None, ...]) -> Float:
        value = self.array(key, shape)
        if value.dtype.kind != "f":
            self.refuse(key, f"holds {value.dtype}, needed are floating-point numbers")
        if not np.isfinite(value).all():
            self.refuse(key, "holds numbers that are not finite")
        return np.array(value, np.float64)

    def posedirs(self, vertices: int) -> Float:
        """(V, 3, 207), or (V, 3, 0) if all are zero, which costs nothing at run time."""
        shape = (vertices, 3, POSE_FEATURES)
        return self.floats("posedirs", shape) if self.array("posedirs", shape).any() else np.zeros((vertices, 3, 0))

    def indices(self, key: str, shape: tuple[int | None, ...], below: int) -> npt.NDArray[np.int64]:
        value = self.array(key, shape)
        if value.dtype.kind not in "iu" or value.min() < 0 or value.max() >= below:
            self.refuse(key, f"must hold whole numbers from 0 to {below - 1}")
        return value.astype(np.int64)

    def rows_that_sum_to_one(self, key: str, shape: tuple[int, int]) -> Float:
        value = self.floats(key, shape)
        sums = value.sum(1)
        worst = int(np.argmax(np.abs(sums - 1)))
        if abs(sums[worst] - 1) > _SUM_TOLERANCE:
            self.refuse(key, f"has a row (number {worst}) that sums to {sums[worst]:.4f}, needed 1")
        if key == "weights" and value.min() < 0:
            self.refuse(key, "holds negative weights")
        return np.asarray(value / sums[:, None])

    def check_tree(self) -> None:
        tree = self.array("kintree_table", (2, smpl.COUNT)).astype(np.int64)
        parents = np.where(tree[0] == ROOT_PARENT, -1, tree[0])
        if not np.array_equal(parents, smpl.PARENTS) or not np.array_equal(tree[1], np.arange(smpl.COUNT)):
            self.refuse("kintree_table", "is not SMPL's tree of 24 joints")

    def check_joint_regressor(self, template: Float, joints: Float) -> None:
        regressor = self.floats("J_regressor", (smpl.COUNT, len(template)))
        error = float(np.abs(regressor @ template - joints).max())
        if error > _JOINT_TOLERANCE_M:
            self.refuse("J_regressor", f"puts a joint {1000 * error:.1f} mm from where J_template has it")

    def parts(self, vertices: int) -> tuple[tuple[str, ...], npt.NDArray[np.int64]]:
        if "v_part" not in self._arrays:
            return ("body",), np.zeros(vertices, np.int64)
        names = self.array("part_names", (None,))
        if names.dtype.kind != "U":
            self.refuse("part_names", "must hold texts")
        return tuple(str(part) for part in names), self.indices("v_part", (vertices,), len(names))

    def prior(self, template: Float, shapedirs: Float) -> ShapePrior | None:
        if "prior_mean" not in self._arrays:
            return None
        coefficients = shapedirs.shape[2]
        ages = self.floats("prior_ages", (None,))
        if len(ages) < 2 or (np.diff(ages) <= 0).any():
            self.refuse("prior_ages", "must hold two ages or more, ascending")
        means = self.floats("prior_mean", (len(SEXES), len(ages), coefficients))
        covariances = self.floats("prior_cov", (len(SEXES), len(ages), coefficients, coefficients))
        covariances = (covariances + covariances.swapaxes(-1, -2)) / 2
        if np.linalg.eigvalsh(covariances).min() <= 0:
            self.refuse("prior_cov", "holds a matrix that is not positive definite")
        crown, sole = int(np.argmax(template[:, 2])), int(np.argmin(template[:, 2]))
        return ShapePrior(
            ages_years=ages,
            means=means,
            covariances=covariances,
            stature_direction=shapedirs[crown, 2] - shapedirs[sole, 2],
            stature_of_mean_m=float(template[crown, 2] - template[sole, 2]),
        )
