"""Measurements of `crosscheck bench`: CPU times of engines, the judge and commands.

Times of loops, of the judge and of commands are minima of several runs.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from engines import Engine, Unsupported, method_name, registry
from engines.lagrange import Lagrange
from engines.lagrange.compiled_model import CompiledModel
from engines.loading import Kind, registered_by_key
from reference.scene import Scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.pendulum.scenes import LongPendulum
from reports.model.cells import Cell
from reports.model.ending import BadInput
from reports.model.measure import measure
from reports.model.spending import taken

BARE_LOOP = Kind("bare loop", lambda value: "" if callable(value) else "it can't be called")
TURNS = 7  # Number of runs of each loop. Two loops run alternately, so a slow period of the machine affects both.
COMMAND_TURNS = 3
ROOT = Path(__file__).resolve().parents[2]
Row = tuple[str, float, str]  # name, value, unit
WORLDS = Kind("program of many worlds", lambda value: "" if callable(value) else "it can't be called")
WORLD_COUNTS = (1, 64, 4096)
WORLD_STEP, WORLD_STEPS = 1e-3, 200  # [s]
WORLDS_COMPARED = 16  # with the judge, of many
WORLDS_LIMIT = 120.0  # s: a method that would take longer, by its speed with fewer worlds, is left out


@dataclass(frozen=True)
class WorldsCost:
    """Steps of one world per second, and the largest angle error [rad] at the end.

    The second is one of elapsed time, or of CPU time for the judge.
    """

    method: str
    worlds: int
    steps_per_second: float
    error: float


@dataclass(frozen=True)
class LoopCost:
    """CPU seconds per step of `run` and of a bare loop, as minima of TURNS runs."""

    engine: Engine
    steps: int
    run: float
    bare: float

    @property
    def ratio(self) -> float:
        return self.run / self.bare


def measure_loops(engines: Iterable[Engine], scene: Scene, every: int = 10) -> Iterator[LoopCost]:
    """The costs of each engine that can build the scene and has a bare loop (entry point `crosscheck.bare_loops`)."""
    mechanism, dt, steps = scene.mechanism(), scene.spacing / every, scene.samples * every
    loops = registered_by_key("crosscheck.bare_loops", BARE_LOOP)
    for engine in engines:
        if engine.name not in loops:
            continue
        runs, bare = [], []
        try:
            for _ in range(TURNS):
                runs.append(engine.build(mechanism, dt)(scene.samples, every).stepping)
                bare.append(loops[engine.name](engine, mechanism, dt, steps))
        except Unsupported:
            continue
        yield LoopCost(engine, steps, min(runs) / steps, min(bare) / steps)


def measure_grid(cells: Iterable[Cell]) -> dict[str, dict[str, float]]:
    """Run the cells sequentially in this process; return CPU seconds by part, by method and by scene."""
    out: dict[str, dict[str, float]] = {name: defaultdict(float) for name in ("part", "method", "scene")}
    taken()
    for cell in cells:
        begin = time.process_time()
        measure(cell)
        spent = time.process_time() - begin
        parts = dict(taken())
        parts["other"] = spent - sum(parts.values())
        for part, seconds in parts.items():
            out["part"][part] += seconds
        out["method"][method_name(cell.engine)] += spent
        out["scene"][cell.scene.name] += spent
    return out


def measure_judge(links: Sequence[int] = (100, 300, 1000), turns: int = TURNS) -> list[Row]:
    """CPU times of the judge for an evaluation, a four-bar and long chains. Raises BadInput without numba."""
    scene = FreeFourBar(duration=1.0)
    mechanism = scene.mechanism()
    model = CompiledModel.of(mechanism) if Lagrange().in_machine_code else None
    if model is None:
        raise BadInput("the judge is timed as compiled code: install numba, the extra 'fast'")
    rows = [("four-bar: one evaluation", 1e6 * least(lambda: _measure_evaluation(model), turns), "us")]
    # At order 8 the error is 1e-12 rad with steps of 5e-3 s. With steps of 1e-2 s the error is larger.
    for engine, every in ((Lagrange("rk4"), 10), (Lagrange(), 1), (Lagrange(), 2), (Lagrange(tolerance=1e-12), 1)):
        step = f"step {1e-2 / every:g} s" if engine.tolerance is None else "samples 0.01 s apart"
        name = f"four-bar: a second by {engine.variant}, {step}"
        run = engine.build(mechanism, 1e-2 / every)(100, every)
        error = float(np.abs(run.pose - scene.motion(run.t).pose)[..., 2].max())

        def step_it(engine: Engine = engine, every: int = every) -> float:
            return engine.build(mechanism, 1e-2 / every)(100, every).stepping

        rows += [(name, 1e3 * least(step_it, turns), "ms"), (f"{name}: its error", error, "rad")]
    for count in links:
        chain = LongPendulum(links=count, duration=0.2).mechanism()
        seconds = least(lambda chain=chain: Lagrange("rk4").build(chain, 1e-4)(1, 50).stepping, turns) / 50
        rows.append((f"chain of {count} links: a step by rk4 projection", 1e3 * seconds, "ms"))
    return rows


def measure_worlds(counts: Sequence[int] = WORLD_COUNTS, steps: int = WORLD_STEPS) -> list[WorldsCost]:
    """Worlds per second and errors of engines that step many worlds in one program (entry points `crosscheck.worlds`).

    Each world is a free four-bar with a coupler of its own length. The judge steps them one after another.
    """
    results = []
    programs = registered_by_key("crosscheck.worlds", WORLDS)
    for count in counts:
        couplers = np.linspace(1.0, 1.05, count) * FreeFourBar().coupler
        mechanisms = [FreeFourBar(coupler=float(coupler)).mechanism() for coupler in couplers]
        compared = range(0, count, max(1, count // WORLDS_COMPARED))
        judge = Lagrange("rk4")
        runs = [judge.build(mechanism, WORLD_STEP)(1, steps) for mechanism in mechanisms]
        truth = np.array([runs[world].pose[-1] for world in compared])
        elapsed = sum(run.stepping for run in runs)
        results.append(WorldsCost(method_name(judge), count, count * steps / elapsed, 0.0))
        for engine in registry.INSTALLED:
            before = [cost.steps_per_second for cost in results if cost.method == method_name(engine)]
            if engine.name in programs and not (before and count * steps > WORLDS_LIMIT * before[-1]):
                poses, elapsed = programs[engine.name](engine, mechanisms, WORLD_STEP, steps)
                error = float(np.abs(poses[list(compared)] - truth)[..., 2].max())
                results.append(WorldsCost(method_name(engine), count, count * steps / elapsed, error))
    return results


def measure_truths(scenes: Iterable[Scene]) -> list[Row]:
    """CPU seconds to compute the exact motions of scenes, in descending order.

    Call this function first in a process, since some motions are cached. Scenes without an exact motion are left out.
    """
    rows = []
    for scene in scenes:
        begin = time.process_time()
        try:
            scene.motion(np.linspace(0, scene.duration, scene.samples + 1))
        except ValueError:
            continue
        rows.append((f"truth of {scene!r}"[:100], time.process_time() - begin, "s"))
    return sorted(rows, key=lambda row: -row[1])


def _measure_evaluation(model: CompiledModel, count: int = 2000) -> float:
    """CPU seconds to compute the reactions and accelerations of the initial state once."""
    poses, twists = model.empty_samples(count)
    poses[:], twists[:] = poses[0], twists[0]
    begin = time.process_time()
    model.reactions(1e-3, poses, twists)
    return (time.process_time() - begin) / (count + 1)


def least(seconds: Callable[[], float], turns: int) -> float:
    """The least of several results, after a first call that loads code and data into caches."""
    seconds()
    return min(seconds() for _ in range(turns))


@dataclass(frozen=True)
class CommandCost:
    """Times of the fastest of COMMAND_TURNS runs of a command. Every run starts in an empty folder."""

    words: tuple[str, ...]
    wall: float  # Wall time [s].
    cpu: float  # CPU time [s].
    status: int


def measure_command(words: Sequence[str]) -> CommandCost:
    """Run `crosscheck WORDS` as a process and discard the output. The CPU time includes that of child processes."""
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    runs = []
    for _ in range(COMMAND_TURNS):
        with TemporaryDirectory() as folder:
            begin = time.monotonic()
            process = subprocess.Popen(
                [sys.executable, "-m", "reports", *words],
                cwd=folder,
                env=os.environ | {"PYTHONPATH": path},
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            runs.append((time.monotonic() - begin, usage.ru_utime + usage.ru_stime, process.returncode))
    return CommandCost(tuple(words), *min(runs))
