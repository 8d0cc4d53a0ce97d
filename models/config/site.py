"""Schema of the site file. Unknown keys are refused, every field has a description and bounds."""

import shlex
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from models.config.endpoint import split_endpoint
from models.config.host import require_host
from models.config.path import require_path
from models.config.wrong_key import ALLOWED, wrong_key
from models.errors import UserError

SITE_VERSION = 2
"""Raised together with a new step in `models.config.migrations`."""

MAX_LATE_S = 5.0
"""Pictures that are late wait in memory."""

SCHOOL_FOLDER = "school"
"""In the data folder: what a school teaches of its own, if the site file names no other folder."""

_LONGEST_S = 1e9
"""Thirty years: what counts nanoseconds can count it."""
_OFTENEST_S = 0.004
"""Between two pictures of the fastest camera."""

Name = Annotated[
    str,
    Meta(
        pattern=r"^[a-z0-9][a-z0-9_-]{0,31}\Z",
        description="lower-case letters, digits, - and _",
        extra={ALLOWED: "a name of 1 to 32 lower-case letters, digits, - and _, which begins with a letter or digit"},
    ),
]


class Section(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of every table of the site file."""


class CameraConfig(Section, frozen=True):
    """One camera of the room."""

    name: Annotated[Name, Meta(description="the camera's name, as in the calibration")]
    kind: Annotated[
        Literal["video", "simulated"],
        Meta(description="video: a file played in real time; simulated: a camera of a lesson that `kinebox simulate` rendered"),
    ]
    path: Annotated[
        str, Meta(min_length=1, description="the file, or the lesson's folder, from the root or relative to the data folder")
    ]
    rate_hz: Annotated[
        float, Meta(gt=0, le=240, description="frames a second of a file; every frame is shown. A lesson has its own")
    ] = 30.0
    shutter_delay_ms: Annotated[
        float, Meta(ge=-1000, le=1000, description="how much later than the others this camera exposes. A lesson has its own")
    ] = 0.0

    def __post_init__(self) -> None:
        if self.kind == "simulated":
            given = [f"`{key}`" for key, default in (("rate_hz", 30.0), ("shutter_delay_ms", 0.0)) if getattr(self, key) != default]
            if given:
                raise ValueError(f"a simulated camera has its rate and delay from its lesson; leave out {' and '.join(given)}")


class BusConfig(Section, frozen=True):
    """How the processes of the box talk to one another (Zenoh; the fusion process is the router)."""

    endpoint: Annotated[
        str,
        Meta(
            pattern=r"^tcp/[^/]+:[0-9]{1,5}\Z",
            description="where the router listens",
            extra={ALLOWED: '"tcp/ADDRESS:PORT", as "tcp/127.0.0.1:7447"'},
        ),
    ] = "tcp/127.0.0.1:7447"


class TabletConfig(Section, frozen=True):
    """The page that the teacher opens."""

    host: Annotated[str, Meta(description="address to listen on; 0.0.0.0 is every network of the box")] = "0.0.0.0"  # noqa: S104 - the tablet is another machine
    port: Annotated[int, Meta(ge=1, le=65535, description="port of the page")] = 8080


class InferenceConfig(Section, frozen=True):
    """What the networks may use."""

    provider: Annotated[Literal["cpu", "openvino"], Meta(description="execution provider of the networks")] = "cpu"
    max_rate_hz: Annotated[
        Literal[30, 15, 10, 5], Meta(description="pose inferences a camera and second that the governor never exceeds")
    ] = 30
    cpu_target: Annotated[float, Meta(gt=0.1, le=0.95, description="share of the CPU that the governor fills")] = 0.85


class FusionConfig(Section, frozen=True):
    """Reconstruction."""

    preset: Annotated[Literal["default", "paper"], Meta(description="default: what measured best; paper: as printed")] = "default"
    live_hz: Annotated[float, Meta(ge=30, le=60, description="fused poses a second")] = 30.0


class EvaluationConfig(Section, frozen=True):
    """What is said of attempts."""

    activity: Annotated[
        str,
        Meta(
            pattern=r"^[a-z][a-z0-9_]{0,39}\Z",
            description="what pupils do when the box starts, until a tablet says otherwise: an action's name, such as "
            "`basketball_shot`; any: whichever it is",
            extra={ALLOWED: 'an action\'s name, as "basketball_shot", or "any"'},
        ),
    ] = "any"
    language: Annotated[
        Literal["en", "zh", "de", "es"],
        Meta(description="of the page, for a tablet that speaks none of these languages, and of reports"),
    ] = "en"
    teaching: Annotated[
        str,
        Meta(
            description="a folder of this school's own, relative to the data folder: what is in its `actions` and `standards` "
            "counts in the place of what KineBox brings; empty: `school`, if there is such a folder"
        ),
    ] = ""


class LessonsConfig(Section, frozen=True):
    """Recorded lessons: what the cameras saw as keypoints, never pictures; 2 to 3.5 MB a minute with four cameras."""

    folder: Annotated[str, Meta(min_length=1, description="where they are kept, relative to the data folder")] = "lessons"
    automatic: Annotated[bool, Meta(description="record whenever the box runs, without being asked")] = False
    least_free_mb: Annotated[
        int, Meta(ge=10, le=1_000_000, description="recording ends when the disk has no more than this left, in MB")
    ] = 500


class LogsConfig(Section, frozen=True):
    """The log files, `logs` in the data folder. At most `max_files` times `max_file_mb` is kept; the oldest goes first."""

    max_file_mb: Annotated[float, Meta(ge=0.1, le=1000, description="size in MB at which a new file is begun")] = 8.0
    max_files: Annotated[int, Meta(ge=2, le=1000, description="files that are kept, the present one included")] = 8


class SupervisorConfig(Section, frozen=True):
    """When a part that keeps failing is given up. One that worked, and now says what must be mended, waits until it is."""

    max_restarts: Annotated[int, Meta(ge=0, le=100, description="restarts of one process within the window")] = 5
    window_s: Annotated[float, Meta(gt=0, le=3600, description="length of the window")] = 60.0
    spares: Annotated[
        bool, Meta(description="keep a second fusion and page server ready to take over at once; costs their memory, no CPU")
    ] = True


class FaultConfig(Section, frozen=True):
    """A fault of a camera on demand, for drills and rehearsals: how a box copes can be seen before it must. A lesson has none."""

    camera: Annotated[Name, Meta(description="the camera that falls ill")]
    kind: Annotated[
        Literal["end", "stall", "repeat", "jump", "drift", "drop", "late", "dark"],
        Meta(
            description="end: it is gone and cannot be opened; stall: it shows nothing; repeat: it shows one picture again and "
            "again; jump: its clock is wrong by `by_s`; drift: its clock goes wrong by `ppm`; drop: a `share` of its pictures is "
            "lost; late: a `share` of its pictures arrives `by_s` after their time; dark: its lens is covered"
        ),
    ]
    at_s: Annotated[float, Meta(ge=0, le=_LONGEST_S, description="seconds after the start of the box")]
    for_s: Annotated[float, Meta(gt=0, le=_LONGEST_S, description="how long it lasts")]
    every_s: Annotated[
        float, Meta(ge=0, le=_LONGEST_S, description="it comes again so many seconds after it began; 0: it comes once")
    ] = 0.0
    by_s: Annotated[
        float, Meta(ge=-1e6, le=1e6, description="how far a clock jumps, forwards positive, or how late pictures are")
    ] = 5.0
    ppm: Annotated[float, Meta(ge=-10_000, le=10_000, description="millionths by which a clock that drifts is too fast")] = 50.0
    share: Annotated[
        float, Meta(gt=0, le=1, description="of the pictures that are lost or late, which ones by lot, the same in every run")
    ] = 1.0

    def __post_init__(self) -> None:
        if self.kind == "late" and not 0 < self.by_s <= MAX_LATE_S:
            raise ValueError(f"a fault of kind late needs by_s of more than 0 and at most {MAX_LATE_S:g}")
        if 0 < self.every_s < _OFTENEST_S:
            raise ValueError(f"a fault needs every_s of at least {_OFTENEST_S:g}, or 0 to come once")


class Site(Section, frozen=True):
    """A whole site file."""

    version: Annotated[int, Meta(description="version of this file's schema")]
    name: Annotated[str, Meta(min_length=1, max_length=80, description="shown at the top of the page")]
    calibration: Annotated[str, Meta(min_length=1, description="the calibration file, relative to the site file")]
    cameras: Annotated[list[CameraConfig], Meta(min_length=2, max_length=8, description="the cameras in use")]
    bus: BusConfig = BusConfig()
    tablet: TabletConfig = TabletConfig()
    inference: InferenceConfig = InferenceConfig()
    fusion: FusionConfig = FusionConfig()
    evaluation: EvaluationConfig = EvaluationConfig()
    supervisor: SupervisorConfig = SupervisorConfig()
    lessons: LessonsConfig = LessonsConfig()
    logs: LogsConfig = LogsConfig()
    faults: Annotated[list[FaultConfig], Meta(max_length=64, description="faults on demand")] = []


class _Versioned(msgspec.Struct):
    version: Annotated[int, Meta(ge=1)]


def site_version(data: bytes, origin: Path | str) -> int:
    """The version of a site file, at most this KineBox's own.

    Raises:
        UserError: the file is not TOML or has no version, or a newer one.
    """
    try:
        version = msgspec.toml.decode(data, type=_Versioned).version
    except msgspec.ValidationError as error:
        raise UserError(f"site file {origin}: {_refused(data, _Versioned)}") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise UserError(f"site file {origin}: {error}; {_what_to_do(error)}") from error
    except ValueError as error:  # Python reads no whole number of more than 4300 digits.
        raise UserError(f"site file {origin}: a number in it has thousands of digits; correct it") from error
    if version > SITE_VERSION:
        raise UserError(
            f"site file {origin}: version {version} is for a newer KineBox than this one, which reads {SITE_VERSION} "
            f"(see 'kinebox version'); update KineBox, or put back the file's backup ({Path(origin).name}.bak-{SITE_VERSION}-...)"
        )
    return version


def _what_to_do(error: Exception) -> str:
    if any(word in str(error) for word in ("character '\\n'", "Unterminated string", 'Expected "\'"')):
        return "a quote is not closed in that line, or before it; close it"
    return "it is no TOML there; look for a quote, bracket, value or equals sign that is missing, and correct it"


def _refused(data: bytes, schema: type[msgspec.Struct]) -> str:
    return wrong_key(tomllib.loads(data.decode()), schema)


def decode_site(data: bytes, origin: Path | str) -> Site:
    """Read a site file.

    Raises:
        UserError: the file is not TOML, is of another version, has an unknown key or a value out of bounds; the line names the key.
    """
    version = site_version(data, origin)
    if version < SITE_VERSION:
        raise UserError(
            f"site file {origin}: version {version} is from an older KineBox; "
            f"run 'kinebox config migrate {shlex.quote(str(origin))}', which keeps a backup"
        )
    try:
        site: Site = msgspec.toml.decode(data, type=Site)
    except msgspec.ValidationError as error:
        raise UserError(f"site file {origin}: {_refused(data, Site)}") from error
    try:
        for key, path in _paths(site):
            require_path(path, key)
        require_host(site.tablet.host, "tablet.host")
        require_host(split_endpoint(site.bus.endpoint)[0], "bus.endpoint")
    except UserError as error:
        raise UserError(f"site file {origin}: {error}") from error
    names = [camera.name for camera in site.cameras]
    doubled = sorted({name for name in names if names.count(name) > 1})
    if doubled:
        raise UserError(f"site file {origin}: camera '{doubled[0]}' occurs twice; every camera needs a name of its own")
    for fault in site.faults:
        if fault.camera not in names:
            raise UserError(f"site file {origin}: a fault is for camera '{fault.camera}', which is not one of {', '.join(names)}")
    return site


def _paths(site: Site) -> Iterator[tuple[str, str]]:
    """Every path that a site file names, after its key."""
    yield "calibration", site.calibration
    for camera in site.cameras:
        yield f"camera '{camera.name}': path", camera.path
    yield "evaluation.teaching", site.evaluation.teaching
    yield "lessons.folder", site.lessons.folder


def schema() -> dict[str, Any]:
    """JSON schema of the site file, from which its documentation is written."""
    return msgspec.json.schema(Site)
