"""The site file with which a rendered lesson is played."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
import tomlkit

from models.config.site import SITE_VERSION, CameraConfig, Site


def site_of(title: str, cameras: Sequence[str], folder: Path | str, calibration: str) -> bytes:
    """A site of simulated cameras, as TOML.

    Args:
        title: shown at the top of the page.
        cameras: their names.
        folder: the lesson's, relative to the data folder or absolute.
        calibration: the calibration file, relative to the site file.
    """
    configs = [CameraConfig(name=name, kind="simulated", path=str(folder)) for name in cameras]
    site = Site(version=SITE_VERSION, name=title, calibration=calibration, cameras=configs)
    head = {key: getattr(site, key) for key in ("version", "name", "calibration")}
    tables = [{key: msgspec.to_builtins(config)[key] for key in ("name", "kind", "path")} for config in configs]
    return tomlkit.dumps(head | {"cameras": tables}).encode()
