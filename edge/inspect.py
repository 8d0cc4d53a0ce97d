"""What the edge needs, looked at closely for `kinebox doctor`: every network and every camera's file, byte by byte.

The doctor finds this by the entry point group `kinebox.inspections`. See `edge.check` for what is checked before every start.
"""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

from edge.cameras.shape import VideoShape, require_calibrated_size, require_equal_lengths
from edge.check import NETWORKS, check_video, film_of, lessons_of, require_provider
from edge.footage.index import INDEX_NAME, Index, remedy
from edge.perception.network_file import read_network_file
from edge.simulation.lesson.files import FOLDER as LESSONS
from edge.simulation.lesson.files import SHIPPED
from edge.simulation.lesson.lesson_rig import require_rig_of_lesson
from edge.simulation.lesson.plan import read_plan
from models.camera.rig import Rig
from models.config.site import CameraConfig, Site
from models.errors import UserError
from models.inspection import Inspected
from models.networks.installed import FILE_NAME, FOLDER, decode_installed


def inspect(site: Site | None, rig: Rig | None, data: Path, _file: Path | None) -> list[Inspected]:
    """Look at all networks, and at the files of a site's cameras.

    Args:
        site: the site file; None looks at the networks and the built-in footage.
        rig: calibration of its cameras; None compares no sizes.
        data: the data folder.
    """
    found = list(_networks(data))
    if site is None:
        found += _footage(data)
    else:
        videos: dict[str, tuple[VideoShape, float]] = {}
        found += [_camera(camera, rig, data, videos) for camera in site.cameras]
        found += _lengths(videos)
        found += _rigs(site, rig, data)
        found.append(_provider(site))
    return found


def _networks(data: Path) -> Iterator[Inspected]:
    try:
        listed = decode_installed((data / FOLDER / FILE_NAME).read_bytes(), data / FOLDER / FILE_NAME).networks
    except (OSError, UserError):
        # Every network fails alike; the first says why.
        yield _inspected("networks", "reading their list", lambda: read_network_file(NETWORKS[0], data))
        return
    for name in sorted({*NETWORKS, *listed}):
        look = partial(read_network_file, name, data)
        yield _inspected(f"network {name}", "comparing its hash with the installation's", look)


def _footage(data: Path) -> Iterator[Inspected]:
    """The films that the set-up has prepared, whichever site plays them."""
    for file in sorted([*data.glob(f"footage*/{INDEX_NAME}"), *data.glob(f"{LESSONS}/{SHIPPED}/{INDEX_NAME}")]):
        index = Index.read(file.parent)
        harmed = [INDEX_NAME] if index is None else index.damaged(file.parent)
        fault = f"{file.parent / harmed[0]} is missing or damaged; {remedy(file.parent)}" if harmed else ""
        yield Inspected(file.parent.name, "comparing the hashes of its files with the installation's", fault)


def _camera(camera: CameraConfig, rig: Rig | None, data: Path, videos: dict[str, tuple[VideoShape, float]]) -> Inspected:
    path = data / camera.path

    def look() -> None:
        path, rate_hz = film_of(camera, data)
        videos[camera.name] = (shape := check_video(path, camera.name), rate_hz)
        index = Index.read(path.parent)
        if index is not None and path.name in index.files and path.name in index.damaged(path.parent):
            raise UserError(f"camera '{camera.name}': {path} is damaged (not the hash installed); {remedy(path.parent)}")
        if rig is not None and camera.name in rig.names:
            require_calibrated_size(camera.name, shape, rig.cameras[rig.index(camera.name)].size_px)

    return _inspected(f"camera '{camera.name}'", f"reading {path} whole", look)


def _lengths(videos: dict[str, tuple[VideoShape, float]]) -> list[Inspected]:
    if len(videos) < 2:
        return []
    return [_inspected("length of the videos", "counting their pictures", lambda: require_equal_lengths(videos))]


def _rigs(site: Site, rig: Rig | None, data: Path) -> Iterator[Inspected]:
    if rig is None:
        return
    for folder, names in lessons_of(site, data):

        def look(folder: Path = folder, names: list[str] = names) -> None:
            require_rig_of_lesson(folder, read_plan(folder, names[0]), rig.select(names))

        yield _inspected(f"calibration of lesson {folder.name}", "comparing it with the cameras that filmed", look)


def _provider(site: Site) -> Inspected:
    return _inspected("execution provider", "looking for its package", lambda: require_provider(site))


def _inspected(what: str, known_by: str, look: Callable[[], object]) -> Inspected:
    try:
        look()
    except UserError as error:
        return Inspected(what, known_by, str(error))
    except OSError as error:
        return Inspected(what, known_by, f"{what} cannot be read ({error}); correct its rights or its disk")
    return Inspected(what, known_by)
