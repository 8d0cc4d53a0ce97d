"""Which attempts the teaching benches take: who tries what, how, and with which fault. Written before any rule about faults was.

A class of pupils, one a seed. Each tries every action without a fault (unseen tempo, size, skill: natural variation is none), with
each of its faults alone at full severity, and with two at once. The last pupil of a split is kept apart: while rules are made or
mended nobody looks at what the test split's last pupil gets, and rules are tuned on the development split alone.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import combinations
from typing import Final

from edge.simulation.split import Split, generator
from models.motions.actions.library import ACTIONS
from models.motions.motion import Handed
from models.motions.performance import Performance
from tests.bench.seeds import seeds_of

WELL: Final = 2
"""How often each pupil tries each action without a fault."""
_TEMPO: Final = (0.85, 1.2)
_AMPLITUDE: Final = (0.9, 1.1)
_SKILL: Final = (0.3, 1.0)


@dataclass(frozen=True)
class Case:
    """One attempt that is asked for.

    Attributes:
        split, seed: name the pupil.
        action: what he tries.
        faults: severities by name; empty for an attempt that deserves no correction.
        number: tells attempts of the same kind apart.
    """

    split: Split
    seed: int
    action: str
    faults: Mapping[str, float] = field(default_factory=dict)
    number: int = 0

    @property
    def apart(self) -> bool:
        """Whether the case is one of those that nobody looks at while rules are made."""
        return self.split == "test" and self.seed == seeds_of("test")[-1]

    def performance(self, handed: Handed) -> Performance:
        """How it is performed; the same case is performed in the same way, whatever the severity of its faults."""
        random = generator(self.split, f"teaching {self.action} {' '.join(self.faults)} {self.number}", self.seed)
        return Performance(
            self.action,
            handed,
            tempo=float(random.uniform(*_TEMPO)),
            amplitude=float(random.uniform(*_AMPLITUDE)),
            skill=float(random.uniform(*_SKILL)),
            faults=self.faults,
            seed=int(random.integers(2**31)),
        )


def well(split: Split, seed: int) -> Iterator[Case]:
    """Attempts without a fault, of all actions."""
    for action in ACTIONS:
        for number in range(WELL):
            yield Case(split, seed, action, {}, number)


def single(split: Split, seed: int, severity: float = 1.0) -> Iterator[Case]:
    """Attempts with one fault, of all actions and faults."""
    for action in ACTIONS.values():
        for fault in action.faults:
            yield Case(split, seed, action.name, {fault.name: severity})


def double(split: Split, seed: int) -> Iterator[Case]:
    """One attempt with two faults of each action; which two goes by the seed."""
    for action in ACTIONS.values():
        pairs = list(combinations((fault.name for fault in action.faults), 2))
        yield Case(split, seed, action.name, dict.fromkeys(pairs[seed % len(pairs)], 1.0))


def filmed(split: Split, seed: int) -> list[Case]:
    """What a pupil is filmed at, for films are dear: everything well once, a fifth of the faults, two pairs.

    Five seeds that follow one another film every fault once.
    """
    faults = [case for number, case in enumerate(single(split, seed)) if number % 5 == seed % 5]
    pairs = [case for number, case in enumerate(double(split, seed)) if number % 5 == seed % 5]
    return [*(case for case in well(split, seed) if case.number == 0), *faults, *pairs]
