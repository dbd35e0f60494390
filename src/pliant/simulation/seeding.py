"""One seed, one independent generator per source of randomness."""

from __future__ import annotations

import zlib

import numpy as np


def generator(seed: int, source: str) -> np.random.Generator:
    """The generator of one source, for example `noise.q`.

    Sources are identified by name, not by order: switching one off does not change the draws of the others.

    Args:
        seed: of the run, not negative.
        source: name of the source.
    """
    return np.random.default_rng(np.random.SeedSequence([seed, zlib.crc32(source.encode())]))
