"""A tfjs graph of a few nodes with every trap of the real ones, small enough to compute by hand, and its manifest entry."""

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from models.networks.manifest import File, Input, Network, Output

Array = npt.NDArray[Any]


class ToyGraph:
    """Collects nodes and weights and writes them as the tfjs converter does."""

    def __init__(self) -> None:
        self.nodes: list[dict[str, Any]] = []
        self._specifications: list[dict[str, Any]] = []
        self._shard = b""

    def constant(self, name: str, value: Array, stored: str | None = None) -> str:
        """Add a weight; `stored` is "float16" if the shard keeps it so."""
        specification: dict[str, Any] = {"name": name, "shape": list(value.shape), "dtype": value.dtype.name}
        if stored:
            specification["quantization"] = {"dtype": stored, "original_dtype": value.dtype.name}
        self._specifications.append(specification)
        self._shard += value.astype(stored or value.dtype).tobytes()
        self.nodes.append({"name": name, "op": "Const"})
        return name

    def node(self, op: str, name: str, inputs: Sequence[str] = (), **attributes: Any) -> str:
        """Add an operation."""
        self.nodes.append(
            {"name": name, "op": op, "input": list(inputs), "attr": {key: _attribute(value) for key, value in attributes.items()}}
        )
        return name

    def files(self) -> tuple[bytes, bytes]:
        """The JSON file and the shard."""
        document = {
            "format": "graph-model",
            "modelTopology": {"node": self.nodes},
            "weightsManifest": [{"paths": ["toy.bin"], "weights": self._specifications}],
        }
        return json.dumps(document).encode(), self._shard


def _attribute(value: Any) -> Mapping[str, Any]:
    match value:
        case bool():
            return {"b": value}
        case int():
            return {"i": str(value)}
        case float():
            return {"f": value}
        case str():
            return {"s": base64.b64encode(value.encode()).decode()}
        case [str(), *_]:
            return {"list": {"s": [base64.b64encode(item.encode()).decode() for item in value]}}
        case _:
            return {"list": {"i": [str(item) for item in value]}}


CONVOLUTION = {"strides": [1, 2, 2, 1], "dilations": [1, 1, 1, 1], "padding": "SAME", "data_format": "NHWC"}


def toy_graph(seed: int = 7) -> ToyGraph:
    """Picture [1, 6, 6, 3] -> a strided convolution with an odd pixel of padding -> planes [1, 4, 3, 3]."""
    random = np.random.default_rng(seed)
    graph = ToyGraph()
    graph.node("Placeholder", "input_1")
    graph.constant("kernel", random.normal(size=(3, 3, 3, 4)).astype(np.float32), stored="float16")
    graph.constant("bias", random.normal(size=4).astype(np.float32))
    graph.node("_FusedConv2D", "head", ["input_1", "kernel", "bias"], fused_ops=["BiasAdd", "Relu6"], **CONVOLUTION)
    return graph


def toy_network(
    graph: ToyGraph, outputs: Sequence[Output] = (Output(name="planes", tensor="head", channels=4, height=3, width=3),)
) -> Network:
    """The manifest's entry of a toy graph."""
    files = [
        File(path=f"package/toy{suffix}", sha256=hashlib.sha256(content).hexdigest())
        for suffix, content in zip((".json", ".bin"), graph.files(), strict=True)
    ]
    picture = Input(
        tensor="input_1", layout="nhwc", height=6, width=6, channels="rgb", scale=(1.0, 0.5, 0.25), offset=(0.0, -1.0, 1.0)
    )
    return Network(
        source="toys",
        graph=files[0],
        shards=(files[1],),
        licence="Apache-2.0",
        origin="test",
        input=picture,
        outputs=tuple(outputs),
    )
