"""How a file says what is measured in an attempt."""

from typing import Annotated, Final, Literal, get_args

import msgspec
from msgspec import UNSET, Meta, UnsetType

Phase = Literal["start", "exertion", "peak", "end"]
PHASES: Final[tuple[Phase, ...]] = get_args(Phase)
"""Keyframes of an attempt in their order; `models.motions.motion.Attempt` says what each is."""

Side = Literal["lead", "other", "both", "left", "right"]
"""Which limb: the one that throws, hits, kicks or leads; the other one; the mean of both; the body's own left or right."""

Take = Literal["at", "max", "min", "mean", "range", "change", "time_of_max", "time_of_min"]
"""One number of a signal: its value at a keyframe; or over a stretch its largest, smallest or mean value, the largest less the
smallest, the last less the first, or when it is largest or smallest, in seconds from the first keyframe of the stretch."""

_Word = Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,39}\Z")]
_FARTHEST_S: Final = 3.0
_INWARDS_S: Final = 0.5


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of every table of these files."""


class Measure(Table, frozen=True, kw_only=True):
    """A number that an attempt has: of a signal, which every frame has, or by a function of its own.

    Examples: `{signal = "knee_flexion", over = ["start", "peak"], take = "max"}`, `{signal = "trunk_forward", at = "peak"}`,
    `{signal = "wrist_height", side = "lead", at = "peak", shift_s = [0.1, 0.4], take = "min"}`, `{function = "jump_height"}`.
    """

    signal: Annotated[_Word | UnsetType, Meta(description="what is looked at in every frame; docs/measures.md has them all")] = (
        UNSET
    )
    function: Annotated[_Word | UnsetType, Meta(description="a measure that is no signal; docs/measures.md has them all")] = UNSET
    side: Annotated[Side, Meta(description="whose limb; of no account where there is but one")] = "both"
    at: Annotated[Phase | UnsetType, Meta(description="at this keyframe")] = UNSET
    over: Annotated[tuple[Phase, Phase] | UnsetType, Meta(description="from one keyframe to another")] = UNSET
    # Bounds are checked below: msgspec 0.22 mistakes the bounds of a number for the length of a tuple that may stand in its place.
    shift_s: Annotated[
        float | tuple[float, float],
        Meta(description="so many seconds after the keyframe, before it if negative; two numbers: from when to when"),
    ] = 0.0
    take: Annotated[Take, Meta(description="which number of the stretch")] = "at"

    def __post_init__(self) -> None:
        if (self.signal is UNSET) == (self.function is UNSET):
            raise ValueError("a measure has either a `signal` or a `function`")
        if self.function is not UNSET:
            if self.at is not UNSET or self.over is not UNSET or self.take != "at" or self.shift_s != 0.0:
                raise ValueError("a `function` looks at the whole attempt; leave out `at`, `over`, `shift_s` and `take`")
            return
        if (self.at is UNSET) == (self.over is UNSET):
            raise ValueError("a `signal` has either `at`, a keyframe, or `over`, two of them")
        if self.over is not UNSET and PHASES.index(self.over[0]) >= PHASES.index(self.over[1]):
            raise ValueError(f"`over` goes from one keyframe to a later one; their order is {', '.join(PHASES)}")
        shifts = self.shift_s if isinstance(self.shift_s, tuple) else (self.shift_s,)
        if not all(abs(shift_s) <= _FARTHEST_S for shift_s in shifts):
            raise ValueError(f"`shift_s` is at most {_FARTHEST_S:g} seconds")
        stretch = self.over is not UNSET or isinstance(self.shift_s, tuple)
        if stretch == (self.take == "at"):
            raise ValueError("`take` says which number of a stretch, such as max or mean; at one instant it is left out")
        if isinstance(self.shift_s, tuple):
            inwards_s = self.shift_s[0] - self.shift_s[1]
            if self.over is UNSET and inwards_s >= 0:
                raise ValueError("`shift_s` goes from an earlier instant to a later one")
            if inwards_s > _INWARDS_S:
                raise ValueError(f"`shift_s` takes more than {_INWARDS_S:g} seconds off `over`, so that often nothing is left")

    @property
    def stretch(self) -> tuple[Phase, float, Phase, float]:
        """From so many seconds after a keyframe to so many after another; both are the same for an instant. Not of a function."""
        if self.function is not UNSET:
            raise ValueError(f"{self.function} looks at the whole attempt")
        first, last = (self.at, self.at) if self.over is UNSET else self.over
        if first is UNSET or last is UNSET:
            raise ValueError("a signal has a keyframe")
        early_s, late_s = self.shift_s if isinstance(self.shift_s, tuple) else (self.shift_s, self.shift_s)
        return first, early_s, last, late_s
