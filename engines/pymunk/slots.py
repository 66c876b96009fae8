"""A slot in pymunk as methods for a page: a groove joint wherever the point is, and what is exact."""

from __future__ import annotations

from engines import Engine
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Pymunk
from engines.pymunk.extended import FIVE

# On a slider of its own, with the groove at its centre, both are the same; on the end of a rod the first is a trap.
GROOVE = Pymunk("slot: groove at the point", slot="groove")
GROOVE_TUNED = Pymunk("slot: groove at the point, tuned", "contraction", "contraction", slot="groove")
EXACT = Pymunk("slot: exact row", "contraction", "contraction", leapfrog=True)
GROOVE_EXTRAPOLATED = Extrapolated(
    Pymunk("slot: groove at the point", 10, 0.0, leapfrog=True, slot="groove"),
    "slot: groove at the point, extrapolated",
    levels=FIVE,
    powers=(2, 3, 4, 5),
)
METHODS: tuple[Engine, ...] = (GROOVE, GROOVE_TUNED, EXACT, GROOVE_EXTRAPOLATED)
