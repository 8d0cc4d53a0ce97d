"""C3D, the binary format of motion capture (https://www.c3d.org): millimetres, z up, with keyframes as events.

The residual of a point says how well it is known, as the format means it: -1 where it is unknown, 0 where it was carried by the
filter or seen by fewer than two views, and otherwise one standard deviation of its position, in steps of `SIGMA_STEP_MM`.
"""

import struct
import warnings
from io import BytesIO
from typing import Final

import c3d
import numpy as np

from models.arrays import Float
from models.messages.motion import JointState
from services.lesson.export.labels import DESCRIPTIONS, LABELS
from services.lesson.export.take import Keyframe, Take

SUFFIX = ".c3d"
COMPANY: Final = "KineBox"
"""As MANUFACTURER:COMPANY says; by it an importer knows what residuals mean."""
SIGMA_STEP_MM: Final = 0.5
_STEPS: Final = 255
MOST_EVENTS: Final = 255
"""A parameter's length is one byte."""
_MM: Final = 1000.0


def encode(take: Take) -> bytes:
    """The file. Positions are 32-bit floats. Of more than `MOST_EVENTS` keyframes the first stand in the file.

    Raises:
        UnicodeEncodeError: the pupil's code is none, see `models.messages.pupil`, and C3D has no place for its letters.
    """
    writer = c3d.Writer(point_rate=take.rate_hz, point_scale=-SIGMA_STEP_MM, point_units="mm")
    points = np.zeros((len(take.track), len(LABELS), 5))
    points[..., :3] = np.nan_to_num(take.joints_m * _MM)
    points[..., 3] = _residuals_mm(take)
    none = np.zeros((0, 0))
    for frame in points:
        writer.add_frames((frame, none))
    writer.set_point_labels(LABELS)
    point = writer.point_group
    point.add_str("DESCRIPTIONS", "What the points are", *_packed(DESCRIPTIONS))
    writer.set_screen_axis("+Y", "+Z")
    _add_event_group(writer, take.keyframes[:MOST_EVENTS], take.pupil)
    made_by = writer.add_group(writer.numeric_key_next, "MANUFACTURER", "Who made the file")
    made_by.add_str("COMPANY", "Name", COMPANY, len(COMPANY))
    if take.pupil:
        subjects = writer.add_group(writer.numeric_key_next, "SUBJECTS", "Who moves")
        subjects.add("USED", "How many", 2, "<H", 1)
        subjects.add_str("NAMES", "Codes", *_packed((take.pupil,)))
    file = BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that there are no analogue channels
        writer.write(file)
    return file.getvalue()


def _residuals_mm(take: Take) -> Float:
    """(T, 17) as the module says."""
    variances = np.trace(take.track.covariance_m2, axis1=2, axis2=3) / 3
    steps = np.clip(np.rint(np.sqrt(np.nan_to_num(variances)) * _MM / SIGMA_STEP_MM), 1, _STEPS)
    residuals = np.where(take.track.states == JointState.SEEN, steps * SIGMA_STEP_MM, 0.0)
    return np.where(take.known, residuals, -1.0)


def _add_event_group(writer: c3d.Writer, keyframes: tuple[Keyframe, ...], pupil: str) -> None:
    group = writer.add_group(writer.numeric_key_next, "EVENT", "Keyframes of attempts")
    group.add("USED", "How many", 2, "<H", len(keyframes))
    if not keyframes:
        return
    minutes = b"".join(struct.pack("<ff", key.t_s // 60, key.t_s % 60) for key in keyframes)
    group.add("TIMES", "Minutes and seconds from the first frame", 4, "", minutes, 2, len(keyframes))
    group.add_str("CONTEXTS", "Side", *_packed(("General",) * len(keyframes)))
    group.add_str("LABELS", "Keyframe", *_packed([key.phase for key in keyframes]))
    group.add_str("DESCRIPTIONS", "Attempt", *_packed([f"{key.action} {key.attempt}" for key in keyframes]))
    group.add_str("SUBJECTS", "Code", *_packed((pupil or " ",) * len(keyframes)))


def _packed(texts: tuple[str, ...] | list[str]) -> tuple[str, int, int]:
    """Texts of one length in a row, the length, and how many: what a parameter of texts is. UnicodeEncodeError beyond ASCII."""
    texts = [text.encode("ascii").decode()[:127] for text in texts]
    length = max(len(text) for text in texts)
    return "".join(text.ljust(length) for text in texts), length, len(texts)
