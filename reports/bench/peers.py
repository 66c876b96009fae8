"""The cheapest settings with which engines reach an error, timed in turn with the judge.

Each method of an engine is a ladder of settings: fixed steps that are halved, or tolerances that are divided by ten.
The motion has SAMPLES samples, and the error is the largest angle error at these samples. A ladder ends at the smallest
target, or before a run that would exceed the budget. Of all settings of an engine that reach a target, the cheapest one
is timed.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Unsupported, drake, exudyn, mujoco, pinocchio
from engines.lagrange import Lagrange
from engines.tree import spanning_tree
from reference.scene import Scene
from reference.scenes.andrews import Andrews
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import LongPendulum, TenLinks
from reference.scenes.person import TwoFeet
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import FreeSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer
from reports.bench.random_loops import RandomLoops
from reports.pages.speed.table import ABSENT, JUDGE, ONE_COORDINATE, REACHED, UNREACHED, UNSUPPORTED, SpeedRow
from reports.write.provenance import machine, row_versions

Array = NDArray[np.float64]

TARGETS = (1e-3, 1e-6, 1e-9)  # rad
SAMPLES = 10
MOST_HALVINGS = 17  # of the first step, which is a tenth of the motion
TOLERANCES = tuple(10.0**-power for power in range(1, 14))
# CPU time [s] that one run may take, and the same as a multiple of the judge's cheapest run with the smallest error.
BUDGET, BUDGET_OVER_JUDGE = 1.0, 100.0
# A shorter run [s] of a ladder is repeated this often, since the first one loads code and data into caches.
REPEATED, REPETITIONS = 0.01, 4
TURNS, LONG_TURNS = 7, 3  # repetitions of runs below and above LONG seconds
LONG = 0.2
REPLAYED = 100  # steps of a motion at whose states Pinocchio's evaluations are timed
PINOCCHIO_ALONE = "pinocchio, C++ alone"

SCENES: Mapping[str, Scene] = {
    "four-bar": FreeFourBar(),
    "slider-crank": FreeSliderCrank(),
    "n-four-bar-2": NFourBar(),
    "n-four-bar-10": TenFourBars(duration=2.0, horizon=2.0),
    "n-four-bar-40": FortyFourBars(duration=2.0, horizon=2.0),
    "andrews": Andrews(),
    "pendulum-10": TenLinks(),
    "pendulum-100": LongPendulum(links=100),
    "pendulum-1000": LongPendulum(links=1000),
    "sleigh": ChaplyginSleigh(),
    "car-and-trailer": CarAndTrailer(),
    "rolling-ellipse": RollingEllipse(),
    "two-feet": TwoFeet(),
    "random-loops": RandomLoops(),
}
QUICK = ("four-bar", "sleigh")


@dataclass(frozen=True)
class Setting:
    """A method at one step or tolerance.

    run: returns the angles (SAMPLES + 1, bodies) [rad] and the CPU time [s] of stepping.
    evaluations: the number of evaluations of accelerations by `run`, if the peer is Pinocchio.
    """

    words: str
    run: Callable[[], tuple[Array, float]]
    evaluations: int = 0


@dataclass(frozen=True)
class Ladder:
    """Settings from the coarsest to the finest, and the expected CPU time [s] of the first one."""

    settings: Iterator[Setting]
    expected: float = 0.0


@dataclass(frozen=True)
class Rung:
    """A setting that was run, with its largest angle error [rad] (NaN if the motion failed) and CPU time [s]."""

    setting: Setting
    error: float
    seconds: float


@dataclass(frozen=True)
class Peer:
    """An engine with its methods. `ladders` raises Unsupported if no method builds the scene."""

    name: str
    ladders: Callable[[Scene], Sequence[Ladder]]
    missing: str = ""


def climb(ladder: Ladder, truth: Array, targets: Iterable[float], budget: float) -> list[Rung]:
    """Run the settings until the error is below all targets, or until the next run would exceed the budget [s]."""
    rungs: list[Rung] = []
    if ladder.expected > budget:
        return rungs
    for setting in ladder.settings:
        angles, seconds = setting.run()
        if seconds < REPEATED:
            seconds = min(seconds, *(setting.run()[1] for _ in range(REPETITIONS)))
        with np.errstate(all="ignore"):
            rungs.append(Rung(setting, float(np.abs(angles - truth).max()), seconds))
        if rungs[-1].error <= min(targets) or 2 * seconds > budget:
            break
    return rungs


def cheapest(rungs: Iterable[Rung], target: float) -> Rung | None:
    """The cheapest setting with an error of at most the target, or None."""
    return min((rung for rung in rungs if rung.error <= target), key=lambda rung: rung.seconds, default=None)


def timed_in_turn(settings: Sequence[Setting], expected: float) -> list[float]:
    """The least CPU time [s] of each setting, where runs of the settings alternate."""
    turns = TURNS if expected < LONG else LONG_TURNS
    return np.min([[setting.run()[1] for setting in settings] for _ in range(turns)], axis=0).tolist()


def rows_of_peer(
    scene: str, peer: str, rungs: Sequence[Rung], judge: Sequence[Rung], targets: Iterable[float]
) -> list[SpeedRow]:
    """The rows of a peer whose ladders were run; settings that reach a target are timed in turn with the judge's."""
    rows = []
    for target in targets:
        found, own = cheapest(rungs, target), cheapest(judge, target)
        if found is None:
            usable = [rung for rung in rungs if math.isfinite(rung.error)]
            best = min(usable, key=lambda rung: rung.error, default=None)
            words, error = (best.setting.words, best.error) if best else ("", math.nan)
            spent = max((rung.seconds for rung in rungs), default=math.nan)
            own_seconds = own.seconds if own else math.nan
            note = "" if rungs else "the first run would exceed the budget"
            rows.append(SpeedRow(scene, peer, target, UNREACHED, words, error, spent, own_seconds, note))
            continue
        settings = [found.setting] if own is None else [found.setting, own.setting]
        seconds, *others = timed_in_turn(settings, found.seconds)
        own_seconds = others[0] if others else math.nan
        rows.append(SpeedRow(scene, peer, target, REACHED, found.setting.words, found.error, seconds, own_seconds))
    return rows


def measure_scene(
    name: str, scene: Scene, peers: Iterable[Peer], targets: Sequence[float] = TARGETS, budget: float = BUDGET
) -> list[SpeedRow]:
    """The rows of the judge, which is the first peer, and of all other peers. Missing peers have rows too."""
    truth = scene.motion(np.linspace(0, scene.duration, SAMPLES + 1)).pose[..., 2]
    rows: list[SpeedRow] = []
    judge: list[Rung] | None = None
    for peer in peers:
        if peer.missing:
            rows += [SpeedRow(name, peer.name, target, ABSENT, note=peer.missing) for target in targets]
            continue
        try:
            ladders = peer.ladders(scene)
        except Unsupported as reason:
            refused = (peer.name, PINOCCHIO_ALONE) if peer.name == "pinocchio" else (peer.name,)
            rows += [
                SpeedRow(name, who, target, UNSUPPORTED, note=str(reason)) for who in refused for target in targets
            ]
            continue
        rungs = [rung for ladder in ladders for rung in climb(ladder, truth, targets, budget)]
        if judge is None:
            judge = rungs
            reached = [rung.seconds for target in targets if (rung := cheapest(rungs, target)) is not None]
            budget = max(budget, BUDGET_OVER_JUDGE * max(reached, default=0.0))
        rows += rows_of_peer(name, peer.name, rungs, judge, targets)
        if peer.name == "pinocchio":
            alone = in_cpp_alone(scene, rungs)
            rows += rows_of_peer(name, PINOCCHIO_ALONE, alone, judge, targets)
    return rows


def by_steps(engine: Engine, scene: Scene) -> Ladder:
    """Halved fixed steps of an engine. Raises Unsupported if the engine doesn't build the scene."""
    mechanism, spacing = scene.mechanism(), scene.duration / SAMPLES
    pilot = engine.build(mechanism, spacing)(1, 1).stepping

    def run(every: int) -> tuple[Array, float]:
        motion = engine.build(mechanism, spacing / every)(SAMPLES, every)
        return motion.pose[..., 2], motion.stepping

    stages = 4 if getattr(engine, "integrator", "") == "rk4" else 1
    settings = (
        Setting(f"{engine.variant}, step {1e3 * spacing / every:.3g} ms", partial(run, every), every * SAMPLES * stages)
        for every in (2**power for power in range(MOST_HALVINGS))
    )
    return Ladder(settings, pilot * SAMPLES)


def by_tolerances(run: Callable[[float], tuple[Array, float]], words: str) -> Ladder:
    return Ladder(Setting(f"{words}, tolerance {value:.0e}", partial(run, value)) for value in TOLERANCES)


def of_judge(scene: Scene) -> list[Ladder]:
    mechanism, spacing = scene.mechanism(), scene.duration / SAMPLES

    def run(tolerance: float) -> tuple[Array, float]:
        motion = Lagrange(tolerance=tolerance).build(mechanism, spacing)(SAMPLES, 1)
        return motion.pose[..., 2], motion.stepping

    adaptive = by_tolerances(run, "dop853 projection adaptive")
    return [*(by_steps(engine, scene) for engine in (Lagrange(), Lagrange("rk4"))), adaptive]


def of_engine(methods: Sequence[Engine], scene: Scene) -> list[Ladder]:
    """The ladders of the methods that build the scene. Raises Unsupported if there are none."""
    ladders, reasons = [], []
    for method in methods:
        try:
            ladders.append(by_steps(method, scene))
        except Unsupported as reason:
            reasons.append(reason)
    if not ladders:
        raise reasons[0]
    return ladders


def of_one_coordinate(scene: Scene) -> list[Ladder]:
    """The ladder of the compiled four-bar."""
    assert isinstance(scene, FreeFourBar)  # `measure_peers` leaves out this peer for other scenes
    from reports.bench.one_coordinate import motion

    motion(scene, TOLERANCES[0], SAMPLES)  # compiles
    return [by_tolerances(lambda tolerance: motion(scene, tolerance, SAMPLES), "dop853 adaptive")]


# The error estimates of MuJoCo's extended variant are further runs, so they are switched off. Drake's CENIC is left
# out: it has first order, builds no loop of these scenes, and ends the process if its numbers are not finite.
METHODS: Mapping[str, Sequence[Engine]] = {
    "exudyn": exudyn.VARIANTS,
    "pinocchio": pinocchio.VARIANTS,
    "mujoco": (*mujoco.VARIANTS[:2], replace(mujoco.EXTENDED, estimates=False)),
    "drake": tuple(engine for engine in drake.VARIANTS if engine.variant != "cenic"),
}


def all_peers() -> tuple[Peer, ...]:
    """The judge, the solution in one coordinate, and the engines."""
    engines = (Peer(name, partial(of_engine, of_name), of_name[0].missing) for name, of_name in METHODS.items())
    return Peer(JUDGE, of_judge), Peer(ONE_COORDINATE, of_one_coordinate), *engines


PEERS = (ONE_COORDINATE, *METHODS)
LINES = (JUDGE, ONE_COORDINATE, "exudyn", "pinocchio", PINOCCHIO_ALONE, "mujoco", "drake")  # the order in the table


def facts(budget: float) -> dict[str, str]:
    """The date, the processor, the versions and the roofline, for the page. Needs numba."""
    from reports.bench.roofline import measure_roofline

    engines = [engine for methods in METHODS.values() for engine in methods]
    said = {
        "date": f"{datetime.now(UTC):%Y-%m-%d}",
        "machine": machine(),
        "versions": row_versions(Lagrange(), *engines),
    }
    return {**said, "budget": f"{budget:g}", **measure_roofline()}


def in_cpp_alone(scene: Scene, rungs: Iterable[Rung]) -> list[Rung]:
    """The rungs of Pinocchio with the CPU time of its own evaluations alone, without Python's integrator."""
    evaluate = evaluation_in_cpp(scene)

    def run(setting: Setting) -> tuple[Array, float]:
        return np.zeros(0), setting.evaluations * evaluate()

    once = evaluate()
    return [Rung(replace(r.setting, run=partial(run, r.setting)), r.error, r.setting.evaluations * once) for r in rungs]


def evaluation_in_cpp(scene: Scene) -> Callable[[], float]:
    """A function that measures the mean CPU time [s] of an evaluation by Pinocchio along the motion, without the call.

    The time of the call, with the conversion of its arguments, is that of the same function for a body on a pin, which
    overestimates it by less than a microsecond. Trees are evaluated by `aba`, and loops by `constraintDynamics`.
    """
    has_loops = bool(spanning_tree(scene.mechanism()).loops)
    whole, call = (_evaluations(measured, has_loops) for measured in (scene, BarPendulum(duration=1.0)))
    return lambda: max(0.0, whole() - call())


def _evaluations(scene: Scene, constrained: bool) -> Callable[[], float]:
    """A function that evaluates the states of a motion in REPLAYED steps of RK4, and returns the mean CPU time [s]."""
    tree = spanning_tree(scene.mechanism())
    model: Any = pinocchio.TUNED.model(tree.mechanism, scene.duration / REPLAYED)
    states: list[tuple[Array, Array]] = []

    def acceleration(position: Array, velocity: Array) -> Array:
        states.append((position, velocity))
        return model.acceleration(position, velocity)

    torque, position, velocity = np.zeros((3, tree.coordinates))
    velocity[model.address] = tree.start_rates()
    with np.errstate(all="ignore"):
        for _ in range(REPLAYED):
            position, velocity = pinocchio.runge_kutta_step(acceleration, position, velocity, model.dt)
    states = [state for state in states if np.isfinite(state).all()]
    function, further = model.pin.aba, ()
    if constrained:
        function, further = model.pin.constraintDynamics, (model.loops, model.loop_data, model.proximal)

    def run() -> float:
        begin = time.process_time()
        for position, velocity in states:
            function(model.model, model.data, position, velocity, torque, *further)
        return (time.process_time() - begin) / len(states)

    return run


def measure_peers(scenes: Iterable[str], engines: Iterable[str], budget: float = BUDGET) -> Iterator[list[SpeedRow]]:
    """The rows of each scene, for the judge and the peers with these names."""
    chosen = [peer for peer in all_peers() if peer.name in (JUDGE, *engines)]
    for name in scenes:
        scene = SCENES[name]
        usable = [peer for peer in chosen if peer.name != ONE_COORDINATE or isinstance(scene, FreeFourBar)]
        yield measure_scene(name, scene, usable, TARGETS, budget)
