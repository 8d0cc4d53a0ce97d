"""A network on OpenVINO, the optional provider, with its three traps closed.

- Importing `openvino` reports the import to its maker; the package that does so is kept from being found, as if not installed.
- By default it pins its threads: every one-thread process of the box would be put on the same core.
- By default it computes in bfloat16 where the processor has it. That moves keypoints by 2 px and more, and without a matrix
  unit (AMX) it is half as fast as float32, so float32 is asked for.
"""

import importlib
import sys
from collections.abc import Mapping
from types import ModuleType
from typing import Any, cast

import numpy as np

from models.arrays import Float32, UInt8
from models.errors import UserError

_SETTINGS = {
    "INFERENCE_NUM_THREADS": 1,
    "NUM_STREAMS": 1,
    "ENABLE_CPU_PINNING": False,
    "INFERENCE_PRECISION_HINT": "f32",
    "PERFORMANCE_HINT": "LATENCY",
}


class OpenVinoNetwork:
    """As `edge.perception.networks.OnnxNetwork`, on OpenVINO's kernels; one picture at a time."""

    def __init__(self, model: bytes) -> None:
        core = _import_openvino().Core()
        graph = core.read_model(model=model)
        source = graph.input(0)
        rows, columns = (source.partial_shape[axis].get_length() for axis in (1, 2))
        # A free batch would make every shape inside dynamic, which costs more than it saves.
        graph.reshape([1, rows, columns, 3])
        self._size_px = (int(rows), int(columns))
        self._request: Any = core.compile_model(graph, "CPU", _SETTINGS).create_infer_request()
        self._outputs = [output.get_any_name() for output in graph.outputs]

    @property
    def size_px(self) -> tuple[int, int]:
        """(height, width) of the pictures it takes."""
        return self._size_px

    def __call__(self, pictures: UInt8) -> Mapping[str, Float32]:
        """See `edge.perception.networks.Network`."""
        parts = [self._run(picture[np.newaxis]) for picture in pictures]
        return {name: np.concatenate([part[name] for part in parts]) for name in self._outputs}

    def _run(self, picture: UInt8) -> dict[str, Float32]:
        results = self._request.infer([picture])
        return {name: np.array(results[position]) for position, name in enumerate(self._outputs)}


def _import_openvino() -> ModuleType:
    sys.modules.setdefault("openvino_telemetry", cast(ModuleType, None))  # None makes its import fail
    try:
        return importlib.import_module("openvino")
    except ImportError as error:
        raise UserError(
            f'inference.provider = "openvino", but OpenVINO cannot be imported ({error}); install it with '
            "`.venv/bin/pip install 'openvino>=2026.4'` or set the provider to \"cpu\""
        ) from error
