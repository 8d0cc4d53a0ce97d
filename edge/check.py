"""What the edge needs, checked before anything is started: the cameras' files and the networks.

`kinebox run` finds this by the entry point group `kinebox.checks`. It must be quick, since every start waits for it, so neither the
decoder of videos nor the runtime of networks is imported for files that the set-up has described.
"""

from importlib.util import find_spec
from pathlib import Path

from edge.footage.index import INDEX_NAME, Index
from edge.perception.network_file import read_network_file
from models.camera.rig import Rig
from models.config.site import Site
from models.errors import UserError

NETWORKS = ("movenet-thunder", "movenet-lightning", "nanodet")
"""Whatever the governor may ask for, and the detector."""


def check(site: Site, _rig: Rig, data: Path) -> None:
    """Check the files of every camera, and every network that may be used.

    Args:
        site: the site file.
        data: the data folder.

    Raises:
        UserError: the first that is missing, truncated or damaged.
    """
    for camera in site.cameras:
        check_video(data / camera.path, camera.name)
    if site.inference.provider == "openvino" and find_spec("openvino") is None:
        raise UserError(
            'inference.provider = "openvino", but OpenVINO is not installed; install the extra of that name or set it to "cpu"'
        )
    for name in NETWORKS:
        read_network_file(name, data)


def check_video(path: Path, camera: str) -> None:
    """Check a video file: against the set-up's index if it is described there, else by reading it.

    Raises:
        UserError: it is missing, truncated or no video that can be played.
    """
    index = Index.read(path.parent)
    if index is not None and path.name in index.files and path.is_file():
        size, wanted = path.stat().st_size, index.files[path.name][0]
        if size == wanted:
            return
        remedy = f"delete {path.parent / INDEX_NAME} and run `make footage`"
        raise UserError(f"camera '{camera}': {path} has {size} bytes instead of {wanted}; {remedy}")
    from edge.cameras.video import load_video  # noqa: PLC0415 - its decoder takes long to import

    load_video(path, camera)
