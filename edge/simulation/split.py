"""What is developed on and what is measured on never meet: every draw of the simulated gym comes from a stream of its split."""

import zlib
from typing import Final, Literal, get_args

import numpy as np

Split = Literal["development", "test"]
SPLITS: Final[tuple[Split, ...]] = get_args(Split)


def generator(split: Split, purpose: str, seed: int) -> np.random.Generator:
    """Random numbers that no other split, purpose or seed draws.

    Args:
        split: whom the draw is for.
        purpose: what is drawn, such as "rig corners".
        seed: not negative.
    """
    return np.random.default_rng((SPLITS.index(split), zlib.crc32(purpose.encode()), seed))
