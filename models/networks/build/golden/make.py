"""Makes tests/golden/networks: pictures of the Pose2Sim demo and what TensorFlow.js computes on them. See README.md here."""

import argparse
import hashlib
import json
import subprocess
import sys
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import numpy.typing as npt

from models.arrays import UInt8
from models.errors import UserError
from models.networks.build.install import MANIFEST, install, sources_folder
from models.networks.build.registry import fetch_pypi
from models.networks.manifest import Input, Manifest, Network, decode_manifest

TFJS = "@tensorflow/tfjs@4.22.0"
TARGET = Path("tests/golden/networks")
SAMPLE_EVERY = 101
"""Of each tensor every 101st value is kept, in the original order: a prime, so that every channel, row and column is met."""
_JPEG_QUALITY = 90
_VIDEOS = "Pose2Sim/Demo_SinglePerson/videos"
_WHEEL_SHA256 = "403e0dc4065898ba6a595e72a8970950310979253d60e24c2e00b16b36bf21e1"


@dataclass(frozen=True)
class Picture:
    """A square of one video frame, for one or more networks. `left`, `top` and `side` are pixels of the video."""

    name: str
    video: str
    frame: int
    left: int
    top: int
    side: int
    networks: tuple[str, ...]


PICTURES = (
    Picture("reach", "cam02", 33, 60, 380, 860, ("movenet-thunder", "blazepose-full")),
    Picture("two-people", "cam02", 66, 200, 400, 860, ("movenet-thunder",)),
    Picture("lean", "cam04", 33, 60, 370, 980, ("movenet-lightning",)),
    Picture("room", "cam01", 0, 0, 300, 1080, ("nanodet",)),
)
KEYPOINTS = "keypoints"
_FINAL = "Identity"
"""The tensor in which both MoveNets give [1, 1, 17, 3]: y, x, score, decoded by their own tail."""


@dataclass(frozen=True)
class Job:
    """One run of an original graph: the script's instructions, and under which key each output file is kept."""

    instructions: Mapping[str, object]
    outputs: Mapping[str, Path]


def make(manifest: Manifest, data: Path) -> None:
    """Write pictures.json, the pictures and references.npz."""
    work = (data / "golden").resolve()
    work.mkdir(parents=True, exist_ok=True)
    TARGET.mkdir(parents=True, exist_ok=True)
    install(manifest, data)
    wheel = fetch_pypi("pose2sim", "0.10.49", "-py3-none-any.whl", _WHEEL_SHA256, work)
    index: dict[str, object] = {}
    jobs: list[Job] = []
    for picture in PICTURES:
        size = manifest.networks[picture.networks[0]].input.height
        file = TARGET / f"{picture.name}.jpg"
        _write_jpeg(file, _cut(wheel, picture, size, work))
        # What a test will see is what the JPEG decodes to, so the reference must see the same.
        pixels = read_rgb(file)
        index[picture.name] = {
            "networks": picture.networks,
            "pixels_sha256": hashlib.sha256(pixels.tobytes()).hexdigest(),
            "origin": f"pose2sim 0.10.49, {_VIDEOS}/{picture.video}.mp4, frame {picture.frame}",
        }
        sources = sources_folder(data).resolve()
        jobs += [_job(name, manifest.networks[name], picture.name, pixels, sources, work) for name in picture.networks]
    (TARGET / "pictures.json").write_text(json.dumps(index, indent=2) + "\n")
    _run(jobs, work)
    references = {key: np.fromfile(file, np.float32) for job in jobs for key, file in job.outputs.items()}
    kept: dict[str, Any] = {
        key: values if key.endswith(f"/{KEYPOINTS}") else values[::SAMPLE_EVERY] for key, values in references.items()
    }
    np.savez_compressed(TARGET / "references.npz", **kept)


def read_rgb(path: Path) -> UInt8:
    """A picture (height, width, 3) in RGB."""
    pixels = cv2.imread(str(path), cv2.IMREAD_COLOR_RGB)
    if pixels is None:
        raise UserError(f"{path} is no picture that can be read; restore it from the repository")
    return pixels.astype(np.uint8)


def _cut(wheel: Path, picture: Picture, size: int, work: Path) -> UInt8:
    with zipfile.ZipFile(wheel) as archive:
        video = Path(archive.extract(f"{_VIDEOS}/{picture.video}.mp4", work))
    with av.open(str(video)) as container:
        for index, frame in enumerate(container.decode(video=0)):
            if index == picture.frame:
                image = frame.to_ndarray(format="rgb24")
                break
        else:
            raise UserError(f"{video} has no frame {picture.frame}")
    square = image[picture.top : picture.top + picture.side, picture.left : picture.left + picture.side]
    return cv2.resize(square, (size, size), interpolation=cv2.INTER_AREA).astype(np.uint8)


def _write_jpeg(path: Path, rgb: UInt8) -> None:
    cv2.imwrite(str(path), cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])


def _job(name: str, network: Network, picture: str, pixels: UInt8, sources: Path, work: Path) -> Job:
    tensor, values = _original_input(network.input, pixels)
    file = work / f"{name}-{picture}.input"
    values.tofile(file)
    wanted = {output.name: output.tensor for output in network.outputs}
    if name.startswith("movenet"):
        wanted[KEYPOINTS] = _FINAL
    outputs = {key: work / f"{name}-{picture}-{key}.output" for key in wanted}
    instructions = {
        "graph": str(sources / network.graph.path),
        "shards": [str(sources / shard.path) for shard in network.shards],
        "input": {"tensor": tensor, "dtype": values.dtype.name, "shape": values.shape, "file": str(file)},
        "outputs": [{"tensor": wanted[key], "file": str(file)} for key, file in outputs.items()],
    }
    return Job(instructions, {f"{name}/{picture}/{key}": file for key, file in outputs.items()})


def _original_input(picture: Input, pixels: UInt8) -> tuple[str, npt.NDArray[Any]]:
    """Name and value of the original graph's input; MoveNet normalises inside, so it is given the pixels themselves."""
    if picture.tensor != "input_1":
        return "input", pixels[np.newaxis].astype(np.int32)
    ordered = pixels[..., ::-1] if picture.channels == "bgr" else pixels
    scale, offset = np.array(picture.scale, np.float32), np.array(picture.offset, np.float32)
    values = ordered[np.newaxis].astype(np.float32) * scale + offset
    return picture.tensor, np.ascontiguousarray(values.transpose(0, 3, 1, 2) if picture.layout == "nchw" else values)


def _run(jobs: Sequence[Job], work: Path) -> None:
    (work / "jobs.json").write_text(json.dumps([job.instructions for job in jobs]))
    (work / "package.json").write_text('{"private": true}\n')
    subprocess.run(["npm", "install", "--no-audit", "--no-fund", "--ignore-scripts", TFJS], cwd=work, check=True)
    script = Path(__file__).with_name("reference.mjs")
    subprocess.run(["node", str(script), "jobs.json"], cwd=work, check=True)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description="Make the golden vectors of the networks anew.")
    parser.add_argument("--data", type=Path, required=True)
    try:
        make(decode_manifest(MANIFEST.read_bytes()), parser.parse_args().data)
    except UserError as error:
        sys.stderr.write(f"kinebox: {error}\n")
        raise SystemExit(2) from error


if __name__ == "__main__":
    main()
