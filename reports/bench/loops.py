"""What `run` costs over the bare stepping loop of the same engine, in process time."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass

from engines import Engine, Unsupported
from reference.mechanism import Mechanism

TURNS = 7  # of each, alternating, so that a slow spell of the machine meets both


@dataclass(frozen=True)
class LoopCost:
    """CPU seconds per step of `run` and of the bare loop, the least of TURNS each."""

    engine: Engine
    steps: int
    run: float
    bare: float

    @property
    def ratio(self) -> float:
        return self.run / self.bare


def loop_costs(engines: Iterable[Engine], mechanism: Mechanism, dt: float, samples: int, every: int) -> list[LoopCost]:
    """For each engine that can build the mechanism and whose module has `bare_loop(engine, mechanism, dt, steps)`."""
    out = []
    steps = samples * every
    for engine in engines:
        bare_loop = getattr(sys.modules[type(engine).__module__], "bare_loop", None) or getattr(
            sys.modules.get(f"engines.{engine.name}"), "bare_loop", None
        )
        if bare_loop is None:
            continue
        runs, bare = [], []
        try:
            for _ in range(TURNS):
                runs.append(engine.build(mechanism, dt)(samples, every).stepping)
                bare.append(bare_loop(engine, mechanism, dt, steps))
        except Unsupported:
            continue
        out.append(LoopCost(engine, steps, min(runs) / steps, min(bare) / steps))
    return out
