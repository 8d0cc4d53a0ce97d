"""The converter computes what TensorFlow would, and names the node that it does not know."""

from typing import Any

import msgspec
import numpy as np
import onnx
import onnxruntime as ort
import pytest

from models.arrays import Float32, UInt8
from models.errors import UserError
from models.networks.build.tfjs_graph import read_graph
from models.networks.build.tfjs_to_onnx import convert
from models.networks.manifest import Network, Output
from tests.toy_network import CONVOLUTION, ToyGraph, toy_graph, toy_network


def converted(graph: ToyGraph, network: Network) -> onnx.ModelProto:
    document, shard = graph.files()
    return convert("toy", network, read_graph("toy", document, [shard]))


def run(model: onnx.ModelProto, pictures: UInt8) -> list[Float32]:
    session = ort.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    results: list[Float32] = session.run(None, {"pictures": pictures})
    return results


def pictures(count: int = 1, seed: int = 3) -> UInt8:
    return np.random.default_rng(seed).integers(0, 256, (count, 6, 6, 3), dtype=np.uint8)


def output(tensor: str, channels: int, side: int) -> Output:
    return Output(name="planes", tensor=tensor, channels=channels, height=side, width=side)


def normalised(network: Network, images: UInt8) -> Float32:
    values: Float32 = (images * np.array(network.input.scale) + np.array(network.input.offset)).astype(np.float32)
    return values


def test_a_strided_convolution_pads_the_odd_pixel_at_the_end() -> None:
    graph = toy_graph()
    network = toy_network(graph)
    document, shard = graph.files()
    weights = read_graph("toy", document, [shard]).constants
    kernel, bias = weights["kernel"], weights["bias"]
    images = pictures(2)
    # 6 pixels, stride 2, kernel 3: one pixel of padding in all, which TensorFlow puts at the right and the bottom.
    padded = np.pad(normalised(network, images), ((0, 0), (0, 1), (0, 1), (0, 0)))
    expected = np.zeros((2, 4, 3, 3))
    for row in range(3):
        for column in range(3):
            window = padded[:, 2 * row : 2 * row + 3, 2 * column : 2 * column + 3]
            expected[:, :, row, column] = np.clip(np.einsum("bhwi,hwio->bo", window, kernel) + bias, 0, 6)
    (planes,) = run(converted(graph, network), images)
    np.testing.assert_allclose(planes, expected, atol=2e-3)


def test_transposes_leave_no_node_behind() -> None:
    graph = toy_graph()
    to_planes, to_pixels = np.array((0, 3, 1, 2), np.int32), np.array((0, 2, 3, 1), np.int32)
    graph.node("Transpose", "planes", ["head", graph.constant("there", to_planes)])
    graph.node("LeakyRelu", "leaky", ["planes"], alpha=0.1)
    pads = np.array(((0, 0), (0, 0), (1, 1), (1, 1)), np.int32)
    graph.node("Pad", "padded", ["leaky", graph.constant("pads", pads)])
    graph.node("Transpose", "pixels", ["padded", graph.constant("back", to_pixels)])
    graph.node("MaxPool", "pooled", ["pixels"], ksize=[1, 3, 3, 1], strides=[1, 2, 2, 1], padding="VALID", data_format="NHWC")
    graph.node("ConcatV2", "twice", ["pooled", "pooled", graph.constant("axis", np.array(3, np.int32))])
    graph.node("AddV2", "moved", ["twice", graph.constant("by", np.arange(8, dtype=np.float32))])
    network = toy_network(graph, [output("moved", 8, 2)])
    model = converted(graph, network)
    assert sum(node.op_type == "Transpose" for node in model.graph.node) == 1, "only the picture itself is transposed"
    images = pictures()
    (head,) = run(converted(graph, toy_network(graph)), images)
    padded = np.pad(head, ((0, 0), (0, 0), (1, 1), (1, 1)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(2, 3))[:, :, ::2, ::2]
    pooled = windows.max(axis=(-1, -2))
    expected = np.concatenate((pooled, pooled), axis=1) + np.arange(8).reshape(1, 8, 1, 1)
    np.testing.assert_allclose(run(model, images)[0], expected, atol=1e-5)


def test_depthwise_kernels_and_resizing() -> None:
    graph = toy_graph()
    kernel = np.random.default_rng(5).normal(size=(3, 3, 4, 1)).astype(np.float32)
    plain = {**CONVOLUTION, "strides": [1, 1, 1, 1]}
    graph.node("DepthwiseConv2dNative", "each", ["head", graph.constant("own", kernel)], **plain)
    size = graph.constant("size", np.array((6, 6), np.int32))
    graph.node("ResizeBilinear", "large", ["each", size], half_pixel_centers=True, align_corners=False)
    images = pictures()
    (head,) = run(converted(graph, toy_network(graph)), images)
    padded = np.pad(head, ((0, 0), (0, 0), (1, 1), (1, 1)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, (3, 3), axis=(2, 3))
    each = np.einsum("bcijhw,hwc->bcij", windows, kernel[..., 0])
    # Twice as large with half-pixel centres: every new pixel is 3/4 of the nearest old one and 1/4 of the next; edges repeat.
    weights = np.array([[4, 0, 0], [3, 1, 0], [1, 3, 0], [0, 3, 1], [0, 1, 3], [0, 0, 4]]) / 4
    expected = np.einsum("ri,bcij,sj->bcrs", weights, each, weights)
    (large,) = run(converted(graph, toy_network(graph, [output("large", 4, 6)])), images)
    np.testing.assert_allclose(large, expected, atol=1e-4)


def test_a_network_for_blue_green_red_planes_still_takes_rgb() -> None:
    graph = ToyGraph()
    graph.node("Placeholder", "input_1")
    graph.node("Relu", "head", ["input_1"])
    network = toy_network(graph, [output("head", 3, 6)])
    picture = msgspec.structs.replace(
        network.input, layout="nchw", channels="bgr", scale=(1.0, 10.0, 100.0), offset=(1.0, 2.0, 3.0)
    )
    images = pictures()
    # The manifest's tensor is [batch, channels, rows, columns]; planes are given of [batch, rows, columns, channels].
    graph.node("Transpose", "pixels", ["head", graph.constant("perm", np.array((0, 2, 3, 1), np.int32))])
    network = msgspec.structs.replace(network, input=picture, outputs=(output("pixels", 3, 6),))
    (planes,) = run(converted(graph, network), images)
    expected = images[0, ..., ::-1].astype(np.float32).transpose(2, 0, 1) * [[[1]], [[10]], [[100]]] + [[[1]], [[2]], [[3]]]
    np.testing.assert_allclose(planes[0], expected, rtol=1e-6)


@pytest.mark.parametrize(
    ("op", "attributes", "reason"),
    [
        ("SparseToDense", {}, "its operation is not known"),
        ("_FusedConv2D", {**CONVOLUTION, "dilations": [1, 2, 2, 1]}, "dilations"),
        ("_FusedConv2D", {**CONVOLUTION, "padding": "EXPLICIT"}, "padding"),
        ("_FusedConv2D", {**CONVOLUTION, "fused_ops": ["BiasAdd", "Elu"]}, "Elu"),
    ],
)
def test_what_is_not_known_is_refused_by_the_nodes_name(op: str, attributes: dict[str, Any], reason: str) -> None:
    graph = toy_graph()
    graph.constant("kernel_2", np.ones((1, 1, 4, 4), np.float32))
    graph.constant("bias_2", np.ones(4, np.float32))
    graph.node(op, "model/block_7/strange", ["head", "kernel_2", "bias_2"], **{"fused_ops": ["BiasAdd"], **attributes})
    with pytest.raises(UserError, match=r"toy: cannot convert the node 'model/block_7/strange'") as error:
        converted(graph, toy_network(graph, [output("model/block_7/strange", 4, 2)]))
    assert reason in str(error.value)


def test_a_node_that_is_not_needed_may_be_of_any_kind() -> None:
    graph = toy_graph()
    graph.node("TopKV2", "tail", ["head"])
    assert converted(graph, toy_network(graph)).graph.output[0].name == "planes"


def test_a_tensor_that_is_not_there_or_has_another_shape_is_named() -> None:
    graph = toy_graph()
    with pytest.raises(UserError, match="'heads'"):
        converted(graph, toy_network(graph, [output("heads", 4, 3)]))
    with pytest.raises(UserError, match=r"\[4, 3, 3\].*\[5, 3, 3\]"):
        converted(graph, toy_network(graph, [output("head", 5, 3)]))


def test_weights_cut_off_or_left_over_are_refused() -> None:
    document, shard = toy_graph().files()
    with pytest.raises(UserError, match=r"'bias'.*truncated"):
        read_graph("toy", document, [shard[:-1]])
    with pytest.raises(UserError, match="3 bytes"):
        read_graph("toy", document, [shard, b"abc"])
    with pytest.raises(UserError, match="not a graph model"):
        read_graph("toy", document[:-20], [shard])
