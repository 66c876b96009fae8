"""Measurements of `crosscheck bench`: CPU times of engines, the judge and commands.

Times of loops, of the judge and of commands are minima of several runs.
"""

from __future__ import annotations

import cmath
import os
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from engines import Engine, Unsupported, method_name, mujoco, registry
from engines.lagrange import Lagrange, ParameterSweep, run_batch
from engines.lagrange.compiled_model import CompiledModel
from engines.loading import Kind, registered_by_key
from reference.joints import Body, Pin
from reference.mechanism import Mechanism
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
STEP, SAMPLES, STEPS_PER_SAMPLE = 0.02, 10, 5  # a second in steps whose error is 1e-8 rad
RK4 = {engine.variant: engine for engine in mujoco.METHODS}["RK4 alone"]
TREE_STEP = 1e-4  # [s]


class WorldsCost(NamedTuple):
    """Steps of one world per second, and the largest angle error [rad] at the end.

    The second is one of elapsed time, or of CPU time for the judge.
    """

    method: str
    worlds: int
    steps_per_second: float
    error: float


class LoopCost(NamedTuple):
    """CPU seconds per step of `run` and of a bare loop, as minima of TURNS runs."""

    engine: Engine
    steps: int
    run: float
    bare: float


def measure_loops(engines: Iterable[Engine], scene: Scene, every: int = 10) -> Iterator[LoopCost]:
    """The costs of each engine that can build the scene and has a bare loop (entry point `crosscheck.bare_loops`)."""
    mechanism, dt, steps = scene.mechanism(), scene.spacing / every, scene.samples * every
    loops = registered_by_key("crosscheck.bare_loops", BARE_LOOP)
    for engine, loop in ((engine, loops[engine.name]) for engine in engines if engine.name in loops):
        with suppress(Unsupported):
            pairs = [
                (engine.build(mechanism, dt)(scene.samples, every).stepping, loop(engine, mechanism, dt, steps))
                for _ in range(TURNS)
            ]
            yield LoopCost(engine, steps, *(np.min(pairs, axis=0) / steps).tolist())


def measure_grid(cells: Iterable[Cell]) -> dict[str, dict[str, float]]:
    """Run the cells sequentially in this process; return CPU seconds by part, by method and by scene."""
    out: dict[str, dict[str, float]] = {name: defaultdict(float) for name in ("part", "method", "scene")}
    taken()
    for cell in cells:
        begin = time.process_time()
        measure(cell)
        spent = time.process_time() - begin
        parts = dict(taken())
        for part, seconds in {**parts, "other": spent - sum(parts.values())}.items():
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


def measure_batch(count: int = 20_000) -> list[Row]:
    """CPU times of four-bars with random bars for a second, in one loop and alone, and the largest difference."""
    mechanism, engine = FreeFourBar(duration=1.0).mechanism(), Lagrange()
    lengths = 0.4 * np.random.default_rng(0).uniform(0.95, 1.05, count)
    ends = np.stack([lengths / 2, 0 * lengths], axis=1)
    numbers = {"A.second_point": -ends, "B.first_point": ends, "crank.mass": lengths, "crank.inertia": lengths**3 / 12}
    begin = time.process_time()
    found = run_batch(engine, ParameterSweep(mechanism, numbers), STEP, SAMPLES, STEPS_PER_SAMPLE, workers=1)
    spent = time.process_time() - begin
    sweep, difference, alone = ParameterSweep(mechanism, numbers), 0.0, []
    for number in range(0, count, max(1, count // 20)):
        single = sweep.alone(number, found.pose[number, 0], found.twist[number, 0])
        run = engine.build(single, STEP)(SAMPLES, STEPS_PER_SAMPLE)
        alone.append(run.stepping)
        difference = max(difference, float(np.abs(run.pose - found.pose[number]).max()))
    name = "four-bar: a second by dop853 projection, step 0.02 s"
    return [
        (f"{name}, one of {count} with building and compilation", 1e6 * spent / count, "us"),
        (f"{name}, stepping alone", 1e6 * min(alone), "us"),
        ("four-bar: largest difference between the two", difference, "rad"),
    ]


def measure_trees(
    sizes: Sequence[int] = (10, 100, 1000, 10_000), branches: Sequence[int] = (2, 1), turns: int = 3
) -> Iterator[Row]:
    """CPU times of a step by RK4 with projection, and their ratio to MuJoCo's RK4.

    In a tree of n branches, n bars hang at the end of each bar. MuJoCo is left out for chains above 100 bars, since its
    step then costs the square of their number.
    """
    for branch in branches:
        for size in sizes:
            name = f"{'chain' if branch == 1 else f'tree of {branch} branches'} of {size} bars"
            mechanism, steps = make_tree(size, branch), max(3, 2000 // size)
            own = _step_seconds(Lagrange("rk4"), mechanism, steps, turns)
            yield f"{name}: a step by rk4 projection", 1e6 * own, "us"
            if branch > 1 or size <= 100:
                yield f"{name}: MuJoCo's RK4 over the judge", _step_seconds(RK4, mechanism, steps, turns) / own, "1"


def make_tree(size: int, branches: int) -> Mechanism:
    """Bars of 1 m and 1 kg; `branches` bars hang at the end of each bar, and the first one on the ground."""
    angles = [-1.57 + 0.1 * (bar % 7 - 3) for bar in range(size)]
    starts, bodies, pins = [0j], list[Body](), list[Pin]()
    for bar, angle in enumerate(angles):
        above = (bar - 1) // branches
        if bar:
            starts.append(starts[above] + cmath.rect(1.0, angles[above]))
        centre = starts[bar] + cmath.rect(0.5, angle)
        bodies.append(Body(f"bar {bar}", 1.0, 1 / 12, (centre.real, centre.imag, angle)))
        name, end = (f"bar {above}", (0.5, 0.0)) if bar else (None, (0.0, 0.0))
        pins.append(Pin(f"pin {bar}", name, f"bar {bar}", end, (-0.5, 0.0)))
    return Mechanism((*bodies,), (*pins,), (0.0, -9.81))


def _step_seconds(engine: Engine, mechanism: Mechanism, steps: int, turns: int) -> float:
    return min(engine.build(mechanism, TREE_STEP)(1, steps).stepping for _ in range(turns)) / steps


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


def measure_command(words: Sequence[str]) -> tuple[float, float, int]:
    """Run `crosscheck WORDS` COMMAND_TURNS times, each in an empty folder, and discard the output.

    Return the elapsed time [s], the CPU time with that of child processes [s], and the exit status of the fastest run.
    """
    import resource  # Windows has no such module

    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    command, runs = [sys.executable, "-m", "reports", *words], []
    for _ in range(COMMAND_TURNS):
        with TemporaryDirectory() as folder:
            begin, before = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
            ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            runs.append((time.monotonic() - begin, spent, ended.returncode))
    return min(runs)
