"""The built-in footages: which files of which package they are made of."""

from dataclasses import dataclass
from typing import Final

PACKAGE, VERSION = "pose2sim", "0.10.49"
WHEEL_SUFFIX = "-py3-none-any.whl"
WHEEL_SHA256 = "403e0dc4065898ba6a595e72a8970950310979253d60e24c2e00b16b36bf21e1"
CAMERAS = ("cam01", "cam02", "cam03", "cam04")
CALIBRATION = "Calib.qca.txt"


@dataclass(frozen=True)
class Footage:
    """Four videos of 100 pictures, at 60 Hz, of one scene.

    Attributes:
        name: of its folder in the data folder, and of its site.
        demo: its folder in the package.
        fitted: whether videos of another width than the calibrated one were scaled to fit, with black bars above and below;
            cutting the bars off undoes that.
    """

    name: str
    demo: str
    fitted: bool

    @property
    def recipe(self) -> str:
        """How it is made. Raise the number when the conversion changes: footage of an older recipe is prepared again."""
        return f"{PACKAGE} {VERSION}, recipe 1"


ONE_PERSON: Final = Footage("footage", "Pose2Sim/Demo_SinglePerson", fitted=True)
TWO_PEOPLE: Final = Footage("footage2", "Pose2Sim/Demo_MultiPerson", fitted=False)
"""The same man and scene with a second person rendered into all four views; its pictures were moved and scaled a little once
more, which `tests/bench/footage/two_people_rig.py` puts into the calibration."""
FOOTAGES: Final = {footage.name: footage for footage in (ONE_PERSON, TWO_PEOPLE)}
