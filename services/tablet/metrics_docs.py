"""Writes the page about the metrics: `python -m services.tablet.metrics_docs > docs/metrics.md`."""

import sys

from models.messages.health import Health
from services.tablet.messages import Status
from services.tablet.metrics import RoomCollector
from services.tablet.room_state import RoomState

_OPENING = """\
# Metrics

The tablet server gives the state of the box as [Prometheus](https://prometheus.io) metrics at `GET /metrics` on the page's port.
What is not known at the moment (a camera that is lost has no rate, most virtual machines have no temperature) has no sample.
Nothing is measured for a scrape: every process says once a second how it is, and a scrape shows what was said last.

    scrape_configs:
      - job_name: kinebox
        static_configs:
          - targets: ["gymbox:8080"]

Worth an alarm: `kinebox_camera_state{state="lost"} == 1`, `kinebox_process_state{state="failed"} == 1`,
`kinebox_machine_trouble == 1`, `increase(kinebox_process_restarts_total[10m]) > 2`.

This page is written by `.venv/bin/python -m services.tablet.metrics_docs`; a test keeps it current.

| metric | type | labels | meaning |
| --- | --- | --- | --- |
"""
_SUFFIX = {"counter": "_total", "info": "_info"}


class _NoRoom:
    """A room of which nothing is known: its metrics have no samples, but names."""

    def status(self) -> Status:
        return RoomState("", (), 0.0, 0).status(0, 0)

    def healths(self) -> list[Health]:
        return []


def render() -> str:
    """The page."""
    rows = []
    for metric in RoomCollector(_NoRoom()).collect():
        labels = "version, room" if metric.type == "info" else ", ".join(getattr(metric, "_labelnames", ()))
        name = f"{metric.name}{_SUFFIX.get(metric.type, '')}"
        rows.append(f"| `{name}` | {'gauge' if metric.type == 'info' else metric.type} | {labels} | {metric.documentation} |\n")
    return _OPENING + "".join(rows)


if __name__ == "__main__":
    sys.stdout.write(render())
