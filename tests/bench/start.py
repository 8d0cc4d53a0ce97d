"""Time from `kinebox run` to the figure on the page, in a browser on the same machine, everything being installed.

The browser waits already, as a tablet in the gym does; it draws in software here, on the cores that the box uses.
"""

import argparse
import socket
import statistics
import subprocess
import sys
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

from models.config.site import decode_site
from tests.bench.report import Report
from tests.chromium import ARGUMENTS, NONE, chromium

BARS = {"start_s.median": ("<=", 5.0)}
SHOWN = """() => { const d = document.querySelector('.page')?.dataset;
    return d && d.phase === 'live' && Number(d.figures) >= 1 && Number(d.coloured) > 0; }"""
LONGEST_S = 60.0


def start_once(page: Page, site: Path, data: Path, port: int) -> float:
    """Seconds from the command to a coloured figure."""
    log = (data / "bench" / "start.log").open("wb")
    began = time.monotonic()
    command = [sys.executable, "-m", "services.cli.main", "run", "--site", str(site), "--data", str(data)]
    with log, subprocess.Popen(command, stdout=log, stderr=log) as box:
        try:
            while not _listens(port):
                if box.poll() is not None or time.monotonic() - began > LONGEST_S:
                    raise SystemExit("the box did not start; see bench/start.log in the data folder")
                time.sleep(0.02)
            page.goto(f"http://127.0.0.1:{port}/")
            page.wait_for_function(SHOWN, polling=50, timeout=LONGEST_S * 1e3)
            return time.monotonic() - began
        finally:
            page.goto("about:blank")
            box.terminate()


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def main() -> int:
    """Measure, print, write; returns the exit code, 1 if a bar was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--site", type=Path, required=True)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--times", type=int, default=7)
    arguments = parser.parse_args()
    path = chromium()
    if path is None:
        raise SystemExit(NONE)
    (arguments.data / "bench").mkdir(parents=True, exist_ok=True)
    port = decode_site(arguments.site.read_bytes(), arguments.site).tablet.port
    report = Report("bench-start")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        page = browser.new_page(viewport={"width": 1280, "height": 800})
        taken = []
        for _ in range(arguments.times):
            taken.append(start_once(page, arguments.site, arguments.data, port))
            time.sleep(3)  # the box that ends shall not slow the one that starts
        browser.close()
    report.add({"start_s.median": statistics.median(taken), "start_s.min": min(taken), "start_s.max": max(taken)})
    return report.conclude(BARS, arguments.data)


if __name__ == "__main__":
    sys.exit(main())
