"""Filmed strips: each action, as it should be done and with each of its faults, in moments from beginning to end.

A strip has a row for the standard performance and one for each fault at severity 1, in the action's order, and eight columns,
among them the four keyframes. There are no captions in it: who cannot tell what is done from the pictures shall not be helped.
`make strips` writes them all to docs/actions, with a page that lists what is in which row.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from edge.simulation.gym.furniture import mat as gymnastics_mat
from edge.simulation.gym.hall import Gym, make_gym
from edge.simulation.gym.solids import placed
from edge.simulation.gym.things import PlayedThing
from edge.simulation.lesson.stage import ON_A_MAT
from edge.simulation.people.avatar import Avatar
from edge.simulation.people.casting import Member, cast
from edge.simulation.picture.indexed_png import encode_indexed
from edge.simulation.picture.renderer import Renderer
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.sensor import Sensor
from edge.simulation.picture.shutter import Shutter
from models.arrays import Float, UInt8
from models.camera.pinhole import Camera
from models.motions import mat
from models.motions.actions.action import Action
from models.motions.actions.library import ACTIONS
from models.motions.motion import Attempt, Motion
from models.motions.perform import perform
from models.motions.performance import Performance

FOLDER: Final = Path("docs/actions")
PAGE: Final = "README.md"
CELL_PX: Final = (148, 176)
_GAP_PX: Final = 3
_COLOURS: Final = 96
_SHUTTER: Final = Shutter(exposure_s=1 / 500, readout_s=0.0)
_SENSOR: Final = Sensor(full_well_e=np.inf, read_noise_e=0.0)
_YEARS: Final = 13.0


@dataclass(frozen=True)
class _Look:
    """Where the camera stands and when it looks.

    Attributes:
        azimuth_deg: from the front of the pupil to his left, so that -90 sees his right side.
        at_m: height of the picture's middle.
        seen_m: height of the picture, at the pupil.
        who: seed of the pupil, whose clothes stand out from the wall and from his skin.
        moments: of the columns: 0 is the start, 1 the exertion, 2 the peak, 3 the end.
        distance_m: from the pupil.
        up_m: height of the camera.
    """

    azimuth_deg: float = -50.0
    at_m: float = 1.0
    seen_m: float = 2.5
    who: int = 0
    moments: tuple[float, ...] = (0.0, 0.5, 1.0, 1.5, 2.0, 2.2, 2.5, 3.0)
    distance_m: float = 4.6
    up_m: float = 1.25


_VIEWS: Final = {
    "basketball_shot": _Look(-38.0, 1.23, 2.6, 0, (0.0, 0.6, 1.0, 1.5, 2.0, 2.15, 2.45, 3.0)),
    "badminton_clear": _Look(-48.0, 1.15, 2.7, 18, (0.0, 0.5, 1.0, 1.5, 1.85, 2.0, 2.12, 3.0)),
    "volleyball_spike": _Look(-55.0, 1.3, 2.9, 39, (0.0, 0.6, 1.0, 1.4, 1.75, 2.0, 2.06, 3.0)),
    "soccer_kick": _Look(-60.0, 0.85, 2.2, 14, (0.0, 0.5, 1.0, 1.6, 2.0, 2.1, 2.35, 3.0)),
    "long_jump": _Look(-75.0, 0.95, 2.3, 6, (0.0, 0.5, 1.0, 1.6, 2.0, 2.1, 2.3, 3.0)),
    "forward_roll": _Look(-75.0, 0.75, 2.0, 35),
    "cartwheel": _Look(-12.0, 0.9, 2.2, 28),
    "run": _Look(-75.0, 0.85, 2.0, 23),
    "squat": _Look(-50.0, 0.82, 1.9, 11),
    "star_jump": _Look(-20.0, 1.05, 2.4, 30),
}


def moments_s(attempt: Attempt) -> list[float]:
    """Times of the columns."""
    keyframes = (attempt.start_s, attempt.exertion_s, attempt.peak_s, attempt.end_s)
    return [float(np.interp(place, range(4), keyframes)) for place in _VIEWS.get(attempt.action, _Look()).moments]


def performances(action: Action) -> list[Performance]:
    """Of the rows: the standard, then each fault."""
    return [Performance(action.name), *(Performance(action.name, faults={fault.name: 1.0}) for fault in action.faults)]


def strip(action: Action) -> UInt8:
    """(H, W, 3) blue, green, red: the picture of an action.

    Raises:
        UserError: nothing can be rendered on this machine; says what is missing.
    """
    member = cast("development", _VIEWS.get(action.name, _Look()).who, _YEARS)
    gym = make_gym("development", 3)
    rows = [_row(gym, member, perform(performance, member.subject)) for performance in performances(action)]
    return np.vstack([part for row in rows for part in (row, np.full((_GAP_PX, row.shape[1], 3), 255, np.uint8))][:-1])


def _row(gym: Gym, member: Member, motion: Motion) -> UInt8:
    (attempt,) = motion.attempts
    bed = placed(gymnastics_mat(), (mat.FROM_M + mat.LENGTH_M / 2, 0.0, 0.0), 0.0)
    scene = Scene(
        room=(*gym.room, bed) if attempt.action in ON_A_MAT else gym.room,
        pupils=(Avatar("pupil", member.subject, member.look, motion),),
        things=tuple(PlayedThing(thing) for thing in motion.things),
        lamps=gym.lamps,
        ambient=gym.ambient,
    )
    renderer = Renderer(scene)
    look = _VIEWS.get(attempt.action, _Look())
    cells = []
    for number, t_s in enumerate(moments_s(attempt)):
        camera = _camera(look, motion.pose_at(t_s).translation_m)
        cells.append(_SENSOR.develop(renderer.view(camera, _SHUTTER).picture(t_s), number))
        cells.append(np.full((CELL_PX[1], _GAP_PX, 3), 255, np.uint8))
    return np.hstack(cells[:-1])


def _camera(look: _Look, pelvis_m: Float) -> Camera:
    """Beside the pupil: it goes along with him, but neither up nor down."""
    width, height = CELL_PX
    azimuth = np.radians(look.azimuth_deg)
    target = np.array((pelvis_m[0], pelvis_m[1], look.at_m))
    eye = np.array((pelvis_m[0], pelvis_m[1], look.up_m)) + look.distance_m * np.array((np.cos(azimuth), np.sin(azimuth), 0.0))
    ahead = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(ahead, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    turn = np.stack((right, np.cross(ahead, right), ahead))
    focal = height * look.distance_m / look.seen_m
    matrix = np.array(((focal, 0.0, (width - 1) / 2), (0.0, focal, (height - 1) / 2), (0.0, 0.0, 1.0)))
    return Camera("strip", CELL_PX, matrix, np.zeros(5), turn, -turn @ eye, np.zeros(2))


def page() -> str:
    """The page beside the pictures."""
    return "\n".join(_page_lines()) + "\n"


def _page_lines() -> Iterator[str]:
    yield "# The actions and their faults"
    yield ""
    yield "What simulated pupils perform, filmed; `make strips` makes this page and its pictures anew. The first row of a picture"
    yield "is the standard; each row below is one fault at severity 1, as a teacher would call it. Columns go from the start to the"
    yield "end by way of the exertion (third) and the peak (fifth or sixth)."
    for action in ACTIONS.values():
        yield ""
        yield f"## {action.title}"
        yield ""
        yield f"![{action.title}: the standard, then each fault]({action.name}.png)"
        yield ""
        yield "| row | `faults` | what is done wrong |"
        yield "|---|---|---|"
        yield "| 1 | | nothing: the standard |"
        for number, fault in enumerate(action.faults, start=2):
            yield f"| {number} | `{fault.name}` | {fault.what} |"


def main() -> None:
    """Write the strips and their page."""
    parser = argparse.ArgumentParser(prog="python -m edge.simulation.rendering.strip", description=__doc__.splitlines()[0])
    parser.add_argument("actions", nargs="*", choices=[*ACTIONS, []], help="which; all if left out")
    parser.add_argument("--page", action="store_true", help="write the page only, no picture")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where to (docs/actions)")
    wanted = parser.parse_args()
    wanted.folder.mkdir(parents=True, exist_ok=True)
    for name in [] if wanted.page else wanted.actions or ACTIONS:
        data = encode_indexed(strip(ACTIONS[name]), _COLOURS)
        (wanted.folder / f"{name}.png").write_bytes(data)
        print(f"{name}.png  {len(data) / 1000:.0f} kB", flush=True)  # noqa: T201 - a tool for the command line
    (wanted.folder / PAGE).write_text(page())


if __name__ == "__main__":
    main()
