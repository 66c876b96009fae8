"""What rounding may do to a run, measured: the same engine from a start that is rounded otherwise."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np

from engines import Engine, Run
from reference.mechanism import Mechanism
from reports.grid.cells import Cell

# Starts that are tried.
SEEDS = (1, 2, 3)
EPSILON = float(np.finfo(float).eps)


def nudge(mechanism: Mechanism, seed: int) -> Mechanism:
    """The mechanism with every number of the start moved by one rounding up or down, or left; the same for a seed."""
    signs = np.random.default_rng([seed, zlib.crc32(repr(mechanism.row_names).encode())])
    bodies = []
    for body in mechanism.bodies:
        pose, twist = (
            tuple(float(v * (1 + EPSILON * s)) for v, s in zip(values, signs.integers(-1, 2, 3), strict=True))
            for values in (body.pose, body.twist)
        )
        bodies.append(replace(body, pose=pose, twist=twist))
    return replace(mechanism, bodies=tuple(bodies))


@dataclass(frozen=True)
class Nudged:
    """An engine in the sense of `engines.Engine` that starts the other from a nudged mechanism."""

    engine: Engine
    seed: int

    @property
    def name(self) -> str:
        return self.engine.name

    @property
    def variant(self) -> str:
        return self.engine.variant

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        """Raises whatever the engine raises."""
        return self.engine.build(nudge(mechanism, self.seed), dt)


def nudged_cells(cell: Cell) -> tuple[Cell, ...]:
    """The same cell from other roundings of its start."""
    return tuple(replace(cell, engine=Nudged(cell.engine, seed)) for seed in SEEDS)
