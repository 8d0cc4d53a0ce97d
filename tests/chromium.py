"""The browser that the page is looked at in: the one that `KINEBOX_CHROMIUM` names, or the machine's own."""

import os
import shutil

NONE = "no Chromium: install it (Debian: apt-get install chromium-headless-shell) or name one in KINEBOX_CHROMIUM"
ARGUMENTS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # Test machines have no GPU. Asked for one in vain, the browser draws WebGL in software and puts pages together without it;
    # asked for software at once, it would do both by WebGL's software, for three times the CPU.
    "--use-angle=gl",
    "--enable-unsafe-swiftshader",
)
_BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")
"""Of Debian's two, the one that has no window of its own comes first: it draws the same pages for less CPU."""


def chromium() -> str | None:
    """Its path; None where there is none."""
    return os.environ.get("KINEBOX_CHROMIUM") or next(filter(None, map(shutil.which, _BROWSERS)), None)
