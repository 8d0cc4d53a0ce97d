"""Version 2: the delay of a camera's shutter says in its name which way it counts."""

from typing import Any

from models.errors import UserError

CHANGE = (
    "`offset_ms` of a camera is now `shutter_delay_ms`: the name says that a camera which exposes later than the others has the "
    "larger number. The value stays as it is."
)
_OLD, _NEW = "offset_ms", "shutter_delay_ms"


def apply(site: dict[str, Any]) -> dict[str, Any]:
    """See `CHANGE`."""
    cameras = site.get("cameras")
    if not isinstance(cameras, list):
        return site
    return site | {
        "cameras": [_renamed(camera, number) if isinstance(camera, dict) else camera for number, camera in enumerate(cameras)]
    }


def _renamed(camera: dict[str, Any], number: int) -> dict[str, Any]:
    if _OLD in camera and _NEW in camera:
        raise UserError(f"cameras[{number}] has both {_OLD} and {_NEW}, which mean the same; delete {_OLD}")
    if camera.get("kind") == "simulated" and camera.get(_OLD, 0) != 0:
        # The schema refuses it, but by the new name, which is not in the file.
        raise UserError(f"cameras[{number}] is simulated, and its lesson says how late it exposes; delete {_OLD}")
    return {_NEW if key == _OLD else key: value for key, value in camera.items()}
