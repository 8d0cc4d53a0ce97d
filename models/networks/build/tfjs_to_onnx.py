"""Converts a TensorFlow.js graph model to ONNX, with numpy and onnx alone.

Only what the manifest asks for is converted: the nodes between the tensor that stands for the normalised picture and the output
tensors. The batch becomes free, transposes are folded (see `onnx_writer`), and the picture's normalisation is put in front, so
that the converted network takes the bytes of a picture.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import onnx

from models.errors import UserError
from models.networks.build.onnx_writer import PLANES, OnnxWriter, Tensor
from models.networks.build.tfjs_graph import Array, Graph, Node
from models.networks.manifest import Input, Network

CONVERTER_VERSION = "1"
INPUT = "pictures"
"""Name of every converted network's input: uint8 [batch, height, width, 3] RGB."""


def convert(name: str, network: Network, graph: Graph) -> onnx.ModelProto:
    """Convert one network of the manifest.

    Raises:
        UserError: the graph has an operation, or an option of one, that is not known here (the node is named), it lacks a tensor
            that the manifest names, or a tensor has another shape than the manifest says.
    """
    conversion = _Conversion(name, graph)
    conversion.begin(network.input)
    conversion.run([output.tensor for output in network.outputs])
    for output in network.outputs:
        conversion.give(output.name, output.tensor, (output.channels, output.height, output.width))
    return conversion.writer.model(name, CONVERTER_VERSION)


class _Conversion:
    """State of one conversion: the tensors known so far, by their names in the original graph."""

    def __init__(self, label: str, graph: Graph) -> None:
        self._label = label
        self._graph = graph
        self._nodes = {node.name: node for node in graph.nodes}
        self._tensors: dict[str, Tensor] = {}
        self.writer = OnnxWriter()

    def begin(self, picture: Input) -> None:
        """Write the normalisation and let its result stand for the manifest's input tensor."""
        if picture.tensor not in self._nodes:
            raise UserError(f"{self._label}: the graph has no tensor '{picture.tensor}'; correct `input` in the manifest")
        writer, size = self.writer, (picture.height, picture.width)
        name = writer.input(INPUT, onnx.TensorProto.UINT8, ["batch", *size, 3])
        name = writer.add("Transpose", "picture/planes", [name], perm=list(PLANES))
        if picture.channels == "bgr":  # after the transpose, where it copies planes: before it, it would cost 3 ms
            name = writer.add("Gather", "picture/bgr", [name, writer.weight("picture/channels", np.array([2, 1, 0]))], axis=1)
        name = writer.add("Cast", "picture/float", [name], to=onnx.TensorProto.FLOAT)
        for op, key, values in (("Mul", "scale", picture.scale), ("Add", "offset", picture.offset)):
            weight = writer.weight(f"picture/{key}", np.array(values, np.float32).reshape(1, 3, 1, 1))
            name = writer.add(op, f"picture/{key}d", [name, weight])
        if picture.layout == "nhwc":
            self._tensors[picture.tensor] = Tensor(name, (None, *size, 3), PLANES)
        else:
            self._tensors[picture.tensor] = Tensor(name, (None, 3, *size), (0, 1, 2, 3))

    def run(self, outputs: Sequence[str]) -> None:
        """Convert every node that the outputs need, in the graph's order."""
        needed = self._needed(outputs)
        for node in self._graph.nodes:
            if node.name in needed:
                handler = _HANDLERS.get(node.op)
                if handler is None:
                    raise self._refuse(node, "its operation is not known")
                self._tensors[node.name] = handler(self, node)

    def give(self, name: str, tensor: str, planes: tuple[int, int, int]) -> None:
        """Declare an output, as planes."""
        value = self.writer.in_order(self._tensors[tensor], PLANES)
        found = value.stored(value.shape)[1:]
        if found != list(planes):
            raise UserError(f"{self._label}: '{tensor}' has the planes {found}, but the manifest says {list(planes)}; correct it")
        self.writer.output(name, value.name, ["batch", *planes])

    def tensor(self, node: Node, position: int) -> Tensor:
        """An input of a node that is computed."""
        found = self._tensors.get(node.inputs[position])
        if found is None:
            raise self._refuse(node, f"its input '{node.inputs[position]}' is not computed before it")
        return found

    def constant(self, node: Node, position: int) -> Array:
        """An input of a node that is a constant."""
        found = self._graph.constants.get(node.inputs[position])
        if found is None:
            raise self._refuse(node, f"its input '{node.inputs[position]}' is not a constant")
        return found

    def _needed(self, outputs: Sequence[str]) -> set[str]:
        needed: set[str] = set()
        waiting = list(outputs)
        while waiting:
            name = waiting.pop()
            if name in needed or name in self._tensors or name in self._graph.constants:
                continue
            if name not in self._nodes:
                raise UserError(f"{self._label}: the graph has no tensor '{name}'; correct the manifest")
            needed.add(name)
            waiting.extend(self._nodes[name].inputs)
        return needed

    def require(self, node: Node, attributes: Mapping[str, object]) -> None:
        """Refuse a node whose attributes are others than those that are understood."""
        for key, value in attributes.items():
            if node.attributes.get(key, value) != value:
                raise self._refuse(node, f"{key} = {node.attributes[key]} is not known")

    def _refuse(self, node: Node, reason: str) -> UserError:
        return UserError(f"{self._label}: cannot convert the node '{node.name}' ({node.op}): {reason}; extend tfjs_to_onnx.py")

    # One method an operation: read the node, write ONNX, return the result's tensor.

    def convolution(self, node: Node) -> Tensor:
        self.require(node, {"data_format": "NHWC", "dilations": [1, 1, 1, 1]})
        source = self.writer.in_order(self.tensor(node, 0), PLANES)
        kernel = self.constant(node, 1)
        depthwise = "Depthwise" in node.op
        rows, columns, inward, outward = kernel.shape
        if depthwise and outward != 1:
            raise self._refuse(node, f"{outward} results a channel are not known")
        # TensorFlow's kernels: [rows, columns, in, out]; ONNX's: [out, in / groups, rows, columns].
        weight = kernel.transpose(2, 3, 0, 1) if depthwise else kernel.transpose(3, 2, 0, 1)
        inputs = [source.name, self.writer.weight(node.inputs[1], weight)]
        fused = [str(item) for item in _list(node, "fused_ops")]
        if fused[:1] == ["BiasAdd"]:
            inputs.append(self.writer.weight(node.inputs[2], self.constant(node, 2)))
        pads, size = self._window(node, source, (rows, columns))
        name = self.writer.add(
            "Conv", node.name, inputs, group=inward if depthwise else 1, strides=_list(node, "strides")[1:3], pads=pads
        )
        shape = (None, *size, inward if depthwise else outward)
        return self._activation(node, fused[1:] if inputs[2:] else fused, Tensor(name, shape, PLANES))

    def max_pool(self, node: Node) -> Tensor:
        self.require(node, {"data_format": "NHWC"})
        source = self.writer.in_order(self.tensor(node, 0), PLANES)
        window = [int(side) for side in _list(node, "ksize")[1:3]]
        pads, size = self._window(node, source, (window[0], window[1]))
        name = self.writer.add(
            "MaxPool", node.name, [source.name], kernel_shape=window, strides=_list(node, "strides")[1:3], pads=pads
        )
        return Tensor(name, (None, *size, source.shape[3]), PLANES)

    def _window(self, node: Node, source: Tensor, window: tuple[int, int]) -> tuple[list[int], tuple[int, int]]:
        """ONNX's pads (top, left, bottom, right) and the result's rows and columns, of a window that moves over a picture."""
        before, after, size = [], [], []
        for axis, extent in zip((1, 2), window, strict=True):
            length, stride = source.shape[axis], int(_list(node, "strides")[axis])
            if length is None:
                raise self._refuse(node, "it moves a window along the batch")
            match node.attributes["padding"]:
                case "SAME":  # as large as if every stride began a window; an odd pixel of padding goes to the end
                    count = -(-length // stride)
                    total = max((count - 1) * stride + extent - length, 0)
                case "VALID":
                    count, total = (length - extent) // stride + 1, 0
                case other:
                    raise self._refuse(node, f"padding = {other} is not known")
            before.append(total // 2)
            after.append(total - total // 2)
            size.append(count)
        return [*before, *after], (size[0], size[1])

    def _activation(self, node: Node, fused: Sequence[str], result: Tensor) -> Tensor:
        if not fused:
            return result
        if len(fused) > 1 or fused[0] not in _ACTIVATIONS:
            raise self._refuse(node, f"fused_ops = {list(fused)} is not known")
        return self._elementwise(_ACTIVATIONS[fused[0]], f"{node.name}/{fused[0]}", result)

    def _elementwise(self, op: str, name: str, source: Tensor, **attributes: Any) -> Tensor:
        inputs = [source.name]
        if op == "Clip":
            limits = {"relu6/low": 0.0, "relu6/high": 6.0}
            inputs += [self.writer.weight(key, np.array(value, np.float32)) for key, value in limits.items()]
        return Tensor(self.writer.add(op, name, inputs, **attributes), source.shape, source.order)

    def activation(self, node: Node) -> Tensor:
        return self._elementwise(_ACTIVATIONS[node.op], node.name, self.tensor(node, 0))

    def leaky_relu(self, node: Node) -> Tensor:
        return self._elementwise("LeakyRelu", node.name, self.tensor(node, 0), alpha=node.attributes["alpha"])

    def addition(self, node: Node) -> Tensor:
        first = self.tensor(node, 0)
        if node.inputs[1] in self._graph.constants:
            value = self.constant(node, 1)
            spread = value.reshape((1,) * (len(first.shape) - value.ndim) + value.shape).transpose(first.order)
            second = self.writer.weight(node.inputs[1], spread)
        else:
            other = self.tensor(node, 1)
            if other.shape != first.shape:
                raise self._refuse(node, f"it adds {other.shape} to {first.shape}")
            second = self.writer.in_order(other, first.order).name
        return Tensor(self.writer.add("Add", node.name, [first.name, second]), first.shape, first.order)

    def padding(self, node: Node) -> Tensor:
        source = self.tensor(node, 0)
        amounts = [(int(before), int(after)) for before, after in self.constant(node, 1)]
        fill = self.constant(node, 2) if node.op == "PadV2" else np.zeros((), np.float32)
        stored = source.stored(amounts)
        pads = np.array([before for before, _ in stored] + [after for _, after in stored], np.int64)
        inputs = [source.name, self.writer.weight(f"{node.name}/pads", pads), self.writer.weight(f"{node.name}/fill", fill)]
        shape = tuple(None if size is None else size + sum(amount) for size, amount in zip(source.shape, amounts, strict=True))
        return Tensor(self.writer.add("Pad", node.name, inputs), shape, source.order)

    def concatenation(self, node: Node) -> Tensor:
        *positions, last = range(len(node.inputs))
        axis = int(self.constant(node, last))
        first = self.tensor(node, 0)
        parts = [self.writer.in_order(self.tensor(node, position), first.order) for position in positions]
        shape = list(first.shape)
        shape[axis] = sum(part.shape[axis] or 0 for part in parts)
        name = self.writer.add("Concat", node.name, [part.name for part in parts], axis=first.order.index(axis))
        return Tensor(name, tuple(shape), first.order)

    def resizing(self, node: Node) -> Tensor:
        self.require(node, {"half_pixel_centers": True, "align_corners": False})
        source = self.writer.in_order(self.tensor(node, 0), PLANES)
        rows, columns = (int(side) for side in self.constant(node, 1))
        _, height, width, channels = source.shape
        if height is None or width is None:
            raise self._refuse(node, "it resizes the batch")
        scales = self.writer.weight(f"{node.name}/scales", np.array((1, 1, rows / height, columns / width), np.float32))
        name = self.writer.add(
            "Resize", node.name, [source.name, "", scales], mode="linear", coordinate_transformation_mode="half_pixel"
        )
        return Tensor(name, (None, rows, columns, channels), PLANES)

    def transposition(self, node: Node) -> Tensor:
        return self.tensor(node, 0).transposed([int(axis) for axis in self.constant(node, 1)])


def _list(node: Node, key: str) -> list[Any]:
    value = node.attributes.get(key, [])
    return list(value) if isinstance(value, list) else [value]


_ACTIVATIONS = {"Relu": "Relu", "Relu6": "Clip", "Sigmoid": "Sigmoid"}
_HANDLERS: Mapping[str, Callable[[_Conversion, Node], Tensor]] = {
    "_FusedConv2D": _Conversion.convolution,
    "Conv2D": _Conversion.convolution,
    "FusedDepthwiseConv2dNative": _Conversion.convolution,
    "DepthwiseConv2dNative": _Conversion.convolution,
    "MaxPool": _Conversion.max_pool,
    "Relu": _Conversion.activation,
    "Relu6": _Conversion.activation,
    "Sigmoid": _Conversion.activation,
    "LeakyRelu": _Conversion.leaky_relu,
    "Add": _Conversion.addition,
    "AddV2": _Conversion.addition,
    "Pad": _Conversion.padding,
    "PadV2": _Conversion.padding,
    "ConcatV2": _Conversion.concatenation,
    "ResizeBilinear": _Conversion.resizing,
    "Transpose": _Conversion.transposition,
}
