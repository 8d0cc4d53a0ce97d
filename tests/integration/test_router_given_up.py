"""What the page of a real box says when fusion, through which everybody is heard, is killed until it is given up."""

import json
import os
import signal
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import connect

from tests.integration.box import Box, HealthWatch
from tests.integration.waiting import until

pytestmark = pytest.mark.slow

MORE = "[supervisor]\nmax_restarts = 2\nspares = false\n"


def told(box: Box) -> dict[str, Any]:
    """The next state of the room on a page that was just opened."""
    with connect(f"ws://127.0.0.1:{box.page_port}/ws", compression=None, proxy=None) as socket:
        state: dict[str, Any] = json.loads(socket.recv(10.0))
        return state


def metrics(box: Box) -> str:
    with urllib.request.urlopen(f"http://127.0.0.1:{box.page_port}/metrics", timeout=10.0) as answer:
        text: str = answer.read().decode()
        return text


def test_the_page_and_the_metrics_say_that_fusion_is_given_up_and_all_others_are_heard(tmp_path: Path) -> None:
    with Box(tmp_path, more=MORE, tablet="services.tablet.process:main") as box:
        box.wait_page()
        for kill in range(3):
            box.wait_restarted("fusion", kill + 1)
            if kill == 0:
                with HealthWatch(box) as watch:
                    watch.wait_for("edge-a", "ok")
            os.kill(box.pid("fusion"), signal.SIGKILL)
        states: dict[str, str] = {}

        def is_told() -> bool:
            states.update({process["name"]: process["state"] for process in told(box)["processes"]})
            others = ("edge-a", "edge-b", "recorder", "tablet")
            return states.get("fusion") == states.get("supervisor") == "failed" and all(states.get(name) == "ok" for name in others)

        until(is_told, "the page to know who is given up and who works")
        # A camera is heard again a moment after its process is said to work.
        until(
            lambda: {camera["reason"] for camera in told(box)["cameras"]} <= {"starting", "never_seen"},
            "the page to miss no camera: their processes are all there",
        )
        room = told(box)
        fusion = next(process for process in room["processes"] if process["name"] == "fusion")
        assert fusion["reason"].startswith("ended 3 times within 60 s")
        assert 'kinebox_process_state{process="fusion",state="failed"} 1.0' in metrics(box)
        with HealthWatch(box) as watch:
            assert "fusion is given up" in watch.wait_for("supervisor", "failed").reason
            watch.wait_for("edge-b", "ok")
        # Whoever hangs is still missed, although it is not fusion through which he is heard.
        os.kill(box.pid("edge-a"), signal.SIGSTOP)
        box.wait_restarted("edge-a")
        assert box.end() == 0
        assert box.running() == []
