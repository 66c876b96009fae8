"""What the judge costs: an evaluation, steps, long chains, and truths, in CPU time.

Each is the least of several runs, the first discarded. What is asked for stands beside it, from the goals that were set
for an ordinary core of 2025; nothing is asserted.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from engines import Engine
from engines.lagrange import Lagrange
from engines.lagrange.machine import Machine
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.many_links import LongPendulum
from reports.model.cells import FULL, Cell, estimated_cost
from reports.model.measure import measure

REPEATS = 7
LEVELS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # rad
COST_LIMIT = 0.3  # s that a cell may take: all levels are reached before


@dataclass(frozen=True)
class Figure:
    """A number measured, and the one asked for; NaN where none is."""

    what: str
    measured: float
    unit: str
    asked: float = np.nan


def figures(links: Iterable[int] = (100, 300, 1000)) -> list[Figure]:
    """An evaluation and a simulated second of the free four-bar, and steps of chains.

    Raises RuntimeError without numba.
    """
    scene = FreeFourBar(duration=1.0)
    mechanism = scene.mechanism()
    machine = Machine.of(mechanism) if Lagrange().in_machine_code else None
    if machine is None:
        raise RuntimeError("the figures are of compiled code: install numba, the extra 'fast'")
    out = [Figure("four-bar: one evaluation", 1e6 * _least(lambda: _evaluation(machine)), "us", 1.0)]
    # Steps of 1e-2 s are too long for the error asked for: 2e-11 rad is the method's own, of order 8. Half of that step
    # holds it, and so do steps of the method's own choice between samples as far apart.
    adapted = Lagrange(tolerance=1e-12)
    methods = ((Lagrange("rk4"), 10, 8.0), (Lagrange(), 1, 3.0), (Lagrange(), 2, 3.0), (adapted, 1, 3.0))
    for engine, every, asked in methods:
        step = f"step {1e-2 / every:g} s" if engine.tolerance is None else "samples 0.01 s apart"
        name = f"four-bar: a second by {engine.variant}, {step}"
        out.append(Figure(name, 1e3 * _least(_stepping(engine, mechanism, 1e-2, 100, every)), "ms", asked))
        run = engine.build(mechanism, 1e-2 / every)(100, every)
        error = np.abs(run.pose - scene.motion(run.t).pose)[..., 2].max()
        wanted = 1e-12 if engine.integrator == "dop853" else np.nan
        out.append(Figure(f"{name}: its error", float(error), "rad", wanted))
    for count in links:
        chain = LongPendulum(links=count, duration=0.2).mechanism()
        seconds = _least(_stepping(Lagrange("rk4"), chain, 5e-3, 1, 50)) / 50
        out.append(Figure(f"chain of {count} links: a step by rk4 projection", 1e3 * seconds, "ms", count / 1000))
    return out


@dataclass(frozen=True)
class Beside:
    """The least CPU time [s] a simulated second with which an error is reached, NaN where it isn't: ours, another's."""

    error: float
    own: float
    other: float
    method: str

    @property
    def factor(self) -> float:
        return self.other / self.own


def beside_others(scene: Scene, engines: Iterable[Engine], levels: Iterable[float] = LEVELS) -> list[Beside]:
    """The judge beside the fastest of the other engines, at each error [rad], all measured in this process."""
    cells = [Cell(scene, engine, every) for engine in engines for every in FULL]
    rows = [measure(cell) for cell in cells if estimated_cost(cell) <= COST_LIMIT]
    out = []
    for level in levels:
        reached = [row for row in rows if row.angle <= level]
        own = min((row.cpu for row in reached if row.engine == "lagrange"), default=np.nan)
        others = ((row.cpu, f"{row.engine} {row.variant}") for row in reached if row.engine != "lagrange")
        other, method = min(others, default=(np.nan, ""))
        out.append(Beside(level, own, other, method))
    return out


def truth_costs(scenes: Iterable[Scene]) -> list[tuple[Scene, float]]:
    """CPU seconds of the motions of scenes at all their samples, the dearest first; a scene without one is left out.

    To be asked first in a process: some motions are kept.
    """
    out = []
    for scene in scenes:
        begin = time.process_time()
        try:
            scene.motion(np.linspace(0, scene.duration, scene.samples + 1))
        except ValueError:
            continue
        out.append((scene, time.process_time() - begin))
    return sorted(out, key=lambda pair: -pair[1])


def _evaluation(machine: Machine, count: int = 2000) -> float:
    """CPU seconds of rows, bias, J M^-1 J^T, its factor, reactions and accelerations at the start."""
    poses, twists = machine.empty(count)
    poses[:], twists[:] = poses[0], twists[0]
    begin = time.process_time()
    machine.reactions(1e-3, poses, twists)
    return (time.process_time() - begin) / (count + 1)


def _stepping(engine: Engine, mechanism: Mechanism, spacing: float, samples: int, every: int) -> Callable[[], float]:
    """A function that gives the CPU seconds of a run."""
    return lambda: engine.build(mechanism, spacing / every)(samples, every).stepping


def _least(seconds: Callable[[], float]) -> float:
    seconds()
    return min(seconds() for _ in range(REPEATS))
