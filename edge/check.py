"""What the edge needs, checked before anything is started: the cameras' files and the networks.

`kinebox run` finds this by the entry point group `kinebox.checks`. It must be quick, since every start waits for it, so neither the
decoder of videos nor the runtime of networks is imported for files that the set-up has described.
"""

from importlib.util import find_spec
from pathlib import Path

from edge.cameras.shape import VideoShape, read_avi_shape, require_calibrated_size, require_equal_lengths
from edge.footage.index import Index, remedy
from edge.perception.network_file import read_network_file
from edge.simulation.lesson.files import film_path
from edge.simulation.lesson.lesson_rig import require_rig_of_lesson
from edge.simulation.lesson.plan import read_plan
from models.camera.rig import Rig
from models.config.site import CameraConfig, Site
from models.errors import UserError

NETWORKS = ("movenet-thunder", "movenet-lightning", "nanodet")
"""Whatever the governor may ask for, and the detector."""


def check(site: Site, rig: Rig, data: Path) -> None:
    """Check the files of every camera, whether they fit one another and the calibration, and every network that may be used.

    Args:
        site: the site file.
        rig: calibration of the site's cameras.
        data: the data folder.

    Raises:
        UserError: the first that is missing, truncated, damaged or does not fit.
    """
    videos = {}
    for camera in site.cameras:
        path, rate_hz = film_of(camera, data)
        shape = check_video(path, camera.name)
        for other in swapped_films(camera, data):
            require_calibrated_size(camera.name, check_video(other, camera.name), shape.size_px)
        require_calibrated_size(camera.name, shape, rig.cameras[rig.index(camera.name)].size_px)
        videos[camera.name] = (shape, rate_hz)
    require_equal_lengths(videos)
    for folder, names in lessons_of(site, data):
        require_rig_of_lesson(folder, read_plan(folder, names[0]), rig.select(names))
    require_provider(site)
    for name in NETWORKS:
        read_network_file(name, data)


def require_provider(site: Site) -> None:
    """The package of the site's execution provider must be there; UserError with the command that installs it."""
    if site.inference.provider == "openvino" and find_spec("openvino") is None:
        raise UserError(
            'inference.provider = "openvino", but OpenVINO is not installed; install it with '
            "`.venv/bin/pip install 'openvino>=2026.4'` or set the provider to \"cpu\""
        )


def lessons_of(site: Site, data: Path) -> list[tuple[Path, list[str]]]:
    """The folders of simulated lessons that a site plays, and its cameras that play each."""
    cameras = [camera for camera in site.cameras if camera.kind == "simulated"]
    paths = sorted({camera.path for camera in cameras})
    return [(data / path, [camera.name for camera in cameras if camera.path == path]) for path in paths]


def film_of(camera: CameraConfig, data: Path) -> tuple[Path, float]:
    """The film that a camera plays, and its rate in Hz.

    Raises:
        UserError: it is of a lesson that is not there or cannot be read, or that has no such camera.
    """
    path = data / camera.path
    if camera.kind == "simulated":
        rate_hz = read_plan(path, camera.name).rate_hz
        return _film_of_lesson(path, camera.name, camera.name), rate_hz
    return path, camera.rate_hz


def swapped_films(camera: CameraConfig, data: Path) -> list[Path]:
    """The films of other cameras that a simulated camera plays, too, since names are swapped in its lesson.

    Raises:
        UserError: the lesson is not there or cannot be read, or one of its films is missing.
    """
    if camera.kind != "simulated":
        return []
    folder = data / camera.path
    names = {name for swap in read_plan(folder, camera.name).swaps for name in swap.cameras}
    return [_film_of_lesson(folder, name, camera.name) for name in sorted(names - {camera.name})]


def _film_of_lesson(folder: Path, name: str, camera: str) -> Path:
    path = film_path(folder, name)
    if not path.is_file():
        there = ", ".join(sorted(film.stem for film in folder.glob(film_path(folder, "*").name))) or "no camera"
        raise UserError(
            f"camera '{camera}': {path} is missing; the lesson has films of {there}: correct the camera's name or `path` in the "
            "site file, or render the lesson again with `kinebox simulate`"
        )
    return path


def check_video(path: Path, camera: str) -> VideoShape:
    """Check a video file: against the set-up's index if it is described there, else by reading it.

    Raises:
        UserError: it is missing, truncated, may not be read or is no video that can be played.
    """
    try:
        shape = _described(path, camera)
    except OSError as error:
        raise UserError(f"camera '{camera}': {path} cannot be read ({error.strerror}); correct `path` or its rights") from error
    if shape is not None:
        return shape
    from edge.cameras.video import load_video  # noqa: PLC0415 - its decoder takes long to import

    return load_video(path, camera).shape(path)


def _described(path: Path, camera: str) -> VideoShape | None:
    """The shape of a file that the set-up described; None if it did not, or not as an AVI file."""
    index = Index.read(path.parent)
    if index is None or path.name not in index.files or not path.is_file():
        return None
    size, wanted = path.stat().st_size, index.files[path.name][0]
    if size != wanted:
        raise UserError(f"camera '{camera}': {path} has {size} bytes instead of {wanted}; {remedy(path.parent)}")
    return read_avi_shape(path)
