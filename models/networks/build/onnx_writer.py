"""Collects ONNX nodes and weights whose tensors remember how their axes are stored.

TensorFlow keeps channels last, ONNX's convolutions want them first. A `Tensor` therefore carries two things: its shape in the
axes of the original graph, and in which order those axes are stored. A transpose of the original graph changes the bookkeeping
alone; one is written only where an operation needs another order.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import onnx
from onnx import helper, numpy_helper

from models.networks.build.tfjs_graph import Array

OPSET = 17
IR_VERSION = 8
PLANES = (0, 3, 1, 2)
"""Stored order of a tensor [batch, rows, columns, channels] that ONNX's convolutions take."""


@dataclass(frozen=True)
class Tensor:
    """A value of the graph that is being written.

    Attributes:
        name: its name in ONNX.
        shape: its sizes along the axes of the original graph; None is the batch.
        order: which axis of the original graph is stored first, second, ...
    """

    name: str
    shape: tuple[int | None, ...]
    order: tuple[int, ...]

    def stored(self, per_axis: Sequence[Any]) -> list[Any]:
        """Rearrange something given for each axis of the original graph to the stored order."""
        return [per_axis[axis] for axis in self.order]

    def transposed(self, permutation: Sequence[int]) -> "Tensor":
        """The same stored data seen through a transpose of the original graph, whose axis j was axis `permutation[j]`."""
        return replace(
            self,
            shape=tuple(self.shape[axis] for axis in permutation),
            order=tuple(permutation.index(axis) for axis in self.order),
        )


class OnnxWriter:
    """Nodes, weights, inputs and outputs of one ONNX graph, in the order in which they were added."""

    def __init__(self) -> None:
        self._nodes: list[onnx.NodeProto] = []
        self._weights: dict[str, onnx.TensorProto] = {}
        self._inputs: list[onnx.ValueInfoProto] = []
        self._outputs: list[onnx.ValueInfoProto] = []

    def input(self, name: str, element: int, shape: Sequence[int | str]) -> str:
        """Declare an input of the graph."""
        self._inputs.append(helper.make_tensor_value_info(name, element, shape))
        return name

    def output(self, name: str, source: str, shape: Sequence[int | str]) -> None:
        """Give the tensor `source` out under `name`, as float32."""
        self._nodes.append(helper.make_node("Identity", [source], [name], name))
        self._outputs.append(helper.make_tensor_value_info(name, onnx.TensorProto.FLOAT, shape))

    def weight(self, name: str, value: Array) -> str:
        """Store a constant once and return its name; ValueError if another value has that name already."""
        stored = numpy_helper.from_array(np.ascontiguousarray(value), name)
        if self._weights.setdefault(name, stored) != stored:
            raise ValueError(f"two values for the constant '{name}'")
        return name

    def add(self, op: str, name: str, inputs: Sequence[str], **attributes: Any) -> str:
        """Append an operation with one output, which has the operation's name, and return that."""
        self._nodes.append(helper.make_node(op, list(inputs), [name], name, **attributes))
        return name

    def in_order(self, tensor: Tensor, order: tuple[int, ...]) -> Tensor:
        """The tensor stored in `order`; writes a transpose if it is not."""
        if tensor.order == order:
            return tensor
        name = f"{tensor.name}/stored_{''.join(map(str, order))}"
        if all(node.name != name for node in self._nodes):
            self.add("Transpose", name, [tensor.name], perm=[tensor.order.index(axis) for axis in order])
        return replace(tensor, name=name, order=order)

    def model(self, name: str, producer_version: str) -> onnx.ModelProto:
        """The finished model, checked.

        Raises:
            onnx.checker.ValidationError: what was added is no valid graph; a defect of the converter.
        """
        graph = helper.make_graph(self._nodes, name, self._inputs, self._outputs, list(self._weights.values()))
        model = helper.make_model(
            graph,
            opset_imports=[helper.make_opsetid("", OPSET)],
            ir_version=IR_VERSION,
            producer_name="kinebox",
            producer_version=producer_version,
        )
        onnx.checker.check_model(model, full_check=True)
        return model
