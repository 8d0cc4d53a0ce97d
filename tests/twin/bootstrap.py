"""Errors made of a library's: for each part of the body, what came next where situation and errors were most alike.

Each entry counts twice, as it was and in the mirror.
"""

from dataclasses import dataclass

import numpy as np

from models.arrays import Float
from models.compiled import Counts
from tests.twin import context as contexts
from tests.twin import errors as errs
from tests.twin import walk
from tests.twin.context import Context
from tests.twin.errors import Errors
from tests.twin.features import Weights, error_factors, of_picture
from tests.twin.library import Library
from tests.twin.parts import PARTITIONS, Part
from tests.twin.settings import Settings


@dataclass(frozen=True, eq=False)
class Transitions:
    """From one entry to the next, as they were and mirrored.

    Attributes:
        before: (N) errors in the first picture.
        after: (N) errors in the second one.
        context: (N) of the second one.
        person: (N, P) one for whose they are, by the seed of the lesson, zero for the others.
    """

    before: Errors
    after: Errors
    context: Context
    person: Float

    def __len__(self) -> int:
        return len(self.context)


def transitions_of(library: Library, interval_s: float) -> Transitions:
    """All pairs of entries that are so far apart. Raises as `Library.transitions`."""
    first, second = library.transitions(interval_s)
    before, after, context = library.errors.chosen(first), library.errors.chosen(second), library.context.chosen(second)
    return Transitions(
        errs.together([before, before.mirrored()]),
        errs.together([after, after.mirrored()]),
        contexts.together([context, context.mirrored()]),
        np.tile(np.eye(library.persons)[library.person_of(first)], (2, 1)),
    )


@dataclass(frozen=True, eq=False)
class PartTable:
    """One part's transitions, with its own joints only."""

    part: Part
    weights: Weights
    table: walk.Table

    @classmethod
    def of(cls, part: Part, settings: Settings, transitions: Transitions) -> "PartTable":
        """The tables of a part."""
        joints, weights = list(part.joints), settings.of_part(part.name)
        before, after = transitions.before, transitions.after
        factors = error_factors(part, weights)
        residual_before, score_before = (np.ascontiguousarray(values[:, joints]) for values in (before.residual, before.score))
        table = walk.Table(
            pictures=np.ascontiguousarray(of_picture(part, weights, transitions.context, after, transitions.person).T),
            befores=walk.error_rows(residual_before, score_before, factors),
            mode_before=mode_of(part.joints, before),
            mode_after=mode_of(part.joints, after),
            found_after=after.found,
            given_after=mode_of(part.given, after),
            residual_before=residual_before,
            residual_after=np.ascontiguousarray(after.residual[:, joints]),
            trust_before=np.stack((score_before, before.spread[:, joints]), axis=-1),
            trust_after=np.stack((after.score[:, joints], after.spread[:, joints]), axis=-1),
            factors=factors,
            carry=np.array(settings.carry)[joints],
        )
        return cls(part, weights, table)


def mode_of(joints: tuple[int, ...], errors: Errors) -> Counts:
    """(n,) a number for each set of these joints that are crossed; -1 where nobody is found."""
    number = errors.crossed[:, list(joints)] @ (1 << np.arange(len(joints)))
    return np.where(errors.found, number, -1)


class Bootstrap:
    """A library, ready to be drawn from at one interval. Raises as `Library.transitions`."""

    def __init__(self, library: Library, settings: Settings, interval_s: float) -> None:
        self.settings = settings
        self.transitions = transitions_of(library, interval_s)
        self.tables = [PartTable.of(part, settings, self.transitions) for part in PARTITIONS[settings.partition]]

    def walker(self, random: np.random.Generator, person: int = 0) -> "Walker":
        """Somebody whose errors begin now; those who are to be one person in several cameras are given the same number."""
        return Walker(self, random, person)


@dataclass
class _State:
    """Errors of one part in the newest picture."""

    residual: Float
    trust: Float
    mode: int = walk.UNKNOWN


class Walker:
    """One pupil's errors in one camera, picture by picture. The same random numbers give the same errors, however it is called."""

    def __init__(self, bootstrap: Bootstrap, random: np.random.Generator, person: int) -> None:
        self._bootstrap = bootstrap
        self._random = random
        persons = bootstrap.transitions.person.shape[1]
        self._person = np.eye(persons)[person % persons]
        counts = [len(table.part.joints) for table in bootstrap.tables]
        self._states = [_State(np.zeros((count, 2)), np.zeros((count, 2))) for count in counts]

    def errors(self, context: Context) -> Errors:
        """Errors in the next pictures."""
        out = errs.nothing(len(context))
        draws = self._random.uniform(size=(len(context), len(self._states), 2))
        for index, (table, state) in enumerate(zip(self._bootstrap.tables, self._states, strict=True)):
            taken = self._walk(table, state, context, out, np.ascontiguousarray(draws[:, index]), leads=index == 0)
            self._take_over(table.part, taken, out, leads=index == 0)
        out.residual[:] *= np.array(self._bootstrap.settings.gain)[:, None]
        return out

    def _walk(self, table: PartTable, state: _State, context: Context, out: Errors, draws: Float, *, leads: bool) -> Counts:
        """Walk one part through the pictures; returns the transitions taken and writes the residuals."""
        settings, part = self._bootstrap.settings, table.part
        person = np.broadcast_to(self._person, (len(context), len(self._person)))
        query = of_picture(part, table.weights, context, out, person)
        path = walk.Path(query, out.found, mode_of(part.given, out), draws)
        taken, residual, trust = walk.walk(
            table.table, path, settings.around, settings.neighbours, leads, state.mode, state.residual, state.trust
        )
        if len(taken):
            state.mode = int(table.table.mode_after[taken[-1]]) if taken[-1] >= 0 else walk.UNKNOWN
        joints = list(part.joints)
        out.residual[:, joints], out.score[:, joints], out.spread[:, joints] = residual, trust[..., 0], trust[..., 1]
        return taken

    def _take_over(self, part: Part, taken: Counts, out: Errors, *, leads: bool) -> None:
        """What is not carried on is the neighbour's as it is."""
        after, joints = self._bootstrap.transitions.after, list(part.joints)
        out.crossed[:, joints] = after.crossed[taken][:, joints]
        if leads:
            out.found[:] = after.found[taken]
            out.renewed[:] = after.renewed[taken]
