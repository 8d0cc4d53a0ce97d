"""An official SMPL file drops in: our body does what SMPL's equations say, in our axes."""

import io
import os
import pickle
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from models.arrays import Float
from models.body.build.smpl import convert, main, read
from models.body.file import decode
from models.body.pose import Pose
from models.errors import UserError
from models.skeleton import smpl
from tests.synthetic.toy_smpl import COEFFICIENTS, official_content

TO_OURS = np.array(((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)))


def smpl_by_its_equations(content: dict[str, Float], shape: Float, rotations: Float, translation: Float) -> tuple[Float, Float]:
    """Vertices and joints as Loper et al. 2015, eq. 2-10, have them: dense matrices, 4 x 4 transforms, SMPL's axes."""
    shaped = content["v_template"] + content["shapedirs"] @ shape
    joints = content["J_regressor"] @ shaped
    local = Rotation.from_rotvec(rotations).as_matrix()
    posed = shaped + content["posedirs"] @ (local[1:] - np.eye(3)).ravel()
    transforms = np.zeros((smpl.COUNT, 4, 4))
    for joint, parent in enumerate(smpl.PARENTS):
        own = np.eye(4)
        own[:3, :3] = local[joint]
        own[:3, 3] = joints[joint] - (joints[parent] if parent >= 0 else 0.0)
        transforms[joint] = own if parent < 0 else transforms[parent] @ own
    places = transforms[:, :3, 3].copy()
    transforms[:, :3, 3] -= np.einsum("jab,jb->ja", transforms[:, :3, :3], joints)
    blended = np.einsum("vj,jab->vab", content["weights"], transforms)
    vertices = np.einsum("vab,vb->va", blended[:, :3, :3], posed) + blended[:, :3, 3]
    return vertices + translation, places + translation


def test_a_converted_body_moves_as_smpls_equations_say() -> None:
    content = official_content()
    model = decode(convert(content, "toy.pkl"), "toy.npz")
    generator = np.random.default_rng(3)
    shape = generator.normal(size=COEFFICIENTS)
    rotations, translation = generator.normal(0, 0.7, (smpl.COUNT, 3)), generator.normal(size=3)
    vertices, joints = smpl_by_its_equations(content, shape, rotations, translation)
    pose = Pose(TO_OURS @ joints[0], rotations @ TO_OURS.T)
    body = model.shaped(shape)
    assert np.allclose(body.vertices_m(pose), vertices @ TO_OURS.T, atol=1e-5)
    assert np.allclose(body.joints_m(pose), joints @ TO_OURS.T, atol=1e-5)


def test_the_command_converts_a_pickle(tmp_path: Path) -> None:
    official, converted = tmp_path / "smpl.pkl", tmp_path / "smpl.npz"
    official.write_bytes(pickle.dumps(official_content(), protocol=2))
    _run(official, converted)
    model = decode(converted.read_bytes(), "smpl.npz")
    assert model.shape_count == COEFFICIENTS
    assert model.skin.posedirs.any()
    with pytest.raises(ValueError, match="no coco_regressor"):
        model.shaped(np.zeros(COEFFICIENTS)).coco_m(Pose(np.zeros(3), np.zeros((smpl.COUNT, 3))))


def _run(official: Path, converted: Path) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["smpl", str(official), str(converted)])
        assert main() == 0


class _Malicious:
    def __reduce__(self) -> tuple[object, tuple[str]]:
        return os.system, ("touch /tmp/kinebox-was-run",)


def test_a_pickle_that_wants_to_run_something_is_refused() -> None:
    with pytest.raises(UserError, match="does not belong in a body's file"):
        read(pickle.dumps({"v_template": _Malicious()}), "evil.pkl")


@pytest.mark.parametrize("key", ["v_template", "shapedirs", "posedirs", "weights", "J_regressor", "f", "kintree_table"])
def test_a_missing_key_is_named(key: str) -> None:
    content = official_content()
    del content[key]
    with pytest.raises(UserError, match=rf"smpl\.pkl: {key} is missing"):
        convert(content, "smpl.pkl")


def test_a_body_with_other_joints_is_refused() -> None:
    content = official_content()
    content["J_regressor"] = np.vstack((content["J_regressor"].toarray(), np.ones((28, 60)) / 60))
    with pytest.raises(UserError, match="J_regressor has the shape"):
        convert(content, "smplh.pkl")


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04 not a zip", b"text", pickle.dumps([1, 2])])
def test_what_is_no_smpl_file_is_refused(data: bytes) -> None:
    with pytest.raises(UserError, match="is no SMPL file"):
        read(data, "other.bin")


def test_the_newer_npz_is_read() -> None:
    content = official_content()
    out = io.BytesIO()
    np.savez(out, **{**content, "J_regressor": content["J_regressor"].toarray()})
    assert convert(read(out.getvalue(), "smpl.npz"), "smpl.npz") == convert(content, "smpl.npz")
