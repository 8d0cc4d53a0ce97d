"""A lesson plan: everything that a simulated lesson is made of. The same plan gives the same pictures, to the bit.

A plan is written in TOML and validated strictly: a key that is not known, a value out of bounds, an action or a fault that nobody
knows is refused in one line that names it. Times count in seconds from the lesson's beginning, places in metres on the floor from
the court's middle, and directions in degrees from the x axis to the y axis. `docs/simulation.md` names every key.
"""

import hashlib
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec
from msgspec import UNSET, Meta, UnsetType

from edge.simulation.lesson.files import PLAN_NAME
from edge.simulation.split import Split, generator
from models.body.prior import Sex
from models.config.site import FaultConfig, Name
from models.errors import UserError
from models.motions.motion import Handed
from models.motions.performance import AMPLITUDE, SEVERITY, TEMPO, Performance
from models.regular_file import require_text

PLAN_VERSION = 1
MAX_LENGTH_S = 600.0

Seed = Annotated[int, Meta(ge=0, lt=2**31)]
Time = Annotated[float, Meta(ge=0, le=MAX_LENGTH_S)]
Place = tuple[Annotated[float, Meta(ge=-20, le=20)], Annotated[float, Meta(ge=-20, le=20)]]
Pastime = Literal["wait", "scratch", "hands_on_hips", "hands_behind", "bend", "pick_up", "clap", "stretch"]
"""As in `models.motions.between`, whose import would cost every camera's process half a second."""
Direction = Annotated[float, Meta(ge=-360, le=360)]


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of every table of a plan."""


class PerformancePlan(Table, frozen=True, kw_only=True):
    """One try at an action, and what the pupil does before it."""

    action: Annotated[str, Meta(description="which action")]
    handed: Annotated[Handed, Meta(description="the side that leads")] = "right"
    tempo: Annotated[float, Meta(ge=TEMPO[0], le=TEMPO[1], description="1 is the standard's; more is faster")] = 1.0
    amplitude: Annotated[float, Meta(ge=AMPLITUDE[0], le=AMPLITUDE[1], description="of the movement")] = 1.0
    skill: Annotated[float, Meta(ge=0, le=1, description="1 performs as the standard does; below, natural variation grows")] = 1.0
    faults: Annotated[
        dict[str, Annotated[float, Meta(ge=SEVERITY[0], le=SEVERITY[1])]],
        Meta(description="severities of what is done wrong; 1 is what a teacher corrects at once"),
    ] = {}
    seed: Annotated[Seed | UnsetType, Meta(description="of the natural variation; drawn from the lesson's if left out")] = UNSET
    begins_s: Annotated[Time | UnsetType, Meta(description="when it begins; `wait_s` after what was before if left out")] = UNSET
    wait_s: Annotated[Time, Meta(description="how long the pupil waits before it, if `begins_s` is left out")] = 0.5
    meanwhile: Annotated[Pastime, Meta(description="what he does while he waits")] = "wait"
    jogs: Annotated[bool, Meta(description="jogs to the place, or walks")] = False
    place_m: Annotated[Place | UnsetType, Meta(description="where it begins; he walks there; where he is if left out")] = UNSET
    facing_deg: Annotated[Direction | UnsetType, Meta(description="where he looks as it begins; as he stands if left out")] = UNSET


class PupilPlan(Table, frozen=True, kw_only=True):
    """A person. What is left out of the looks is cast by lot from the people of the lesson's split."""

    name: Annotated[Name, Meta(description="code, unique in the lesson")]
    age_years: Annotated[Annotated[float, Meta(ge=5, le=65)] | UnsetType, Meta(description="age")] = UNSET
    sex: Annotated[Sex | UnsetType, Meta(description="sex")] = UNSET
    looks: Annotated[Seed | UnsetType, Meta(description="seed of shape, skin and clothes")] = UNSET
    bib: Annotated[
        Literal["red", "yellow", "green", "blue"] | UnsetType, Meta(description="colour of a training bib; several may wear one")
    ] = UNSET
    place_m: Annotated[Place, Meta(description="where he stands at first")] = (0.0, 0.0)
    facing_deg: Annotated[Direction, Meta(description="where he looks at first")] = 0.0
    performs: Annotated[list[PerformancePlan], Meta(max_length=100, description="in this order; nothing for a bystander")] = []


class ShutterPlan(Table, frozen=True, kw_only=True):
    """How the cameras expose."""

    exposure_ms: Annotated[float, Meta(gt=0, le=33, description="how long each row gathers light")] = 4.0
    readout_ms: Annotated[float, Meta(ge=0, le=33, description="from the first row's exposure to the last's; 0: global")] = 16.0
    phases: Annotated[
        Literal["synced", "free_running"],
        Meta(description="synced: all cameras expose at the same time; free_running: each when its own clock says, by lot"),
    ] = "synced"


class OccluderPlan(Table, frozen=True, kw_only=True):
    """Something that stands in the way."""

    kind: Annotated[Literal["vaulting_box", "bench", "mats", "volleyball_net", "badminton_net"], Meta(description="what it is")]
    place_m: Annotated[Place, Meta(description="where its middle is")]
    facing_deg: Annotated[Direction, Meta(description="how it is turned")] = 0.0


class BumpPlan(Table, frozen=True, kw_only=True):
    """A camera is knocked, and stays as it then is. Its calibration is not told."""

    camera: Annotated[Name, Meta(description="which")]
    at_s: Annotated[Time, Meta(description="when")]
    turn_deg: Annotated[float, Meta(ge=0, le=45, description="by how much it is turned, about an axis by lot")] = 0.0
    move_cm: Annotated[float, Meta(ge=0, le=100, description="how far it is moved, in a direction by lot")] = 0.0


class LightPlan(Table, frozen=True, kw_only=True):
    """The gym's light changes."""

    at_s: Annotated[Time, Meta(description="when")]
    for_s: Annotated[float, Meta(gt=0, le=MAX_LENGTH_S, description="for how long")]
    level: Annotated[float, Meta(ge=0, le=4, description="against the usual light; 0 is night")]


class ExposurePlan(Table, frozen=True, kw_only=True):
    """A camera sets its exposure anew, as one does that was left on automatic."""

    camera: Annotated[Name, Meta(description="which")]
    at_s: Annotated[Time, Meta(description="when it begins to")]
    stops: Annotated[float, Meta(ge=-4, le=4, description="by how much; 1 is twice as bright. It stays so")]
    over_s: Annotated[float, Meta(ge=0, le=10, description="how long the change takes")] = 0.5


class SwapPlan(Table, frozen=True, kw_only=True):
    """From then on two cameras answer to one another's name."""

    cameras: Annotated[tuple[Name, Name], Meta(description="which")]
    at_s: Annotated[Time, Meta(description="when")]


class Plan(Table, frozen=True, kw_only=True):
    """A lesson."""

    version: Annotated[int, Meta(description="version of this schema")]
    name: Annotated[Name, Meta(description="of the lesson, and of its folder")]
    seed: Annotated[Seed, Meta(description="of all that is not said here")]
    split: Annotated[Split, Meta(description="whose people, clothes and things appear; figures are measured on test only")] = "test"
    rig: Annotated[str, Meta(description="where the cameras stand")] = "corners"
    cameras: Annotated[int | UnsetType, Meta(description="take the first so many of the rig; all if left out")] = UNSET
    size_px: Annotated[
        tuple[Annotated[int, Meta(ge=64, le=3840)], Annotated[int, Meta(ge=64, le=2160)]] | UnsetType,
        Meta(description="width and height of the pictures; the rig's if left out"),
    ] = UNSET
    rate_hz: Annotated[float, Meta(ge=1, le=120, description="pictures a second")] = 30.0
    length_s: Annotated[
        Annotated[float, Meta(gt=0, le=MAX_LENGTH_S)] | UnsetType,
        Meta(description="how long; until everybody has done everything if left out"),
    ] = UNSET
    gym: Annotated[Seed | UnsetType, Meta(description="seed of the room; the lesson's if left out")] = UNSET
    shutter: ShutterPlan = ShutterPlan()
    pupils: Annotated[
        list[PupilPlan], Meta(min_length=1, max_length=8, description="the first is the one whom the lesson is about")
    ]
    occluders: Annotated[list[OccluderPlan], Meta(max_length=16, description="things that stand in the way")] = []
    bumps: Annotated[list[BumpPlan], Meta(max_length=16, description="cameras that are knocked")] = []
    lights: Annotated[list[LightPlan], Meta(max_length=16, description="changes of the light")] = []
    exposures: Annotated[list[ExposurePlan], Meta(max_length=64, description="changes of the exposure")] = []
    swaps: Annotated[list[SwapPlan], Meta(max_length=8, description="cameras that exchange their names")] = []
    faults: Annotated[
        list[FaultConfig], Meta(max_length=64, description="faults of cameras as in a site file, but in the lesson's time")
    ] = []

    def performance(self, pupil: int, number: int) -> Performance:
        """What pupil `pupil` performs as his `number`th; its natural variation has a seed of its own unless one is given."""
        wanted = self.pupils[pupil].performs[number]
        seed = wanted.seed if wanted.seed is not UNSET else self.lot("variation", pupil, number)
        return Performance(wanted.action, wanted.handed, wanted.tempo, wanted.amplitude, wanted.skill, wanted.faults, seed)

    def lot(self, *what: str | int) -> int:
        """A seed (0 to 2^31 - 1) for something named so: of development and test lessons of one seed they differ."""
        return int(generator(self.split, " ".join(map(str, ("lesson", *what))), self.seed).integers(2**31))


class _Versioned(msgspec.Struct):
    version: int


def decode_plan(data: bytes, origin: Path | str) -> Plan:
    """Read a plan.

    Args:
        data: TOML text.
        origin: the file's name, for error messages.

    Raises:
        UserError: not TOML, another version, an unknown key or a value out of bounds. Whether what it names is there, such as an
            action, says `edge.simulation.lesson.plan_check`.
    """
    try:
        version = msgspec.toml.decode(data, type=_Versioned).version
        if version != PLAN_VERSION:
            raise UserError(f"lesson plan {origin}: version {version} is not known to this KineBox, which reads {PLAN_VERSION}")
        return msgspec.toml.decode(data, type=Plan)
    except msgspec.ValidationError as error:
        raise UserError(f"lesson plan {origin}: {error}; see docs/simulation.md for every key") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError, ValueError) as error:
        raise UserError(f"lesson plan {origin}: {error}; it is no TOML there, correct it") from error


def plan_text(path: Path) -> bytes:
    """What is in a plan's file; OSError if it cannot be read, or is no file that a plan could be in."""
    require_text(path.stat())
    return path.read_bytes()


def read_plan(folder: Path, camera: str) -> Plan:
    """The plan of a rendered lesson; `camera` is for the message. Raises UserError if there is none that can be read."""
    path = folder / PLAN_NAME
    try:
        return decode_plan(plan_text(path), path)
    except FileNotFoundError as error:
        raise UserError(
            f"camera '{camera}': {folder} is no rendered lesson; correct `path` in the site file, or render it with "
            "`kinebox simulate` (the built-in one: `make simulated`)"
        ) from error
    except OSError as error:
        raise UserError(f"camera '{camera}': {path} cannot be read ({error.strerror}); correct its rights") from error


def encode_plan(plan: Plan) -> bytes:
    """The plan as TOML; `decode_plan` reads the same plan again."""
    import tomlkit  # noqa: PLC0415 - a camera's process reads plans only

    return tomlkit.dumps(msgspec.to_builtins(plan)).encode()


def fingerprint(plan: Plan, recipe: str) -> str:
    """64 hexadecimal digits that are the same for the same plan and recipe (of the code that makes pictures), and for no others."""
    return hashlib.sha256(recipe.encode() + b"\0" + msgspec.json.encode(plan, order="deterministic")).hexdigest()


def schema() -> dict[str, Any]:
    """JSON schema of a plan, against which a test holds its documentation."""
    return msgspec.json.schema(Plan)
