"""`kinebox run` while the supervisor may open nothing more: one camera stays away, the box does not end."""

import os
import resource
import signal
from pathlib import Path

import pytest

from tests.integration.box import Box, HealthWatch
from tests.integration.waiting import until

pytestmark = pytest.mark.slow


def test_a_camera_that_cannot_be_started_again_waits_and_the_box_goes_on(tmp_path: Path) -> None:
    with Box(tmp_path, more="[supervisor]\nmax_restarts = 100\nspares = false\n") as box:
        box.wait_started()
        box.wait_page()
        with HealthWatch(box) as watch:
            for name in ("edge-a", "edge-b", "supervisor"):
                watch.wait_for(name, "ok")
            before = resource.prlimit(box.process.pid, resource.RLIMIT_NOFILE)
            # Descriptors above this are in use already, so that next to nothing can be opened any more.
            resource.prlimit(box.process.pid, resource.RLIMIT_NOFILE, (8, before[1]))
            os.kill(box.pid("edge-a"), signal.SIGKILL)
            until(lambda: "edge-a could not be started (Too many open files)" in box.errors.read_text(), "the supervisor to say it")
            watch.wait_for("edge-b", "ok", box.pid("edge-b"), watch.wait_for("edge-b", "ok").t_ns + 2_000_000_000)
            assert box.process.poll() is None, box.errors.read_text()
            resource.prlimit(box.process.pid, resource.RLIMIT_NOFILE, before)
            box.wait_restarted("edge-a")
            watch.wait_for("edge-a", "ok", box.pid("edge-a"))
            watch.wait_for("supervisor", "ok", after_ns=watch.wait_for("edge-a", "ok").t_ns)
        assert [len(box.pids(name)) for name in ("fusion", "edge-b", "tablet", "recorder")] == [1, 1, 1, 1]
        assert box.end() == 0
        assert "Traceback" not in box.errors.read_text()
