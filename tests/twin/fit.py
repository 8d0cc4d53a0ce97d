"""The twin fitted to streams of several lessons; whatever is chosen is chosen by lessons that were left out.

1. The library is the streams themselves, thinned to what the file may hold.
2. `carry`: neighbours found for a picture of a left-out lesson differ from it in the errors before; how much of that difference is
   still there one picture later is a regression's slope. Neighbours whose errors before are alike remember something of them by
   themselves; what is too much is taken off in `_ROUNDS` rounds.
3. How the body is divided, and how many neighbours are drawn from: every choice makes errors for the left-out lessons, by what the
   others know, and the one most alike is taken.
4. `gain`: what the sizes of these errors still lack.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import Float
from models.compiled import Counts
from models.errors import UserError
from models.skeleton import coco
from tests.twin import walk
from tests.twin.bootstrap import Bootstrap
from tests.twin.context import Context
from tests.twin.errors import Errors, as_seen
from tests.twin.library import Library, build, encode
from tests.twin.likeness import Told, describe, unlikeness
from tests.twin.settings import Settings, to_plain
from tests.twin.truth import Stream
from tests.twin.twin import Twin

FILE_BYTES = 1_000_000
CHOICES = tuple((partition, neighbours) for partition in ("whole", "thirds", "fifths") for neighbours in (2, 4))
_ASKED = 400
_ROUNDS = 2
_GAINS = (0.8, 1.3)
_ORDINARY = 0.1


@dataclass(frozen=True)
class Choice:
    """A way to draw, and how unlike the left-out lessons its errors are."""

    settings: Settings
    apart: dict[str, float]


def fit(
    streams: Sequence[Stream],
    network: str = "thunder",
    choices: Sequence[tuple[str, int]] = CHOICES,
    shown: Callable[[Choice], None] = lambda _: None,
) -> Twin:
    """Fit a twin.

    Args:
        streams: of lessons of at least two seeds, all looked at with one network and at about one rate.
        network: its name.
        choices: partitions and numbers of neighbours to choose from.
        shown: is told each choice as it has been judged.

    Raises:
        UserError: there are no streams, or of one seed only.
    """
    library = thinned(streams)
    if len(set(library.seeds)) < 2:
        raise UserError("the twin is fitted by leaving lessons out, so it needs lessons of at least two seeds")
    interval_s = float(np.median(np.concatenate([np.diff(stream.truth.t_s) for stream in streams])))
    judged = []
    for partition, neighbours in choices:
        settings = Settings(network=network, interval_s=interval_s, partition=partition, neighbours=neighbours)
        settings = replace(settings, carry=carried(library, settings))
        told, made = left_out(library, settings)
        for _ in range(_ROUNDS):
            settings = replace(settings, carry=remembered(settings, told, made))
            told, made = left_out(library, settings)
        judged.append((Choice(settings, unlikeness(describe(told), describe(made))), gains(told, made)))
        shown(judged[-1][0])
    best, gain = min(judged, key=lambda one: one[0].apart["all"])
    return Twin(library, replace(best.settings, gain=gain))


def to_file(twin: Twin) -> bytes:
    """What `Twin.load` reads."""
    return encode(twin.library, to_plain(twin.settings))


def thinned(streams: Sequence[Stream], file_bytes: int = FILE_BYTES) -> Library:
    """The library of as many streams as the file may hold, from all seeds alike.

    Raises:
        UserError: there are none.
    """
    order = np.random.default_rng(0).permutation(len(streams))
    by_seed: dict[int, list[Stream]] = {}
    for index in order:
        by_seed.setdefault(streams[index].seed, []).append(streams[index])
    turns = max(map(len, by_seed.values()), default=0)
    dealt = [own[turn] for turn in range(turns) for _, own in sorted(by_seed.items()) if turn < len(own)]
    kept = len(dealt)
    while True:
        library = build(dealt[:kept])
        size = len(encode(library, to_plain(Settings())))
        if size <= file_bytes or kept == 1:
            return library
        kept = max(1, min(kept - 1, int(kept * file_bytes / size)))


def left_out(library: Library, settings: Settings) -> tuple[Told, Told]:
    """The library's streams, and errors made in their situations by what the lessons of other seeds know."""
    told: list[tuple[Context, Errors]] = []
    made: list[tuple[Context, Errors]] = []
    ready = {seed: Bootstrap(library.without(seed), settings, settings.interval_s) for seed in sorted(set(library.seeds))}
    for index, seed in enumerate(library.seeds):
        entries = slice(int(library.starts[index]), int(library.starts[index + 1]))
        context = library.context.chosen(entries)
        walker = ready[seed].walker(np.random.default_rng((seed, index)), seed)
        told.append((context, library.errors.chosen(entries)))
        made.append((context, as_seen(context.pose, walker.errors(context))))
    return told, made


def carried(library: Library, settings: Settings) -> tuple[float, ...]:
    """(17,) slopes; see this file's head."""
    bootstrap = Bootstrap(library, settings, settings.interval_s)
    first, _ = library.transitions(settings.interval_s)
    group = np.tile(library.person_of(first), 2)
    out = np.zeros(coco.COUNT)
    for table in bootstrap.tables:
        out[list(table.part.joints)] = _slopes(table.table, group, settings.neighbours)
    return tuple(float(np.round(slope, 3)) for slope in np.clip(out, 0.0, 0.95))


def _slopes(table: walk.Table, group: Counts, neighbours: int) -> Float:
    """(J,) of the part's joints."""
    usual = np.flatnonzero((table.mode_before == 0) & (table.mode_after == 0))
    asked = np.random.default_rng(1).choice(usual, min(_ASKED, len(usual)), replace=False)
    near = walk.nearest(table, group, asked, neighbours)
    rows, ranks = np.nonzero(near >= 0)
    one, other = asked[rows], near[rows, ranks]
    before = table.residual_before[one] - table.residual_before[other]
    after = table.residual_after[one] - table.residual_after[other]
    ordinary = np.ones(before.shape[:2], np.bool_)
    for values in (table.residual_before, table.residual_after):
        ordinary &= (np.abs(values[one]) < _ORDINARY).all(axis=-1) & (np.abs(values[other]) < _ORDINARY).all(axis=-1)
    products, squares = ((ordinary[..., None] * before * values).sum(axis=(0, 2)) for values in (after, before))
    return np.where(squares > 0, products / np.maximum(squares, 1e-12), 0.0)


def remembered(settings: Settings, told: Told, made: Told) -> tuple[float, ...]:
    """(17,) `carry` for errors that remember the last picture as long as they should, by how long these did."""
    short = describe(told).memory[:, 0] - describe(made).memory[:, 0]
    return tuple(float(np.round(value, 3)) for value in np.clip(np.array(settings.carry) + np.nan_to_num(short), 0.0, 0.95))


def gains(told: Told, made: Told) -> tuple[float, ...]:
    """(17,) ratio of the sizes of residuals, as they are and as they were made: of the medians and of the ninth deciles."""
    sizes = []
    for streams in (told, made):
        found = np.concatenate([errors.found for _, errors in streams])
        residual = np.concatenate([np.linalg.norm(errors.residual, axis=-1) for _, errors in streams])[found]
        sizes.append(np.quantile(residual, (0.5, 0.9), axis=0))
    ratio = np.exp(np.log(sizes[0] / sizes[1]).mean(axis=0))
    return tuple(float(np.round(value, 3)) for value in np.clip(np.nan_to_num(ratio, nan=1.0), *_GAINS))
