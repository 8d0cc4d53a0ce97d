"""What was seen to go wrong, by stream and time: the entries of which the twin's errors are made, and their file.

The file holds situations and errors of rendered lessons and nothing of their pictures. Numbers are kept in a byte each: places to a
hundredth of the stature, residuals to a twentieth of their size (5 % of it, or half a millimetre), scores to 0.004.
"""

import io
import json
import zipfile
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from models.arrays import Float
from models.compiled import Counts
from models.errors import UserError
from tests.twin import context as contexts
from tests.twin import errors as errs
from tests.twin.context import Context
from tests.twin.errors import Errors
from tests.twin.truth import Stream

VERSION: Final = 1
DELAY_SHARES: Final = np.linspace(0.0, 1.0, 21)
_STEP_TOLERANCE: Final = 0.25
"""Share of the interval by which the time between two entries may differ from it."""

Bytes = npt.NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class Library:
    """Entries of all streams, one after another.

    Attributes:
        lessons: (S,) name of each stream's lesson.
        seeds: (S,) its seed.
        starts: (S + 1,) first entry of each stream.
        t_s: (m,) time of each entry in its lesson.
        context: of the m entries.
        errors: of the m entries.
        delays_s: quantiles, at `DELAY_SHARES`, of the time from exposure to arrival.
    """

    lessons: tuple[str, ...]
    seeds: tuple[int, ...]
    starts: Counts
    t_s: Float
    context: Context
    errors: Errors
    delays_s: Float

    def __len__(self) -> int:
        return len(self.t_s)

    @property
    def persons(self) -> int:
        """How many pupils are in it: one a seed."""
        return len(set(self.seeds))

    def person_of(self, entries: Counts) -> Counts:
        """(n,) number, below `persons`, of the pupil of each of these entries."""
        numbers = np.unique(np.array(self.seeds), return_inverse=True)[1]
        return np.asarray(numbers[np.searchsorted(self.starts, entries, side="right") - 1])

    def transitions(self, interval_s: float) -> tuple[Counts, Counts]:
        """Pairs of entries of one stream that are `interval_s` apart.

        Raises:
            UserError: no stream was inferred at such intervals.
        """
        firsts, seconds = [], []
        for start, stop in zip(self.starts[:-1], self.starts[1:], strict=True):
            t_s = self.t_s[start:stop]
            found = np.clip(np.searchsorted(t_s, t_s + interval_s - 1e-9), 1, max(len(t_s) - 1, 1))
            if len(t_s) < 2:
                continue
            target = t_s + interval_s
            nearest = np.where(target - t_s[found - 1] < t_s[found] - target, found - 1, found)
            fits = np.abs(t_s[nearest] - target) <= _STEP_TOLERANCE * interval_s
            fits &= nearest > np.arange(len(t_s))
            firsts.append(start + np.flatnonzero(fits))
            seconds.append(start + nearest[fits])
        if sum(map(len, firsts)) == 0:
            raise UserError(
                f"the twin knows no pictures {1e3 * interval_s:.0f} ms apart; fit it to lessons of that rate or ask for another"
            )
        return np.concatenate(firsts), np.concatenate(seconds)

    def without(self, seed: int) -> "Library":
        """Without the streams of one seed; for judging the rest by it."""
        return self._streams([index for index, own in enumerate(self.seeds) if own != seed])

    def _streams(self, kept: list[int]) -> "Library":
        entries = np.concatenate(
            [np.arange(self.starts[index], self.starts[index + 1]) for index in kept] or [np.zeros(0, np.int64)]
        )
        starts = np.cumsum([0] + [self.starts[index + 1] - self.starts[index] for index in kept])
        lessons, seeds = tuple(self.lessons[index] for index in kept), tuple(self.seeds[index] for index in kept)
        return Library(
            lessons, seeds, starts, self.t_s[entries], self.context.chosen(entries), self.errors.chosen(entries), self.delays_s
        )


def build(streams: list[Stream]) -> Library:
    """The library of these streams.

    Raises:
        UserError: there are none.
    """
    if not streams:
        raise UserError("the twin needs rendered lessons to be fitted to; make some with kinebox simulate")
    looked = [contexts.look(stream.truth) for stream in streams]
    errors = errs.together([errs.errors_of(frame, stream.said) for stream, (frame, _) in zip(streams, looked, strict=True)])
    delays = np.concatenate([stream.said.delay_s[stream.said.found] for stream in streams])
    library = Library(
        lessons=tuple(stream.lesson for stream in streams),
        seeds=tuple(stream.seed for stream in streams),
        starts=np.cumsum([0] + [len(stream.truth) for stream in streams]),
        t_s=np.concatenate([stream.truth.t_s for stream in streams]),
        context=contexts.together([context for _, context in looked]),
        errors=errors,
        delays_s=np.quantile(delays, DELAY_SHARES) if len(delays) else np.zeros(len(DELAY_SHARES)),
    )
    return decode(encode(library, {}), "the streams")[0]  # what is fitted is what the file will hold


_LIMITS: Final = {"pose": 1.5, "hidden": 1.0, "speed": 3.5, "view": 1.0}
_SMALL_RESIDUAL: Final = 0.002
_LARGEST_RESIDUAL: Final = 1.5
_SPREADS: Final = (-9.0, 1.0)


def encode(library: Library, settings: dict[str, Any]) -> bytes:
    """The file of a library and of the settings that were fitted with it."""
    context, errors = library.context, library.errors
    head = {
        "version": VERSION,
        "lessons": library.lessons,
        "seeds": library.seeds,
        "delays_s": [round(float(delay), 5) for delay in library.delays_s],
        "settings": settings,
    }
    largest = np.arcsinh(_LARGEST_RESIDUAL / _SMALL_RESIDUAL)
    arrays: dict[str, npt.NDArray[Any]] = {
        "head": np.frombuffer(json.dumps(head).encode(), np.uint8),
        "starts": library.starts.astype(np.int32),
        "t_s": library.t_s.astype(np.float32),
        **{name: _bytes(getattr(context, name), limit) for name, limit in _LIMITS.items()},
        "size": context.size.astype(np.float16),
        "extent": context.extent.astype(np.float16),
        "residual": _bytes(np.arcsinh(errors.residual / _SMALL_RESIDUAL), largest),
        "crossed": np.packbits(errors.crossed, axis=1),
        "score": _bytes(2 * errors.score - 1, 1.0),
        "spread": _bytes(errors.spread - sum(_SPREADS) / 2, (_SPREADS[1] - _SPREADS[0]) / 2),
        "found": np.packbits(errors.found),
        "renewed": np.packbits(errors.renewed),
    }
    file = io.BytesIO()
    np.savez_compressed(file, allow_pickle=False, **arrays)
    return file.getvalue()


def decode(data: bytes, origin: str) -> tuple[Library, dict[str, Any]]:
    """Read a file.

    Args:
        data: of the file.
        origin: its name, for error messages.

    Returns:
        The library and the settings.

    Raises:
        UserError: it is no such file, or of another version.
    """
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            arrays: dict[str, npt.NDArray[Any]] = dict(file)
        head = json.loads(arrays["head"].tobytes())
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise UserError(f"{origin} is no file of the twin; make it anew with make twin") from error
    if head.get("version") != VERSION:
        raise UserError(f"{origin} is of version {head.get('version')}, this twin reads {VERSION}; make it anew with make twin")
    count = len(arrays["t_s"])
    values = {name: _numbers(arrays[name], limit) for name, limit in _LIMITS.items()}
    context = Context(**values, size=arrays["size"].astype(np.float64), extent=arrays["extent"].astype(np.float64))
    largest = np.arcsinh(_LARGEST_RESIDUAL / _SMALL_RESIDUAL)
    errors = Errors(
        residual=_SMALL_RESIDUAL * np.sinh(_numbers(arrays["residual"], largest)),
        crossed=np.unpackbits(arrays["crossed"], axis=1, count=17).astype(np.bool_),
        score=np.clip((_numbers(arrays["score"], 1.0) + 1) / 2, 0.0, 1.0),
        spread=_numbers(arrays["spread"], (_SPREADS[1] - _SPREADS[0]) / 2) + sum(_SPREADS) / 2,
        found=np.unpackbits(arrays["found"], count=count).astype(np.bool_),
        renewed=np.unpackbits(arrays["renewed"], count=count).astype(np.bool_),
    )
    library = Library(
        lessons=tuple(head["lessons"]),
        seeds=tuple(head["seeds"]),
        starts=arrays["starts"].astype(np.int64),
        t_s=arrays["t_s"].astype(np.float64),
        context=context,
        errors=errors,
        delays_s=np.array(head["delays_s"]),
    )
    return library, head["settings"]


def _bytes(values: Float, limit: float) -> Bytes:
    return np.round(np.clip(values / limit, -1.0, 1.0) * 127).astype(np.int8)


def _numbers(values: npt.NDArray[Any], limit: float) -> Float:
    return values.astype(np.float64) * (limit / 127)
