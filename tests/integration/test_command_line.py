"""The command `kinebox` as people type it."""

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import entry_points
from pathlib import Path

import msgspec
import pytest

from models.config.site import SITE_VERSION, decode_site
from models.process import REPLAY
from services.cli.parts import PROCESSES
from tests.integration.box import ROOT, fake_parts, write_site
from tests.integration.waiting import until
from tests.ports import free_port

pytestmark = pytest.mark.slow


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return write_site(tmp_path, free_port(), free_port())


def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "services.cli.main", *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=60, check=False)


@contextmanager
def running(site: Path, *words: str) -> "Iterator[subprocess.Popen[str]]":
    data = site.parent / "data"
    data.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "services.cli.main", "process", *words, "--site", str(site), "--data", str(data)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=fake_parts(site.parent), stdout=pipe, stderr=pipe, text=True, cwd=ROOT) as process:
        try:
            yield process
        finally:
            process.kill()
            process.wait()


@pytest.mark.parametrize("word", ["version", "--version"])
def test_the_command_is_installed_under_its_name(word: str) -> None:
    result = subprocess.run([Path(sys.executable).parent / "kinebox", word], capture_output=True, text=True, check=True)
    assert result.stdout.strip().count(".") == 2


def test_a_good_site_file_is_said_to_be_good(site: Path) -> None:
    result = kinebox("config", "check", str(site))
    assert result.returncode == 0
    assert result.stdout == f"{site} is good: 'Test gym' with 2 calibrated cameras (a, b)\n"


def test_a_site_file_is_shown_with_its_defaults(site: Path) -> None:
    result = kinebox("config", "show", str(site))
    assert msgspec.toml.decode(result.stdout)["fusion"] == {"preset": "default", "live_hz": 30.0}
    assert decode_site(result.stdout.encode(), "shown") == decode_site(site.read_bytes(), site)


def test_a_bad_site_file_is_one_line_and_code_2(site: Path) -> None:
    site.write_text(site.read_text() + "[inferense]\n")
    result = kinebox("config", "check", str(site))
    assert result.returncode == 2
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert "inferense: there is no such key" in result.stderr


def test_an_old_site_file_is_refused_with_the_command_that_mends_it(site: Path) -> None:
    old = site.read_text().replace(f"version = {SITE_VERSION}", "version = 1  # of last year")
    site.write_text(old)
    refused = kinebox("config", "check", str(site))
    assert refused.returncode == 2
    assert f"run 'kinebox config migrate {site}'" in refused.stderr
    tried = kinebox("config", "migrate", "--dry-run", str(site))
    assert f"-version = 1  # of last year\n+version = {SITE_VERSION}  # of last year\n" in tried.stdout
    assert site.read_text() == old
    done = kinebox("config", "migrate", str(site))
    assert done.stdout.startswith(tried.stdout)
    (backup,) = site.parent.glob("site.toml.bak-1-*")
    assert done.stdout.endswith(f"{site} is migrated; what it was is in {backup}\n")
    assert backup.read_text() == old
    assert kinebox("config", "check", str(site)).returncode == 0
    assert "nothing to do" in kinebox("config", "migrate", str(site)).stdout


@pytest.mark.parametrize("words", [("config", "check"), ("config", "show"), ("config", "migrate"), ("run", "--site")], ids=" ".join)
def test_a_folder_in_the_place_of_a_site_file_is_one_line_that_says_what_to_give(site: Path, words: tuple[str, ...]) -> None:
    result = kinebox(*words, str(site.parent))
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == f"kinebox: site file {site.parent} is a folder; name the file in it\n"


@pytest.mark.parametrize("named", ["../ours", "/srv/ours"])
def test_a_school_s_folder_that_the_box_would_refuse_is_refused_before(site: Path, named: str) -> None:
    site.write_text(f'{site.read_text()}[evaluation]\nteaching = "{named}"\n')
    result = kinebox("config", "check", str(site))
    allowed = "allowed is a folder in the data folder, relative to it; correct it"
    assert (result.returncode, result.stderr) == (
        2,
        f'kinebox: site file {site}: [evaluation] teaching: found "{named}", but {allowed}\n',
    )


def test_the_help_names_the_processes_that_there_are() -> None:
    told = " ".join(kinebox("process", "--help").stdout.split())
    *others, last = sorted(entry_points(group=PROCESSES).names - {REPLAY})
    assert f"The process: {', '.join(others)} or {last}." in told


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("cook",), "no process is called 'cook' (there are: edge, evaluation, fusion, recorder, tablet)"),
        (("edge", "--camera", "zzz"), "camera 'zzz' is not in "),
        (("edge",), "process 'edge' serves one camera; name it with --camera (a, b)"),
        (("fusion", "--camera", "a"), "process 'fusion' serves no camera of its own; leave out --camera"),
        (("tablet", "--camera", "a"), "process 'tablet' serves no camera of its own; leave out --camera"),
    ],
)
def test_a_process_that_cannot_be_is_one_line_and_code_2(site: Path, words: tuple[str, ...], line: str) -> None:
    with running(site, *words) as process:
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert errors.count("\n") == 1
    assert errors.startswith(f"kinebox: {line}")


def test_the_router_on_a_port_that_is_taken_is_one_line_and_code_2(site: Path) -> None:
    with running(site, "fusion") as first:
        until((site.parent / "data" / "starts" / "fusion").exists, "the first router")
        with running(site, "fusion") as second:
            _, errors = second.communicate(timeout=60)
        first.terminate()
        assert first.wait(60.0) == 0
    assert second.returncode == 2
    assert errors.count("\n") == 1
    assert "is in use already; stop the other KineBox or change bus.endpoint" in errors


def test_a_process_on_its_own_finds_the_compiled_kernels_as_under_the_supervisor(site: Path) -> None:
    with running(site, "fusion") as process:
        start = site.parent / "data" / "starts" / "fusion"
        until(lambda: start.exists() and start.read_text().endswith("\n"), "the process")
        process.terminate()
    assert start.read_text().split()[2] == str(site.parent / "data" / "kernels")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_a_process_ends_cleanly_when_it_is_told_to(site: Path, number: signal.Signals) -> None:
    with running(site, "fusion") as process:
        until((site.parent / "data" / "starts" / "fusion").exists, "the process")
        process.send_signal(number)
        _, errors = process.communicate(timeout=60)
    assert process.returncode == 0
    assert errors == ""


def test_a_process_that_waits_for_its_router_ends_when_it_is_told_to(site: Path) -> None:
    with running(site, "edge", "--camera", "a") as process:
        # It has its handlers before anything else; there is nothing to see of its waiting.
        until(lambda: _catches(process.pid, signal.SIGTERM), "the process to listen to signals")
        process.terminate()
        assert process.wait(60.0) == 0


def _catches(pid: int, number: signal.Signals) -> bool:
    line = next(line for line in Path(f"/proc/{pid}/status").read_text().splitlines() if line.startswith("SigCgt:"))
    return bool(int(line.split()[1], 16) >> (number - 1) & 1)
