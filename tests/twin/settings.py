"""What is chosen by fitting, beside the library itself."""

from dataclasses import dataclass, field

import msgspec

from models.skeleton import coco
from tests.twin.features import Weights


@dataclass(frozen=True)
class Settings:
    """How the library is drawn from.

    Attributes:
        network: pose network that the errors are of.
        interval_s: between two pictures of a camera, where the lesson does not say.
        partition: name in `tests.twin.parts.PARTITIONS`.
        around: pictures of like situation, of which the mode is drawn.
        neighbours: of which the errors are drawn.
        weights: by name of the part; the default ones for others.
        carry: (17,) share of what the errors before differ by from the neighbour's that is carried on.
        gain: (17,) by which residuals are larger than drawn: neighbours are more often ordinary than not.
    """

    network: str = "thunder"
    interval_s: float = 1 / 15
    partition: str = "thirds"
    around: int = 60
    neighbours: int = 6
    weights: dict[str, Weights] = field(default_factory=dict)
    carry: tuple[float, ...] = (0.0,) * coco.COUNT
    gain: tuple[float, ...] = (1.0,) * coco.COUNT

    def of_part(self, name: str) -> Weights:
        """The weights of a part."""
        return self.weights.get(name, Weights())


def to_plain(settings: Settings) -> dict[str, object]:
    """For a file."""
    plain: dict[str, object] = msgspec.to_builtins(settings)
    return plain


def from_plain(plain: dict[str, object]) -> Settings:
    """From a file."""
    return msgspec.convert(plain, Settings)
