"""A lesson on video whose truth is known, wherever it comes from: rendered, or a data set that the user holds."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from edge.cameras.source import Frame
from models.arrays import Bool, Float
from models.camera.rig import Rig

START_NS: Final = 1_000_000_000
"""Time of a lesson's beginning. Whole seconds, so that fusion's output grid of 30 Hz has an instant there."""
UPRIGHT: Final = ("basketball_shot", "long_jump", "badminton_clear", "volleyball_spike", "soccer_kick")
"""The five of the six actions whose mean is the headline figure; the roll goes by its own name."""


@dataclass(frozen=True)
class Span:
    """What the pupil does from `begin_s` to `end_s`, seconds from the lesson's beginning."""

    action: str
    begin_s: float
    end_s: float


@dataclass(frozen=True, eq=False)
class PictureTruth:
    """What is true in each picture of one camera.

    Attributes:
        times_s: (n,) mid-exposures, from the lesson's beginning.
        points_m: (n, 17, 3) COCO points in the world, each as its row was exposed.
        points_px: (n, 17, 2) where they are in the picture, distorted.
        visible: (n, 17) whether nothing hides the point from the camera; a point outside the picture is not visible.
    """

    times_s: Float
    points_m: Float
    points_px: Float
    visible: Bool


@dataclass(frozen=True, eq=False)
class Lesson:
    """One lesson.

    Attributes:
        name: of the lesson.
        seed: of all that is drawn by chance in it; figures are means over seeds.
        pupil: code of the pupil, whose looks figures go by.
        identity: the same for the same pictures, and for no others.
        rig: calibration.
        length_s: of the lesson.
        spans: what is done when, in the order of time.
        frames: pictures of some cameras, by name, in the order of their mid-exposure; `START_NS` is the lesson's beginning.
        truth_m: the pupil's COCO points (n, 17, 3) at (n,) seconds from the lesson's beginning; NaN where that is not known.
        stature_m: the pupil's; NaN if that is not known.
        pictures: truth in the pictures, by camera; empty for data sets that have none.
    """

    name: str
    seed: int
    pupil: str
    identity: str
    rig: Rig
    length_s: float
    spans: tuple[Span, ...]
    frames: Callable[[Sequence[str]], Iterator[Frame]]
    truth_m: Callable[[Float], Float]
    stature_m: float = float("nan")
    pictures: dict[str, PictureTruth] = field(default_factory=dict)

    def action_at(self, t_s: float) -> str:
        """What is done at an instant; empty between attempts."""
        return next((span.action for span in self.spans if span.begin_s <= t_s <= span.end_s), "")
