"""Downloads against a real server that breaks off, starts over, alters and refuses; and the set-up on top of them."""

import base64
import hashlib
import io
import json
import re
import tarfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import msgspec
import pytest

from models.errors import UserError
from models.networks.build import install as setup
from models.networks.build import registry
from models.networks.build.download import Digest, download
from models.networks.manifest import Manifest, Source
from tests.toy_network import toy_graph, toy_network

CONTENT = bytes(range(256)) * 4096
SHA256 = hashlib.sha256(CONTENT).hexdigest()


class Server:
    """Serves one file. `breaks` connections are closed half-way through what they were to send."""

    def __init__(self, content: bytes = CONTENT, breaks: int = 0, ranges: bool = True, status: int = 200) -> None:
        self.content, self.breaks, self.ranges, self.status = content, breaks, ranges, status
        self.asked: list[str | None] = []
        self.url = ""

    def answer(self, request: BaseHTTPRequestHandler) -> None:
        wanted = request.headers.get("Range")
        self.asked.append(wanted)
        if self.status != 200:
            request.send_error(self.status)
            return
        first = int(wanted.removeprefix("bytes=").rstrip("-")) if wanted and self.ranges else 0
        if first >= len(self.content):
            request.send_error(416)
            return
        rest = self.content[first:]
        request.send_response(206 if first else 200)
        if first:
            request.send_header("Content-Range", f"bytes {first}-{len(self.content) - 1}/{len(self.content)}")
        request.send_header("Content-Length", str(len(rest)))
        request.end_headers()
        if self.breaks:
            self.breaks -= 1
            rest = rest[: len(rest) // 2]
        request.wfile.write(rest)


@contextmanager
def serving(server: Server) -> Iterator[Server]:
    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            server.answer(self)

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - the signature is http.server's
            pass

    listener = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=listener.serve_forever, args=(0.01,), daemon=True)
    thread.start()
    server.url = f"http://127.0.0.1:{listener.server_address[1]}/file.tgz"
    try:
        yield server
    finally:
        listener.shutdown()
        listener.server_close()
        thread.join()


def fetch(server: Server, target: Path, sha256: str = SHA256) -> Path:
    return download(server.url, target, Digest("sha256", sha256), pause=lambda _: None)


def test_a_broken_connection_is_taken_up_where_it_ended(tmp_path: Path) -> None:
    with serving(Server(breaks=2)) as server:
        path = fetch(server, tmp_path / "folder" / "file.tgz")
    assert path.read_bytes() == CONTENT
    half, quarter = len(CONTENT) // 2, len(CONTENT) // 4
    assert server.asked == [None, f"bytes={half}-", f"bytes={half + quarter}-"]
    assert [file.name for file in path.parent.iterdir()] == ["file.tgz"]


def test_a_later_run_goes_on_with_what_an_earlier_one_left(tmp_path: Path) -> None:
    with serving(Server(breaks=100)) as server:
        with pytest.raises(UserError, match=r"broke off 6 times .* MB are kept.*goes on from there"):
            fetch(server, tmp_path / "file.tgz")
        kept = (tmp_path / "file.tgz.part").stat().st_size
        assert 0 < kept < len(CONTENT)
        server.breaks = 0
        fetch(server, tmp_path / "file.tgz")
    assert server.asked[-1] == f"bytes={kept}-"


def test_a_server_without_ranges_is_asked_from_the_start(tmp_path: Path) -> None:
    with serving(Server(breaks=1, ranges=False)) as server:
        assert fetch(server, tmp_path / "file.tgz").read_bytes() == CONTENT


@pytest.mark.parametrize("left", [b"garbage of an earlier run", CONTENT + b"too much"])
def test_a_damaged_rest_of_an_earlier_run_is_thrown_away_once(tmp_path: Path, left: bytes) -> None:
    (tmp_path / "file.tgz.part").write_bytes(left)
    with serving(Server()) as server:
        assert fetch(server, tmp_path / "file.tgz").read_bytes() == CONTENT


def test_a_wrong_hash_installs_nothing_and_says_so(tmp_path: Path) -> None:
    with (
        serving(Server(content=CONTENT[:-1] + b"x")) as server,
        pytest.raises(UserError, match=r"file\.tgz: .* sha256 hash pinned"),
    ):
        fetch(server, tmp_path / "file.tgz")
    assert list(tmp_path.iterdir()) == []


def test_a_truncated_file_under_the_right_name_is_fetched_again(tmp_path: Path) -> None:
    (tmp_path / "file.tgz").write_bytes(CONTENT[:1000])
    with serving(Server()) as server:
        assert fetch(server, tmp_path / "file.tgz").read_bytes() == CONTENT
        fetch(server, tmp_path / "file.tgz")
    assert len(server.asked) == 1, "what is right is not asked for again"


def test_a_refusal_is_not_tried_again(tmp_path: Path) -> None:
    with serving(Server(status=404)) as server, pytest.raises(UserError, match=r"file\.tgz: the registry answers 404"):
        fetch(server, tmp_path / "file.tgz")
    assert len(server.asked) == 1


def test_an_integrity_value_of_npm_is_read_and_a_wrong_one_refused() -> None:
    digest = hashlib.sha512(CONTENT)
    integrity = f"sha512-{base64.b64encode(digest.digest()).decode()}"
    assert Digest.of_integrity(integrity) == Digest("sha512", digest.hexdigest())
    for wrong in ("sha512-short", "md5-" + integrity[7:], integrity[7:], "sha512-***"):
        with pytest.raises(ValueError, match="no integrity value"):
            Digest.of_integrity(wrong)


# The set-up, with toys in place of the 144 MB package.


def archive_of(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as tar:
        for name, content in {"package/large.bin": b"0" * 100_000, **files}.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            tar.addfile(member, io.BytesIO(content))
    return buffer.getvalue()


def toy_manifest(archive: bytes) -> Manifest:
    integrity = f"sha512-{base64.b64encode(hashlib.sha512(archive).digest()).decode()}"
    source = Source(registry="npm", package="@toys/toy", release="1.0.0", integrity=integrity)
    return Manifest(version=1, sources={"toys": source}, networks={"toy": toy_network(toy_graph())})


@pytest.fixture
def toys(monkeypatch: pytest.MonkeyPatch) -> Iterator[Server]:
    document, shard = toy_graph().files()
    with serving(Server(archive_of({"package/toy.json": document, "package/toy.bin": shard}))) as server:
        # The registry's client would say where the package is; everything behind its answer is real.
        monkeypatch.setattr(registry, "_ask", lambda *_: json.dumps(server.url))
        yield server


def test_the_set_up_converts_once_and_then_only_looks(tmp_path: Path, toys: Server) -> None:
    manifest = toy_manifest(toys.content)
    first = setup.install(manifest, tmp_path)
    folder = tmp_path / "networks"
    model = folder / "toy.onnx"
    assert first.networks["toy"].sha256 == hashlib.sha256(model.read_bytes()).hexdigest()
    assert first.networks["toy"].sources == {file.path: file.sha256 for file in manifest.networks["toy"].files}
    assert not list((folder / "downloads").iterdir()), "the archive is not kept"
    written = [path.stat().st_mtime_ns for path in (model, folder / "installed.json")]
    assert setup.install(manifest, tmp_path) == first
    assert [path.stat().st_mtime_ns for path in (model, folder / "installed.json")] == written
    assert len(toys.asked) == 1


def test_a_truncated_network_or_list_is_made_anew_without_a_download(tmp_path: Path, toys: Server) -> None:
    manifest = toy_manifest(toys.content)
    first = setup.install(manifest, tmp_path)
    model = tmp_path / "networks" / "toy.onnx"
    model.write_bytes(model.read_bytes()[:100])
    assert setup.install(manifest, tmp_path) == first
    (tmp_path / "networks" / "installed.json").write_text("{")
    assert setup.install(manifest, tmp_path) == first
    assert len(toys.asked) == 1


def test_a_changed_converter_or_entry_converts_anew_without_a_download(
    tmp_path: Path, toys: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    manifest = toy_manifest(toys.content)
    first = setup.install(manifest, tmp_path).networks["toy"]
    network = manifest.networks["toy"]
    picture = msgspec.structs.replace(network.input, offset=(1.0, 1.0, 1.0))
    changed = msgspec.structs.replace(manifest, networks={"toy": msgspec.structs.replace(network, input=picture)})
    second = setup.install(changed, tmp_path).networks["toy"]
    assert second.sha256 != first.sha256
    monkeypatch.setattr(setup, "_CONVERTER", ("tfjs_graph.py",))
    third = setup.install(changed, tmp_path).networks["toy"]
    assert third.recipe != second.recipe
    assert len(toys.asked) == 1


def test_a_file_of_the_package_with_another_hash_is_named(tmp_path: Path, toys: Server) -> None:
    document, shard = toy_graph().files()
    toys.content = archive_of({"package/toy.json": document, "package/toy.bin": shard[:-1] + b"x"})
    with pytest.raises(UserError, match=r"@toys/toy 1\.0\.0: package/toy\.bin does not have the sha256"):
        setup.install(toy_manifest(toys.content), tmp_path)
    assert not (tmp_path / "networks" / "installed.json").exists()


def test_a_package_without_the_file_is_named(tmp_path: Path, toys: Server) -> None:
    toys.content = archive_of({})
    with pytest.raises(UserError, match=r"does not contain package/toy\.bin"):
        setup.install(toy_manifest(toys.content), tmp_path)


def test_a_truncated_archive_never_reaches_the_data_folder(tmp_path: Path, toys: Server) -> None:
    manifest = toy_manifest(toys.content)
    toys.content = toys.content[: len(toys.content) // 2]
    with pytest.raises(UserError, match="sha512 hash pinned"):
        setup.install(manifest, tmp_path)
    # Even one whose hash was pinned in that state is one line.
    with pytest.raises(UserError, match="no readable archive"):
        setup.install(toy_manifest(toys.content), tmp_path)


def test_the_command_leaves_with_code_2_and_one_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "manifest.toml").write_text("version = 1\nsources = {}\nnetworks = {}\nnonsense = 1\n")
    monkeypatch.setattr(setup, "MANIFEST", tmp_path / "manifest.toml")
    monkeypatch.setattr("sys.argv", ["install", "--data", str(tmp_path)])
    with pytest.raises(SystemExit) as left:
        setup.main()
    assert left.value.code == 2
    assert re.fullmatch(r"kinebox: networks/manifest\.toml: .*nonsense.*\n", capsys.readouterr().err)


def test_a_folder_that_cannot_be_used_is_one_line_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "networks").write_text("a file where a folder should be")
    monkeypatch.setattr("sys.argv", ["install", "--data", str(tmp_path)])
    with pytest.raises(SystemExit) as left:
        setup.main()
    assert left.value.code == 2
    assert re.fullmatch(r"kinebox: networks: .*File exists.*; correct the rights of .*\n", capsys.readouterr().err)


def test_a_client_that_fails_is_named_with_its_own_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    client = tmp_path / "npm"
    client.write_text("#!/bin/sh\necho 'npm error code E404' >&2\nexit 1\n")
    client.chmod(0o755)
    monkeypatch.setattr(registry, "_npm", lambda: str(client))
    integrity = f"sha512-{base64.b64encode(hashlib.sha512(b'').digest()).decode()}"
    with pytest.raises(UserError, match=r"npm cannot find @toys/toy@1\.0\.0: npm error code E404"):
        registry.fetch_npm("@toys/toy", "1.0.0", integrity, tmp_path)
