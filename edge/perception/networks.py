"""Loads a converted network from the data folder and makes it callable."""

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, Protocol

import onnxruntime as ort

from edge.perception.network_file import read_network_file
from models.arrays import Float32, UInt8

Provider = Literal["cpu", "openvino"]


class Network(Protocol):
    """A network that runs; the code around it needs no more than this, and tests give it a function."""

    @property
    def size_px(self) -> tuple[int, int]:
        """(height, width) of the pictures it takes."""

    def __call__(self, pictures: UInt8) -> Mapping[str, Float32]:
        """Run on uint8 RGB pictures (N, height, width, 3); gives planes (N, channels, rows, columns) by output name."""


def load_network(name: str, data: Path, provider: Provider = "cpu") -> Network:
    """Load the network `name` of the manifest from the data folder.

    Args:
        name: its name in the manifest, such as "movenet-thunder".
        data: the data folder; the network is in its folder `networks`.
        provider: "cpu" is onnxruntime's own kernels; "openvino" needs the extra of that name.

    Raises:
        UserError: the network is not installed, is damaged, or the provider is not installed.
    """
    model = read_network_file(name, data)
    if provider == "openvino":
        from edge.perception.openvino_network import OpenVinoNetwork  # noqa: PLC0415 - an optional dependency

        return OpenVinoNetwork(model)
    return OnnxNetwork(model)


class OnnxNetwork:
    """A network on onnxruntime's CPU kernels: one thread, which sleeps when it has nothing to do.

    Four cameras share the cores; each process that ran several threads, or spun while waiting, would take time from the others.
    """

    def __init__(self, model: bytes) -> None:
        ort.disable_telemetry_events()
        options = ort.SessionOptions()
        options.intra_op_num_threads = 1
        options.inter_op_num_threads = 1
        options.execution_mode = ort.ExecutionMode.ORT_SEQUENTIAL
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        options.log_severity_level = 3
        self._session = ort.InferenceSession(model, options, providers=["CPUExecutionProvider"])
        (source,) = self._session.get_inputs()
        self._input: str = source.name
        self._size_px = (int(source.shape[1]), int(source.shape[2]))
        self._outputs: list[str] = [output.name for output in self._session.get_outputs()]

    @property
    def size_px(self) -> tuple[int, int]:
        """(height, width) of the pictures it takes."""
        return self._size_px

    def __call__(self, pictures: UInt8) -> Mapping[str, Float32]:
        """See `Network`."""
        return dict(zip(self._outputs, self._session.run(self._outputs, {self._input: pictures}), strict=True))
