"""What the supervisor of a real box says of the machine and of the processes that it had to start again."""

import os
import signal
from pathlib import Path

import pytest

from services.support.version import kinebox_version
from tests.integration.box import Box, HealthWatch

pytestmark = pytest.mark.slow


def test_the_supervisor_measures_the_machine_and_tells_its_version(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            said = watch.wait_for("supervisor", "ok")
        assert said.machine is not None
        disk = os.statvfs(box.data)
        assert said.machine.disk_free_mib == pytest.approx(disk.f_bavail * disk.f_frsize / 2**20, rel=0.1)
        assert 0 < said.machine.granted_cores <= (os.cpu_count() or 1)
        assert said.machine.memory_free_mib > 0
        assert said.supervisor is not None
        assert said.supervisor.version == kinebox_version()
        assert said.supervisor.restarts == ()
        assert {said.supervisor.started_ns} == box.start_times_ns()


def test_a_restart_is_counted_with_what_became_of_the_process(tmp_path: Path) -> None:
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            watch.wait_for("edge-a", "ok")
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            box.wait_restarted("edge-a")
            back = watch.wait_for("edge-a", "ok", box.pid("edge-a"))
            said = watch.wait_for("supervisor", "ok", after_ns=back.t_ns)
        assert said.supervisor is not None
        (restarts,) = said.supervisor.restarts
        assert (restarts.process, restarts.count, restarts.reason, restarts.given_up) == ("edge-a", 1, "was ended by SIGKILL", "")
        assert restarts.last_ns < back.t_ns


def test_a_process_that_was_given_up_stays_known_with_its_reason(tmp_path: Path) -> None:
    with Box(tmp_path, {"edge-b": "crash"}, "[supervisor]\nmax_restarts = 1\n") as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            said = watch.wait_for("supervisor", "failed")
        assert said.supervisor is not None
        (restarts,) = said.supervisor.restarts
        assert (restarts.process, restarts.count) == ("edge-b", 1)
        assert restarts.given_up.startswith("ended 2 times within 60 s")


def test_a_log_that_cannot_be_written_is_said_until_it_can(tmp_path: Path) -> None:
    logs = tmp_path / "data" / "logs"
    logs.parent.mkdir()
    logs.write_text("a file where the folder should be")
    with Box(tmp_path) as box:
        box.wait_started()
        with HealthWatch(box) as watch:
            said = watch.wait_for("supervisor", "degraded")
            assert [trouble.code for trouble in said.troubles] == ["log_not_kept"]
            assert said.reason.startswith(f"nothing is kept in {logs / 'kinebox.log'}: File exists; correct the folder")
            logs.unlink()
            watch.wait_for("supervisor", "ok")
