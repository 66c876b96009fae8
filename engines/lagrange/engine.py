"""Exact multipliers as an engine: its settings, its promises, and a run in compiled code or in numpy."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Annotated, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from engines import EXACT, ConvergenceOrder, Enforcement, Engine, NotDeclared, OneShot, Regularisation, Size
from engines.lagrange.compiled_model import CompiledModel, compile_functions, open_warning, stopped_warning
from engines.lagrange.dynamics import (
    FIXED_DOP853,
    NONE,
    PROJECTION_ITERATIONS,
    RK4,
    Dynamics,
    Step,
    adaptive,
    runge_kutta,
    semi_implicit_euler,
)
from engines.lagrange.loading import installed
from engines.motions import is_prescribed, over_three
from reference.checks import Count, InvalidMechanism, Positive, Valid, validated
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reference.validators import Rule

Array = NDArray[np.float64]
Integrator = Literal["euler", "rk4", "dop853"]
Stabilisation = Literal["none", "baumgarte", "projection"]
Tolerance = Annotated[float, Rule(lambda value: 1e-14 <= value < 1, "from 1e-14 to below 1")]

ORDERS: dict[Integrator, int] = {"euler": 1, "rk4": 4, "dop853": 8}
# Baumgarte's correction dies out over this many steps, the same rule as the tuned MuJoCo variant's time constant.
BAUMGARTE_STEPS = 5.0
# What a step of three bodies is counted as [s] when cells are chosen, by `compiled`: in machine code, and in numpy. The
# first took so long once and takes a third today; it stays, so that the grid keeps its cells.
STEP_COSTS: dict[bool, dict[Integrator, float]] = {
    True: {"euler": 4e-6, "rk4": 8e-6, "dop853": 2e-5},
    False: {"euler": 2e-4, "rk4": 6e-4, "dop853": 1.5e-3},
}

# What a projection may leave of speeds in a joint: half of the digits. Of slow motions, beside this part of the
# mechanism's length in its own time, no digits are counted. So it is of accelerations without a projection.
HALF, SLOW = 1.5e-8, 1e-4

TABLEAUS = {"euler": NONE, "rk4": RK4, "dop853": FIXED_DOP853}


@dataclass(frozen=True)
class Lagrange(Engine, Valid):
    """Ideal constraints by exact multipliers; raises ValueError for settings that don't exist.

    integrator: "euler" (semi-implicit, order 1), "rk4" (order 4), "dop853" (order 8), all with the given fixed step;
    stabilisation: "none" (the joints drift apart), "baumgarte" (a spring and damper tied to the step) or "projection".
    tolerance: for "dop853" alone, relative and absolute: the steps are then adapted between samples and dt only says
    where the samples stand. It is what one step may add: a run's error grows from it as any disturbance does, and shows
    in what another tolerance changes.
    compiled: in machine code where numba is installed; False: in numpy, which gives the same numbers up to rounding.
    """

    name = "lagrange"

    integrator: Integrator = "dop853"
    stabilisation: Stabilisation = "projection"
    tolerance: Tolerance | None = None
    compiled: bool = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.tolerance is not None and (self.integrator != "dop853" or self.stabilisation == "baumgarte"):
            raise InvalidMechanism(
                "lagrange: a tolerance goes with dop853, without baumgarte: only those adapt their steps"
            )

    @property
    def packages(self) -> tuple[str, ...]:  # pyright: ignore[reportIncompatibleVariableOverride]
        return ("numpy", "scipy", "numba") if self.in_machine_code else ("numpy", "scipy")

    @property
    def in_machine_code(self) -> bool:
        """Whether runs are compiled."""
        return self.compiled and installed()

    def prepare(self) -> None:
        """Have the machine code read, or compiled where that is not done: ten seconds that belong to no model."""
        if self.in_machine_code:
            compile_functions(self.tolerance is not None)

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The integrator's; a projection leaves no gap, and all of the motion is its own where nothing is free.

        Baumgarte's spring is tied to the step, and turns a gap into an acceleration divided by the step squared: that
        costs two orders, and the reactions all.
        """
        if self.tolerance is not None:
            return NotDeclared("its steps are its own: the error is that of its tolerance, whatever the step asked for")
        order, prescribed = ORDERS[self.integrator], is_prescribed(mechanism)
        match self.stabilisation:
            case "projection":
                return ConvergenceOrder(EXACT) if prescribed else ConvergenceOrder(order, gap=EXACT, slip=EXACT)
            case "baumgarte" if order == 1:
                return (
                    ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1)
                    if prescribed
                    else ConvergenceOrder(1, gap=2)
                )
            case "baumgarte" if order == 4:
                return ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=0)
            case "baumgarte":
                return ConvergenceOrder(order - 2)
        return ConvergenceOrder(order)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s] where numba is installed: the same where it is not, as it says what is worth
        running, and the grid is to have the same cells everywhere.
        """
        return STEP_COSTS[self.compiled][self.integrator] * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """This engine is nothing but the ideal constraint."""
        return "engine"

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        adaptive, slow = " adaptive" * (self.tolerance is not None), " in numpy" * (not self.compiled)
        return f"{self.integrator} {self.stabilisation}{adaptive}{slow}"

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """Baumgarte's spring and damper in every row, critically damped; None for the other methods."""
        if self.stabilisation != "baumgarte":
            return None
        rate = 1 / (BAUMGARTE_STEPS * dt)
        return Regularisation(rate**2, 2 * rate, 0.0, (True,) * mechanism.row_count)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> _LagrangeRun:
        """A run with steps of dt [s]; raises ValueError for a step that is not a finite time above zero."""
        return _LagrangeRun(self, mechanism, dt)


class _LagrangeRun(OneShot):
    def __init__(self, engine: Lagrange, mechanism: Mechanism, dt: float) -> None:
        self._engine, self._mechanism, self._dt = engine, mechanism, dt
        self._softness = engine.regularisation(mechanism, dt)
        self._machine = CompiledModel.of(mechanism) if engine.in_machine_code else None
        engine.prepare()
        if self._machine is not None and self._softness is not None:
            self._machine.regularise(self._softness, np.ones(mechanism.row_count, dtype=bool))
        self._dynamics = Dynamics(mechanism, self._softness) if self._machine is None else None
        count = len(mechanism.bodies)
        self.size = Size(count, 3 * count, mechanism.row_count, mechanism.row_count)

    @property
    def dynamics(self) -> Dynamics:
        """The mechanism in numpy, made where compiled code has no say."""
        if self._dynamics is None:
            self._dynamics = Dynamics(self._mechanism, self._softness)
        return self._dynamics

    def _step(self) -> Step:
        if self._engine.tolerance is not None:
            return adaptive(self.dynamics, self._engine.tolerance)
        if self._engine.integrator == "euler":
            return semi_implicit_euler(self.dynamics)
        return runge_kutta(self.dynamics, TABLEAUS[self._engine.integrator])

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        """Raises ValueError for counts that are not whole numbers above zero, RuntimeError at the second call."""
        self._mechanism.require_room(samples)
        self.begin()
        shape = (samples + 1, *self._mechanism.pose.shape)
        t = np.arange(samples + 1, dtype=np.float64) * (every * self._dt)
        started = time.process_time()
        with np.errstate(all="ignore"):  # a diverging run is a result, told by its numbers
            if self._machine is None:
                poses, twists = np.full((2, *shape), np.nan)
                poses[0], twists[0] = self._mechanism.pose, self._mechanism.twist
                self._in_numpy(poses, twists, 0, every)
                stepping, warnings = time.process_time() - started, ()
            else:
                columns, fast = self._machine.empty_samples(samples)
                done = self._in_machine_code(self._machine, columns, fast, every)
                poses, twists = (part[:, :-3].reshape(shape) for part in (columns, fast))
                if self._machine.lacks_contact:
                    self._in_numpy(poses, twists, done, every)
                stepping = time.process_time() - started
                warnings = self._machine.warnings(self._engine.tolerance)
            reactions, accelerations = self._reactions(t, poses, twists)
            warnings = warnings or self._stopped(t, poses)
            if not warnings and self._engine.stabilisation == "projection":
                warnings = self._slipped(t, poses, twists)
            elif not warnings:
                warnings = self._pushed(t, poses, twists, accelerations)
            return Trajectory(t, poses, twists, reactions, stepping, warnings)

    def _stopped(self, t: Array, poses: Array) -> tuple[str, ...]:
        """What is to be said of a run that did not come to its end, or of which numpy left joints open."""
        if self._dynamics is not None and not np.isnan(self._dynamics.unclosed):
            return (open_warning(self._dynamics.unclosed),)
        ended = np.all(np.isfinite(poses), axis=(1, 2))
        return () if ended[-1] else (stopped_warning(self._engine.tolerance, float(t[int(np.argmin(ended)) - 1])),)

    def _slipped(self, t: Array, poses: Array, twists: Array) -> tuple[str, ...]:
        """What is to be said where joints slip after a projection: then one of their rows was left out.

        J M^-1 J^T keeps few digits of the mass of a body that is far from its joint, beside its radius of gyration:
        below its rounding a row is not told from one that follows from others.
        """
        mechanism = self._mechanism
        slow = SLOW * mechanism.length_scale / mechanism.time_scale
        slips = self._beyond(mechanism.slip(poses, twists), twists, slow, HALF)
        return _row_lost("joints slip after the projection", t[1:][slips[1:]])

    def _pushed(self, t: Array, poses: Array, twists: Array, accelerations: Array) -> tuple[str, ...]:
        """The same without a projection, where speeds slip as the integrator lets them: accelerations then do not do
        what rows ask of them. Tables of curves are those of curves that touch, which they surely do at the start."""
        mechanism, softness = self._mechanism, self._softness
        if any(isinstance(joint, Roll) for joint in mechanism.joints):
            t, poses, twists, accelerations = t[:1], poses[:1], twists[:1], accelerations[:1]
        missing = mechanism.slip(poses, accelerations) + mechanism.rate - mechanism.bias(poses, twists)
        if softness is not None:
            gap = np.where(mechanism.holonomic, mechanism.gap(poses, t), 0.0)
            missing += softness.damping * mechanism.slip(poses, twists) + softness.stiffness * gap
        slow = SLOW * mechanism.length_scale / mechanism.time_scale**2
        return _row_lost("accelerations open joints", t[self._beyond(missing, accelerations, slow, HALF)])

    def _beyond(self, rows: Array, rates: Array, slow: float, part: float) -> NDArray[np.bool_]:
        """(times,) where a row is more than this part of the largest rate, each as of a length; `slow` is let pass."""
        mechanism = self._mechanism
        size = np.array([1.0, 1.0, mechanism.length_scale])
        row = np.abs(rows) * np.where(mechanism.is_angular, mechanism.length_scale, 1.0)
        return row.max(axis=1, initial=0.0) > part * (np.abs(rates * size).max(axis=(1, 2)) + slow)

    def _in_machine_code(self, machine: CompiledModel, poses: Array, twists: Array, every: int) -> int:
        """Fill samples; gives the last that is done."""
        if self._engine.tolerance is not None:
            return machine.adaptive_steps(self._engine.tolerance, self._dt * every, 0, poses, twists)
        project = PROJECTION_ITERATIONS if self._engine.stabilisation == "projection" else 0
        return machine.fixed_steps(TABLEAUS[self._engine.integrator], project, self._dt, every, 0, poses, twists)

    def _in_numpy(self, poses: Array, twists: Array, begin: int, every: int) -> None:
        """Fill samples from one on that is there."""
        step, pose, twist = self._step(), poses[begin], twists[begin]
        steps, dt = (1, self._dt * every) if self._engine.tolerance is not None else (every, self._dt)
        for sample in range(begin, len(poses) - 1):
            for i in range(steps):
                t = (sample * steps + i) * dt
                pose, twist = step(pose, twist, t, dt)
                if self._engine.stabilisation == "projection":
                    pose, twist = self.dynamics.project(pose, twist, t + dt)
            if not np.all(np.isfinite(pose)):
                return
            poses[sample + 1], twists[sample + 1] = pose, twist

    def _reactions(self, t: Array, poses: Array, twists: Array) -> tuple[Array, Array]:
        """Of every sample (samples, rows), and the accelerations (samples, bodies, 3); NaN where the motion is lost.

        Where rows are dependent reactions are the smallest, as `Mechanism.reaction` has them.
        """
        mechanism = self._mechanism
        reactions, accelerations = np.full((len(t), mechanism.row_count), np.nan), np.full_like(poses, np.nan)
        alive = np.all(np.isfinite(poses) & np.isfinite(twists), axis=(1, 2))
        if not mechanism.row_count or not np.any(alive):
            return reactions, accelerations
        if self._machine is not None:
            last = len(t) - int(np.argmax(alive[::-1]))
            parts = (np.zeros((last, 3 * len(mechanism.bodies) + 3)) for _ in range(2))
            columns, fast = parts
            columns[:, :-3], fast[:, :-3] = poses[:last].reshape(last, -1), twists[:last].reshape(last, -1)
            reactions[:last], accelerations[:last] = self._machine.reactions(float(t[1]), columns, fast)
            if not self._machine.lacks_contact:
                if self._machine.has_dependent_rows:
                    reactions[:last] = mechanism.reaction(poses[:last], accelerations[:last], twist=twists[:last])
                return reactions, accelerations
        for at in np.flatnonzero(alive):
            rows, reactions[at] = self.dynamics.reaction(poses[at], twists[at], t[at])
            accelerations[at] = self.dynamics.under(rows, reactions[at], poses[at], twists[at])
        if self.dynamics.redundant:
            reactions[alive] = mechanism.reaction(poses[alive], accelerations[alive], twist=twists[alive])
        return reactions, accelerations


def _row_lost(what: str, times: Array) -> tuple[str, ...]:
    if not len(times):
        return ()
    return (
        f"lagrange: at {times[0]:.6g} s {what}: masses, or an arm and a radius of gyration, are so far apart that a "
        "row is lost beside others, or the position is singular",
    )


METHODS = tuple(
    Lagrange(integrator, stabilisation)
    for integrator in get_args(Integrator)
    for stabilisation in get_args(Stabilisation)
)
# For every scene: orders 1, 4 and 8.
VARIANTS = (Lagrange("euler", "projection"), Lagrange("rk4", "projection"), Lagrange("dop853", "projection"))
