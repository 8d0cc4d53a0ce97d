"""Reads a TensorFlow.js graph model: a JSON graph of nodes and the weights in binary shards.

Source: the tfjs converter's format ("graph-model"), https://github.com/tensorflow/tfjs/tree/master/tfjs-converter.
"""

import base64
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from models.errors import UserError

Array = npt.NDArray[Any]
Attribute = int | float | bool | str | list[int] | list[str]


@dataclass(frozen=True)
class Node:
    """One operation. `inputs` are names of nodes, ":n" appended for another than a node's first output."""

    op: str
    name: str
    inputs: tuple[str, ...]
    attributes: Mapping[str, Attribute]


@dataclass(frozen=True)
class Graph:
    """The nodes that compute, in an order in which each follows its inputs, and the constants by name."""

    nodes: tuple[Node, ...]
    constants: Mapping[str, Array]


def read_graph(label: str, graph_json: bytes, shards: Sequence[bytes]) -> Graph:
    """Decode a model from the bytes of its JSON file and of its shards, in the manifest's order.

    Raises:
        UserError: no graph model, or shards whose length is not what the graph says.
    """
    try:
        document = json.loads(graph_json)
        if document["format"] != "graph-model":
            raise UserError(f"{label}: the file is a '{document['format']}', not a graph-model of TensorFlow.js")
        specifications = [weight for group in document["weightsManifest"] for weight in group["weights"]]
        raw_nodes = document["modelTopology"]["node"]
        nodes = tuple(_node(raw) for raw in raw_nodes if raw["op"] != "Const")
    except (json.JSONDecodeError, KeyError, TypeError, ValueError) as error:
        raise UserError(f"{label}: the file is not a graph model of TensorFlow.js ({error!r}); pin another one") from error
    return Graph(nodes, _weights(label, specifications, b"".join(shards)))


def _node(raw: Mapping[str, Any]) -> Node:
    inputs = tuple(name for name in raw.get("input", ()) if not name.startswith("^"))  # ^ marks an order, not a value
    attributes = {key: value for key, raw_value in raw.get("attr", {}).items() if (value := _attribute(raw_value)) is not None}
    return Node(raw["op"], raw["name"], inputs, attributes)


def _attribute(raw: Mapping[str, Any]) -> Attribute | None:
    """A value of the kinds that matter here; None for types and shapes."""
    ((kind, value),) = raw.items()
    if kind == "list":
        return [_text(item) for item in value["s"]] if "s" in value else [int(item) for item in value.get("i", ())]
    decode = _DECODERS.get(kind)
    return decode(value) if decode else None


def _text(encoded: str) -> str:
    return base64.b64decode(encoded).decode()


_DECODERS: Mapping[str, Callable[[Any], Attribute]] = {"i": int, "f": float, "b": bool, "s": _text}


def _weights(label: str, specifications: Sequence[Mapping[str, Any]], buffer: bytes) -> dict[str, Array]:
    weights: dict[str, Array] = {}
    position = 0
    for specification in specifications:
        name, shape = specification["name"], tuple(specification["shape"])
        stored = _stored_type(label, specification)
        count = math.prod(shape)
        end = position + count * stored.itemsize
        if end > len(buffer):
            raise UserError(f"{label}: the weights end within '{name}' ({len(buffer)} bytes); the file is truncated")
        value = np.frombuffer(buffer, stored, count, position).reshape(shape)
        weights[name] = value.astype(specification["dtype"])
        position = end
    if position != len(buffer):
        raise UserError(f"{label}: {len(buffer) - position} bytes of weights belong to no tensor; the files do not fit together")
    return weights


def _stored_type(label: str, specification: Mapping[str, Any]) -> np.dtype[Any]:
    """Type in the shard: weights may be stored as float16 and meant as float32."""
    quantised = specification.get("quantization", {}).get("dtype")
    if quantised not in (None, "float16"):
        raise UserError(f"{label}: '{specification['name']}' is stored as {quantised}, which this converter does not read")
    stored: np.dtype[Any] = np.dtype(quantised or specification["dtype"])
    return stored.newbyteorder("<")
