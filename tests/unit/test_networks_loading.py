"""A network that is missing, cut off or altered is one clear line before anything runs."""

import hashlib
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from edge.perception.networks import load_network
from models.errors import UserError
from models.networks.build.tfjs_graph import read_graph
from models.networks.build.tfjs_to_onnx import convert
from models.networks.installed import INSTALLED_VERSION, Installed, InstalledNetwork, encode_installed
from tests.toy_network import toy_graph, toy_network


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """A data folder with one small network, "toy"."""
    graph = toy_graph()
    document, shard = graph.files()
    model = convert("toy", toy_network(graph), read_graph("toy", document, [shard])).SerializeToString()
    folder = tmp_path / "networks"
    folder.mkdir()
    (folder / "toy.onnx").write_bytes(model)
    entry = InstalledNetwork("toy.onnx", hashlib.sha256(model).hexdigest(), "", {})
    (folder / "installed.json").write_bytes(encode_installed(Installed(INSTALLED_VERSION, {"toy": entry})))
    return tmp_path


def test_a_network_runs_on_any_number_of_pictures(data: Path) -> None:
    network = load_network("toy", data)
    pictures = np.random.default_rng(1).integers(0, 256, (3, *network.size_px, 3), dtype=np.uint8)
    together = network(pictures)["planes"]
    assert together.shape == (3, 4, 3, 3)
    for index in range(3):
        np.testing.assert_allclose(network(pictures[index : index + 1])["planes"][0], together[index], atol=1e-5)


def test_no_networks_at_all(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"network movenet-thunder: there are no networks in .*; run `make networks DATA="):
        load_network("movenet-thunder", tmp_path)


def test_a_network_that_is_not_listed(data: Path) -> None:
    with pytest.raises(UserError, match=r"network nanodet: .*run `make networks DATA="):
        load_network("nanodet", data)


def test_a_network_whose_file_is_gone(data: Path) -> None:
    (data / "networks" / "toy.onnx").unlink()
    with pytest.raises(
        UserError, match=r"network toy: .*toy\.onnx is missing; delete .*installed\.json and run `make networks DATA="
    ):
        load_network("toy", data)


@pytest.mark.parametrize("name", ["toy.onnx", "installed.json"])
def test_a_file_that_cannot_be_read_is_one_line_too(data: Path, name: str) -> None:
    (data / "networks" / name).unlink()
    (data / "networks" / name).mkdir()
    with pytest.raises(UserError, match=rf"network toy: .*{name} cannot be read \(Is a directory\); delete .*installed\.json"):
        load_network("toy", data)


@pytest.mark.parametrize("damage", ["truncated", "empty", "altered"])
def test_a_damaged_network_is_never_opened(data: Path, damage: str) -> None:
    path = data / "networks" / "toy.onnx"
    model = path.read_bytes()
    path.write_bytes({"truncated": model[: len(model) // 2], "empty": b"", "altered": b"x" + model[1:]}[damage])
    with pytest.raises(UserError, match=r"network toy: .*toy\.onnx is damaged .*run `make networks DATA="):
        load_network("toy", data)


def test_a_damaged_list_says_what_to_do(data: Path) -> None:
    (data / "networks" / "installed.json").write_text("{")
    with pytest.raises(
        UserError, match=r"installed\.json cannot be read .*; delete .*/installed\.json and run `make networks DATA="
    ):
        load_network("toy", data)


def test_openvino_that_is_not_installed_is_one_line(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openvino", cast(ModuleType, None))
    with pytest.raises(UserError, match=r"inference\.provider = \"openvino\".*install it with"):
        load_network("toy", data, "openvino")


def test_openvino_gets_one_unpinned_thread_in_float32_and_no_telemetry(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    class Core:
        def read_model(self, model: bytes) -> Any:
            asked.append(hashlib.sha256(model).hexdigest())
            size = [SimpleNamespace(get_length=lambda side=side: side) for side in (1, 6, 6, 3)]
            outputs = [SimpleNamespace(get_any_name=lambda: "planes")]
            return SimpleNamespace(input=lambda _: SimpleNamespace(partial_shape=size), reshape=asked.append, outputs=outputs)

        def compile_model(self, _: Any, device: str, settings: dict[str, Any]) -> Any:
            asked.append((device, settings))
            request = SimpleNamespace(infer=lambda pictures: {0: pictures[0].sum(axis=(1, 2))})
            return SimpleNamespace(create_infer_request=lambda: request)

    fake = ModuleType("openvino")
    fake.Core = Core  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "openvino", fake)
    monkeypatch.delitem(sys.modules, "openvino_telemetry", raising=False)
    network = load_network("toy", data, "openvino")
    assert sys.modules["openvino_telemetry"] is None, "its import must fail"
    assert asked[1] == [1, 6, 6, 3]
    device, settings = asked[2]
    assert device == "CPU"
    assert settings["INFERENCE_NUM_THREADS"] == 1
    assert settings["ENABLE_CPU_PINNING"] is False
    assert settings["INFERENCE_PRECISION_HINT"] == "f32"
    pictures = np.ones((2, 6, 6, 3), np.uint8)
    assert network.size_px == (6, 6)
    np.testing.assert_array_equal(network(pictures)["planes"], np.full((2, 3), 36))


def test_openvino_computes_what_onnxruntime_does(data: Path) -> None:
    pytest.importorskip("openvino", reason="the optional provider OpenVINO is not installed", exc_type=ImportError)
    pictures = np.random.default_rng(1).integers(0, 256, (2, 6, 6, 3), dtype=np.uint8)
    expected = load_network("toy", data)(pictures)["planes"]
    np.testing.assert_allclose(load_network("toy", data, "openvino")(pictures)["planes"], expected, atol=1e-3)
