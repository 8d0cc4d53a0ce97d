"""All signals by name."""

from typing import Final

from models.motions.motion import Handed
from services.evaluation.signals import angles, feet, movement, places, trunk
from services.evaluation.signals.posture import SideAsked
from services.evaluation.signals.reading import Reading
from services.evaluation.signals.series import Series
from services.evaluation.signals.signal import Signal
from services.evaluation.track import Track

FAMILIES: Final[dict[str, tuple[Signal, ...]]] = {
    "Joint angles": angles.SIGNALS,
    "Trunk": trunk.SIGNALS,
    "Heights, reaches and distances": (*places.SIGNALS, *feet.SIGNALS),
    "Speeds and accelerations": movement.SIGNALS,
}
CATALOGUE: Final[dict[str, Signal]] = {signal.name: signal for family in FAMILIES.values() for signal in family}


def of(name: str, track: Track, side: SideAsked, lead: Handed) -> Series:
    """A signal of a track that the network saw. To read several, make a `Reading` and ask it.

    Raises:
        KeyError: there is no such signal.
    """
    return Reading(track, lead).of(CATALOGUE[name], side)
