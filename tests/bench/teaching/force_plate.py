"""Drop jumps over a force plate: how high the plate says that somebody jumped, and how high we do.

The markers become a body in motion, its COCO points at the box's rate become a track. The plate tells roughly where in the
recording the jump is, to a tenth of a second, as found keyframes would; take-off and landing are found by the measure.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from models.motions.motion import RATE_HZ
from models.motions.recorded import force, trc
from models.motions.recorded.fit import fit
from models.motions.recorded.replay import motion_of
from models.skeleton import coco
from models.teaching.measure import Measure
from services.evaluation.attempt import FoundAttempt
from services.evaluation.measures.measured import Measured
from services.evaluation.measures.reduce import evaluate
from services.evaluation.signals.reading import Reading
from services.evaluation.track import known_track
from tests.bodies import body_model, prior_of

FOLDER: Final = "drop_jumps_dev"
_GROWN_UP_YEARS: Final = 25.0
_TRACK_HZ: Final = 30.0
_MARKERS_M: Final = 0.004


@dataclass(frozen=True)
class DropJump:
    """One jump: our height by the time in the air, and the plate's, centimetres."""

    name: str
    ours: Measured
    plate_cm: float

    @property
    def error_cm(self) -> float:
        """Ours less the plate's."""
        return self.ours.value - self.plate_cm


def names(shared: Path) -> list[str]:
    """Of the recordings that there are; none if the data are not there."""
    return sorted(path.stem for path in (shared / FOLDER).glob("*.trc"))


def drop_jump(shared: Path, name: str) -> DropJump:
    """Measure one recording."""
    folder = shared / FOLDER
    markers = trc.decode((folder / f"{name}.trc").read_bytes(), name)
    plate = force.decode((folder / f"{name}_vertical_force.csv").read_bytes(), name)
    ((off_s, on_s),) = plate.flights_s()
    found = fit(markers, body_model(), prior_of(body_model()).likely(_GROWN_UP_YEARS))
    motion = motion_of(found)
    poses = range(0, len(motion.translations_m), round(RATE_HZ / _TRACK_HZ))
    joints_m = np.stack([found.body.coco_m(motion.pose(number))[: coco.COUNT] for number in poses])
    exertion_s, peak_s = round(off_s - 0.2, 1), round((off_s + on_s) / 2, 1)
    attempt = FoundAttempt("long_jump", "right", (exertion_s - 0.2, exertion_s, peak_s, round(on_s + 0.5, 1)))
    reading = Reading(known_track(joints_m, 1 / _TRACK_HZ, _MARKERS_M), "right")
    ours = evaluate(Measure(function="jump_height_by_time"), reading, attempt)
    return DropJump(name, ours, 100 * force.jump_height_m(on_s - off_s))
