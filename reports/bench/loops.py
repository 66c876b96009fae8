"""What `run` costs over the bare stepping loop of the same engine, in process time."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from engines import Engine, Unsupported
from engines.entry_points import registered_by_key
from engines.loading import Kind
from reference.mechanism import Mechanism

BARE_LOOP = Kind("bare loop", lambda value: "" if callable(value) else "it can't be called")
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
    """For each engine that can build the mechanism and has a bare loop under `crosscheck.bare_loops`."""
    out = []
    steps = samples * every
    loops = registered_by_key("crosscheck.bare_loops", BARE_LOOP)
    for engine in engines:
        bare_loop = loops.get(engine.name)
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
