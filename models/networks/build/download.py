"""A download that is checked by its hash and goes on where it stopped, in this run or in a later one."""

import base64
import binascii
import hashlib
import http.client
import os
import re
import ssl
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from urllib.parse import urlsplit

from models.errors import UserError
from models.networks.build.progress import Progress

_ATTEMPTS = 6
_TIMEOUT_S = 60.0
_CHUNK = 1 << 18
_SCHEMES = ("https", "http", "file")
# The clients of both registries take further certificates from these; so do we, or a school's proxy would stop us alone.
_CERTIFICATE_VARIABLES = ("PIP_CERT", "REQUESTS_CA_BUNDLE", "CURL_CA_BUNDLE", "NODE_EXTRA_CA_CERTS")


@dataclass(frozen=True)
class Digest:
    """The hash that a file must have: the algorithm's name in hashlib and the lower-case hexadecimal value."""

    algorithm: str
    value: str

    @classmethod
    def of_integrity(cls, integrity: str) -> "Digest":
        """From npm's notation "sha512-<base64>" (W3C Subresource Integrity); ValueError if it is not that."""
        algorithm, _, encoded = integrity.partition("-")
        try:
            value = base64.b64decode(encoded, validate=True).hex()
        except binascii.Error as error:
            raise ValueError(f"'{integrity}' is no integrity value: {error}") from error
        if algorithm not in ("sha256", "sha384", "sha512") or len(value) != 2 * hashlib.new(algorithm).digest_size:
            raise ValueError(f"'{integrity}' is no integrity value: expected sha512-<base64>")
        return cls(algorithm, value)

    def matches(self, path: Path) -> bool:
        """Whether the file at `path` has this hash."""
        with path.open("rb") as file:
            return hashlib.file_digest(file, self.algorithm).hexdigest() == self.value


def download(url: str, target: Path, digest: Digest, pause: Callable[[float], None] = time.sleep) -> Path:
    """Fetch `url` to `target` unless it is there already, and return `target`.

    What has arrived is kept beside it as `<name>.part`; a broken connection is taken up again from there, several times in
    this run and once more in every later one. `target` appears only when its hash is right.

    Raises:
        UserError: the server refuses, the connection stays broken, or the content has another hash than the one pinned.
    """
    if target.is_file() and digest.matches(target):
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    part = target.with_name(f"{target.name}.part")
    resumed = part.is_file() and part.stat().st_size > 0
    _fetch_persistently(url, part, pause)
    if resumed and not digest.matches(part):
        # What an earlier run left may be the damaged half: start over once before blaming the server.
        part.unlink()
        _fetch_persistently(url, part, pause)
    if not digest.matches(part):
        size = part.stat().st_size
        part.unlink()
        raise UserError(
            f"{target.name}: the {size} bytes downloaded do not have the {digest.algorithm} hash pinned for it; nothing was "
            "installed. Try again; if it happens again, something on the way (a proxy, a mirror) alters the file"
        )
    part.replace(target)
    return target


def _fetch_persistently(url: str, part: Path, pause: Callable[[float], None]) -> None:
    for attempt in range(1, _ATTEMPTS + 1):
        try:
            _fetch_rest(url, part)
        except urllib.error.HTTPError as error:
            if error.code < 500:
                raise UserError(f"{part.stem}: the registry answers {error.code} {error.reason}; check its settings") from error
            problem: Exception = error
        except (OSError, http.client.HTTPException) as error:
            problem = error
        else:
            return
        if attempt < _ATTEMPTS:
            pause(2.0**attempt / 2)
    there = part.stat().st_size / 1e6 if part.is_file() else 0.0
    reason = getattr(problem, "reason", None) or problem
    raise UserError(
        f"{part.stem}: the download broke off {_ATTEMPTS} times ({reason}); {there:.1f} MB are kept. Check the connection and "
        "run the same command again: it goes on from there"
    ) from problem


def _fetch_rest(url: str, part: Path) -> None:
    """Append to `part` what it still lacks; start over if the server cannot send a rest."""
    scheme = urlsplit(url).scheme
    if scheme not in _SCHEMES:
        raise UserError(f"{part.stem}: the registry's address has an unknown scheme ({scheme})")
    have = part.stat().st_size if part.is_file() else 0
    headers = {"Accept-Encoding": "identity", "User-Agent": "kinebox-setup"}
    if have:
        headers["Range"] = f"bytes={have}-"
    request = urllib.request.Request(url, headers=headers)  # noqa: S310 - the scheme is checked above
    try:
        response = urllib.request.urlopen(request, timeout=_TIMEOUT_S, context=_trust() if scheme == "https" else None)  # noqa: S310
    except urllib.error.HTTPError as error:
        if error.code == http.client.REQUESTED_RANGE_NOT_SATISFIABLE and have:
            return  # nothing is lacking; the hash decides
        raise
    with response:
        have, total = _extent(response, have)
        progress = Progress(part.stem, total)
        with part.open("ab" if have else "wb") as file:
            progress.show(have)
            while chunk := response.read(_CHUNK):
                file.write(chunk)
                have += len(chunk)
                progress.show(have)
        progress.close()
    if total is not None and have < total:
        raise ConnectionError(f"connection closed after {have} of {total} bytes")


def _extent(response: "http.client.HTTPResponse", have: int) -> tuple[int, int | None]:
    """First byte that this response carries, and the length of the whole file if it is told."""
    if getattr(response, "status", None) == http.client.PARTIAL_CONTENT:
        span = re.fullmatch(r"bytes (\d+)-\d+/(\d+|\*)", response.headers.get("Content-Range", ""))
        if not span or int(span[1]) != have:
            raise ConnectionError(f"the server sent another part ({response.headers.get('Content-Range')}) than asked for")
        return have, None if span[2] == "*" else int(span[2])
    length = response.headers.get("Content-Length")
    return 0, int(length) if length else None


@cache
def _trust() -> ssl.SSLContext:
    context = ssl.create_default_context()
    for variable in _CERTIFICATE_VARIABLES:
        bundle = os.environ.get(variable)
        if bundle and Path(bundle).is_file():
            context.load_verify_locations(bundle)
    return context
