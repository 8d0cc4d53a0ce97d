"""The manifest of the networks: which files, with which hash and licence, become which network. Pure: decodes bytes."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from models.errors import UserError

Sha256 = Annotated[str, Meta(pattern=r"^[0-9a-f]{64}$")]
Size = Annotated[int, Meta(ge=1, le=4096)]
Name = Annotated[str, Meta(pattern=r"^[a-z0-9][a-z0-9-]*$")]
Triple = tuple[float, float, float]


class Entry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of every table of the manifest."""


class Source(Entry, frozen=True):
    """A package of a registry, pinned.

    Attributes:
        registry: "npm".
        package: its name there, with its scope.
        release: its version.
        integrity: hash of its archive in npm's notation, "sha512-<base64>".
    """

    registry: Literal["npm"]
    package: str
    release: str
    integrity: Annotated[str, Meta(pattern=r"^sha512-[A-Za-z0-9+/]{86}==$")]


class File(Entry, frozen=True):
    """One file inside a source's archive."""

    path: Annotated[str, Meta(pattern=r"^[^/].*$")]
    sha256: Sha256


class Input(Entry, frozen=True):
    """What replaces the original graph's input.

    Attributes:
        tensor: name of the tensor that the normalised picture stands for.
        layout: order of that tensor's axes: batch, rows, columns, channels or batch, channels, rows, columns.
        height: rows of the picture in pixels.
        width: columns of the picture in pixels.
        channels: order in which the original network was trained to see the colours; ours are always given as RGB.
        scale: see `offset`.
        offset: value = pixel * scale + offset, a number for each channel in the order of `channels`.
    """

    tensor: str
    layout: Literal["nhwc", "nchw"]
    height: Size
    width: Size
    channels: Literal["rgb", "bgr"]
    scale: Triple
    offset: Triple


class Output(Entry, frozen=True):
    """A tensor of the original graph that is given out as float32 planes [batch, channels, height, width]."""

    name: Name
    tensor: str
    channels: Size
    height: Size
    width: Size


class Network(Entry, frozen=True):
    """One network: the tfjs graph and its weights, where they come from, what goes in and what comes out."""

    source: str
    graph: File
    shards: Annotated[tuple[File, ...], Meta(min_length=1)]
    licence: str
    origin: str
    input: Input
    outputs: Annotated[tuple[Output, ...], Meta(min_length=1)]

    @property
    def files(self) -> tuple[File, ...]:
        """Every file needed of the source."""
        return (self.graph, *self.shards)


class Manifest(Entry, frozen=True):
    """All networks of the box by name."""

    version: Literal[1]
    sources: dict[Name, Source]
    networks: dict[Name, Network]


def decode_manifest(data: bytes) -> Manifest:
    """Read `manifest.toml`.

    Raises:
        UserError: not TOML, an unknown or missing key, a value out of bounds, or a source that is not there.
    """
    try:
        manifest = msgspec.toml.decode(data, type=Manifest)
    except (msgspec.ValidationError, msgspec.DecodeError) as error:
        raise UserError(f"networks/manifest.toml: {error}; correct this entry") from error
    for name, network in manifest.networks.items():
        where, source = f"networks/manifest.toml: {name}", network.source
        if source not in manifest.sources:
            raise UserError(f"{where} names the source '{source}', which has no table; add [sources.{source}]")
        given = [output.name for output in network.outputs]
        if len(set(given)) != len(given):
            raise UserError(f"{where} gives the same name to two outputs; rename one")
    return manifest
