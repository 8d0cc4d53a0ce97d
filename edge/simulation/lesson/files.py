"""What is in the folder of a rendered lesson."""

from pathlib import Path
from typing import Final

FOLDER: Final = "simulated"
"""Of the data folder, where lessons are rendered unless told otherwise."""
SHIPPED: Final = "six_actions"
"""The folder therein of the lesson that comes with KineBox."""
PLAN_NAME: Final = "plan.toml"
RIG_NAME: Final = "rig.toml"
SITE_NAME: Final = "site.toml"
TRUTH_NAME: Final = "truth.npz"
ATTEMPTS_NAME: Final = "attempts.json"
VIDEO_SUFFIX: Final = ".mkv"
"""Of a film as it is in the repository."""


def film_path(folder: Path, camera: str) -> Path:
    """Where a camera's film is."""
    return folder / f"{camera}.avi"
