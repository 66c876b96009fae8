"""Arrays that can't fit are refused before they are made, in a sentence that names the bytes they would take."""

from __future__ import annotations

import math
from collections.abc import Sequence

from reference.checks import InvalidMechanism

# Far above what the scenes of this suite need, and what a machine of 8 GB still has room for together with the copies
# that linear algebra makes.
LARGEST = 2 * 2**30  # bytes


def require_room(what: str, shape: Sequence[int], size: int = 8, largest: int = LARGEST) -> None:
    """Raise InvalidMechanism if an array of this shape, with elements of `size` bytes, takes more than `largest`."""
    wanted = math.prod(shape) * size
    if wanted > largest:
        raise InvalidMechanism(
            f"{what} of the shape {tuple(shape)} would take {wanted:.3g} bytes; more than {largest:.3g} are refused"
        )
