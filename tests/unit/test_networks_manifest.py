"""The manifest of the networks says what is wrong with it, and where."""

from pathlib import Path

import pytest

from models.errors import UserError
from models.networks.installed import INSTALLED_VERSION, Installed, InstalledNetwork, decode_installed, encode_installed
from models.networks.manifest import decode_manifest

MANIFEST = Path("models/networks/manifest.toml").read_text()


def test_the_committed_manifest_names_every_network_with_licence_and_hashes() -> None:
    manifest = decode_manifest(MANIFEST.encode())
    assert set(manifest.networks) == {"movenet-thunder", "movenet-lightning", "nanodet", "blazepose-full"}
    assert {network.licence for network in manifest.networks.values()} == {"Apache-2.0"}
    assert [output.name for output in manifest.networks["movenet-thunder"].outputs] == [
        "centre",
        "heatmaps",
        "regressions",
        "offsets",
        "features",
    ]


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ('registry = "npm"', 'registry = "npm"\nmirror = "somewhere"', "mirror"),
        ('registry = "npm"', 'registry = "gopher"', "registry"),
        ("version = 1", "version = 2", "version"),
        ('licence = "Apache-2.0"', "", "licence"),
        ("sha512-qTqd", "sha512-qT", "integrity"),
        ('sha256 = "7ac4e2', 'sha256 = "7AC4E2', "sha256"),
        ('source = "human-models"', 'source = "elsewhere"', "elsewhere"),
        ('name = "offsets"', 'name = "heatmaps"', "movenet-thunder"),
        ("height = 256", "height = 0", "height"),
        ("version = 1", "version = = 1", "manifest.toml"),
    ],
)
def test_a_wrong_entry_is_one_line_that_names_it(old: str, new: str, named: str) -> None:
    assert old in MANIFEST
    with pytest.raises(UserError, match=r"networks/manifest\.toml") as error:
        decode_manifest(MANIFEST.replace(old, new, 1).encode())
    assert named in str(error.value)
    assert "\n" not in str(error.value)


def test_the_list_of_installed_networks_survives_a_round_trip() -> None:
    installed = Installed(INSTALLED_VERSION, {"toy": InstalledNetwork("toy.onnx", "ab" * 32, "cd" * 32, {"toy.json": "ef" * 32})})
    assert decode_installed(encode_installed(installed), Path("installed.json")) == installed


@pytest.mark.parametrize("data", [b"", b"{", b'{"version": 1}', b'{"version": 99, "networks": {}}'])
def test_a_damaged_list_of_installed_networks_says_what_to_do(data: bytes) -> None:
    with pytest.raises(UserError, match=r"; delete build/networks/installed\.json and run `make networks`$"):
        decode_installed(data, Path("build/networks/installed.json"))
