"""What rounding may do to a run, measured: the same engine from a start that is rounded otherwise."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np

from engines.altered import Altered
from reference.mechanism import Mechanism
from reports.grid.cells import Cell

# Starts that are tried.
SEEDS = (1, 2, 3)
EPSILON = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Nudge:
    """Every number of a start moved by one rounding up or down, or left; the same for a seed."""

    seed: int

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism from the nudged start."""
        signs = np.random.default_rng([self.seed, zlib.crc32(repr(mechanism.row_names).encode())])
        bodies = []
        for body in mechanism.bodies:
            pose, twist = (
                tuple(float(v * (1 + EPSILON * s)) for v, s in zip(values, signs.integers(-1, 2, 3), strict=True))
                for values in (body.pose, body.twist)
            )
            bodies.append(replace(body, pose=pose, twist=twist))
        return replace(mechanism, bodies=tuple(bodies))


def nudged_cells(cell: Cell) -> tuple[Cell, ...]:
    """The same cell from other roundings of its start."""
    return tuple(replace(cell, engine=Altered(cell.engine, Nudge(seed))) for seed in SEEDS)
