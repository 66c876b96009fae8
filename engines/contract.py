"""The contract of an engine under test: what the suite asks of it, and nothing else.

1. An engine is a frozen dataclass that inherits from `Engine`; its fields are its settings, printed in the report.
   `name` and `variant` together name a method there; a variant is a label of the user's choice: any string that is not
   empty and can be printed.
   Settings, steps and counts that can't be are refused by a ValueError, not by the engine's own abort:
   `reference.checks` does it for what inherits from `Valid`, and for `build` and `run` with `validated`.
2. `packages` are the installed distributions whose versions its numbers depend on; they are printed under the numbers.
   Engines of one `family` share a colour and a mark in charts: the variants of an engine are one family.
3. `build(mechanism, dt)` makes a model of the mechanism at t = 0 for steps of dt [s], or raises Unsupported with a
   sentence. It sees no scene, so it can't see the answer. A mechanism may have `forces` besides joints: an engine that
   knows none begins with `refuse_forces(mechanism, self.name)`.
4. `run(samples, every)` steps `samples * every` times and gives samples + 1 states, the first at t = 0. One shot: build
   again to repeat. Pose and twist belong to the same instant; reactions too, NaN where the engine can't tell: in all
   samples of a row, or in the first alone.
5. `Trajectory.stepping` is the CPU time of the stepping loop, recording included; reading it out afterwards is not.
   Rough runs that plan it, by which a method chooses its steps or sweeps, are part of it.
6. `Trajectory.reset_at` is the time at which the engine reset itself; `warnings` are its warnings, as `RunWarning`
   or as plain strings; `unresolved_at` is the time from which its own error estimate exceeds its claim. The run goes
   on in all three cases. A method without an estimate, such as a single run of documented settings, claims an order
   and no accuracy at a step.
7. `order(mechanism)` returns the expected order of its errors from its settings and the mechanism alone: a
   ConvergenceOrder, which the gate checks, or NotDeclared with the reason.
8. `step_cost(mechanism)` is about the CPU time of a step [s]. It decides which small steps are worth running, so it is
   a formula: the same on every machine.
9. `enforcement(joint, mechanism)` says who holds a joint: the engine by a joint, contact or coordinate of its own; the
   engine by rows that our code writes anew while it steps; or our code alone, between steps of free bodies.
10. `regularisation(mechanism, dt)` is the regularisation of its joints by its own settings: a Regularisation, or None.
11. `instants`, `stricter`, `precision` and `angle_error` declare the law of one instant, the tolerance of the solver
   and the rounding; `crosscheck search` holds the engine to them. Usual is: no law, no tolerance, double precision.

An entry point of the group `crosscheck.bare_loops`, by an engine's name, is a function of (engine, mechanism, dt,
steps) that returns the CPU seconds of that many steps with nothing read, for `crosscheck bench`. It may raise
Unsupported too. The class `Engine` has further members, with their usual answers.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from reference.checks import Count
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

# The order of an error that no step makes: a joint between coordinates that can't part, a motion that is prescribed.
EXACT = math.inf
# Claim of every method with an estimate: errors of poses in rad, or in the mechanism's length. Above, it is unresolved.
CLAIM = 1e-7

Enforcement = Literal["engine", "engine, our rows", "ours"]


def unresolved(time: float, reason: str) -> RunWarning:
    """The warning of a run that may exceed its claim from `time` [s] on."""
    return RunWarning(f"ours: unresolved from {time:.4g} s on, {reason}", "unresolved", "adapter", time)


class Unsupported(Exception):
    """An engine can't build this mechanism; the message is one sentence that says why."""


def refuse_forces(mechanism: Mechanism, engine: str) -> None:
    """Raise Unsupported for a mechanism with force elements: for an engine that knows no force but gravity."""
    if mechanism.forces:
        force = mechanism.forces[0]
        kind = type(force).__name__
        raise Unsupported(f"force {force.name!r} is a {kind}; the adapter of {engine} knows no force but gravity")


@dataclass(frozen=True)
class Size:
    """The size of a model, to be compared with the mechanism's."""

    bodies: int  # moving bodies
    coordinates: int  # position coordinates that the engine integrates
    rows: int  # scalar constraints that the engine holds by forces
    solver_rows: int  # rows in the engine's solver, empty ones included


@dataclass(frozen=True)
class Regularisation:
    """Regularisation of the joints: J a = bias - damping slip - stiffness gap - compliance A reaction.

    stiffness [1/s^2], damping [1/s]; compliance: a share of the row's own inverse inertia A. `rows`: which rows of the
    mechanism (rows,) are so, the others hold exactly. `complete`: whether `bias`, the term of the velocities, is there.
    """

    stiffness: float
    damping: float
    compliance: float
    rows: tuple[bool, ...]
    complete: bool = True


@dataclass(frozen=True)
class ConvergenceOrder:
    """Expected convergence order of each error; EXACT (inf) where there is no discretisation error.

    `order` is that of poses, and of the others unless they are given. `integrator`: the order of what the step alone
    costs, where a softness that is tied to the step sets the others. `differences`: reactions are a change of velocity
    over the step divided by this number; 0 where they are read as forces. `amplified`: how many times the usual
    rounding of poses, velocities and energies a combination of runs carries, and so that of reactions which are changes
    of velocity. `reaction` is NaN where the engine can't tell any.
    """

    order: float
    rate: float | None = None
    gap: float | None = None
    slip: float | None = None
    energy: float | None = None
    reaction: float | None = None
    integrator: float | None = None
    differences: int = 0
    amplified: float = 1.0

    def of(self, quantity: str) -> float:
        """The order of a quantity: angle, position, rate, velocity, gap, slip, energy or reaction."""
        name = {"angle": "order", "position": "order", "velocity": "rate"}.get(quantity, quantity)
        own = getattr(self, name)
        return self.order if own is None else own

    def step(self, quantity: str) -> float:
        """The order of what the step alone costs."""
        return self.of(quantity) if self.integrator is None else self.integrator


@dataclass(frozen=True)
class NotDeclared:
    """No order can be promised; `reason` is one sentence. Errors are bounded by differences between step sizes."""

    reason: str


@dataclass(frozen=True, eq=False)
class Instant:
    """What an engine computes in one state, and the value by the law of its settings.

    `check`: "acceleration", "velocity" (after a step) or "reaction", or a name of the engine's own for another law.
    `found` and `expected` are of the shape (bodies, 3), or (rows,) for reactions. `scales` are further arrays of such
    shapes: an error counts relative to the largest of them and of `expected`.
    """

    check: str
    state: tuple[np.ndarray, np.ndarray]  # pose and twist (bodies, 3)
    found: np.ndarray
    expected: np.ndarray
    scales: tuple[np.ndarray, ...] = ()


class Run(Protocol):
    """A built model, ready to be stepped once."""

    @property
    def size(self) -> Size: ...
    def __call__(self, samples: Count, every: Count) -> Trajectory: ...


class OneShot:
    """The base of a run that may be called once."""

    _over = False

    def begin(self) -> None:
        """Raises RuntimeError at the second call."""
        if self._over:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._over = True


class Engine(ABC):
    """The base of every engine: the members of the module's numbered contract, and usual answers for the others."""

    name: str
    variant: str
    packages: tuple[str, ...]
    # What an extra is imported by when its first mechanism is built, since some take seconds.
    modules: ClassVar[tuple[str, ...]] = ()
    # About how long a model takes to build [s], where that is no matter of milliseconds.
    build_time: ClassVar[float] = 0.0
    # The relative rounding of its numbers, where these are of less than double precision.
    precision: ClassVar[float] = 0.0
    # How far angles that it measures between bodies may be off [rad], beside rounding.
    angle_error: ClassVar[float] = 0.0
    # Who works out what springs, dampers and the like do.
    forces_by: ClassVar[Enforcement] = "engine"

    @property
    def family(self) -> str:
        return self.name

    @property
    def missing(self) -> str:
        """One sentence that says how to install what it needs; empty where that is there."""
        return ""

    @property
    def uses_contacts(self) -> bool:
        """Whether rolls are held by contacts of shapes: if two that just touch do, depends on rounding."""
        return False

    def prepare(self) -> None:  # noqa: B027  (most engines have nothing to prepare)
        """Load or compile what is needed once in a process, so that no build is timed with it."""

    @abstractmethod
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared: ...

    @abstractmethod
    def step_cost(self, mechanism: Mechanism) -> float: ...

    @abstractmethod
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement: ...

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """Nothing is declared that the judge could follow."""
        return None

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """What it computes at the start, or in its first `steps` steps of dt [s], beside the law that it declares.

        `built`: the mechanism that the model is made of, if it is another one: a test puts a mistake there.
        """
        return NotDeclared("it declares no law of an instant")

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        """The same method with a far smaller solver tolerance, whose difference is the declared error; or None."""
        return None

    def iterations_of(self, mechanism: Mechanism) -> int | None:
        """The Gauss-Seidel iterations over the joints in a step, as it starts; None for another solver."""
        return None

    def stepped(self, mechanism: Mechanism) -> Engine:
        """The engine that is stepped: inside of those that choose and combine others."""
        return self

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """Steps of the inner runs as fractions of dt; (1.0,) for one run."""
        return (1.0,)

    @abstractmethod
    def build(self, mechanism: Mechanism, dt: float) -> Run: ...


def method_name(engine: Engine) -> str:
    """The name of an engine's variant in every row, table and message."""
    return f"{engine.name} {engine.variant}"


def _forwarded(member: str) -> Any:
    """A property of the inner engine."""
    return property(lambda engine: getattr(engine.engine, member))


class EngineWrapper(Engine):
    """An engine around another one, `engine`, to which it forwards every member that it does not define itself."""

    engine: Engine

    def chosen(self, mechanism: Mechanism) -> Engine:
        """The inner engine that runs this mechanism, which may differ from `engine`."""
        return self.engine

    name: Any = _forwarded("name")
    packages: Any = _forwarded("packages")
    modules: Any = _forwarded("modules")  # pyright: ignore[reportIncompatibleVariableOverride]
    family: Any = _forwarded("family")
    missing: Any = _forwarded("missing")
    uses_contacts: Any = _forwarded("uses_contacts")
    precision: Any = _forwarded("precision")  # pyright: ignore[reportIncompatibleVariableOverride]
    angle_error: Any = _forwarded("angle_error")  # pyright: ignore[reportIncompatibleVariableOverride]

    def prepare(self) -> None:
        self.engine.prepare()

    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return self.chosen(mechanism).order(mechanism)

    def step_cost(self, mechanism: Mechanism) -> float:
        return self.chosen(mechanism).step_cost(mechanism)

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return self.chosen(mechanism).enforcement(joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        return self.chosen(mechanism).regularisation(mechanism, dt)

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        stricter = self.engine.stricter(mechanism)
        return None if stricter is None else replace(self, engine=stricter)  # type: ignore[type-var]

    def stepped(self, mechanism: Mechanism) -> Engine:
        return self.chosen(mechanism).stepped(mechanism)

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        return self.chosen(mechanism).inner_steps(mechanism)


# Tolerance on sample times, relative to dt: above rounding, far below half a step.
OFF = 1e-6

Flaw = tuple[str, str]  # the finding; the expectation


def flaw_of_shapes(run: Any, mechanism: Mechanism, samples: int) -> Flaw | None:
    """Why a run's answer is no Trajectory of samples + 1 poses, twists and reactions; None if it is one."""
    if not isinstance(run, Trajectory):
        return f"a {type(run).__name__}", "a Trajectory"
    count, motion = samples + 1, (samples + 1, len(mechanism.bodies), 3)
    shapes = {"t": (count,), "pose": motion, "twist": motion, "reaction": (count, mechanism.row_count)}
    for name, shape in shapes.items():
        if np.shape(getattr(run, name)) != shape:
            return f"{name} of the shape {np.shape(getattr(run, name))}", f"{shape}"
    for name, kind in (("warnings", tuple), ("reset_at", float), ("estimate", np.ndarray), ("unresolved_at", float)):
        value = getattr(run, name)
        if not isinstance(value, kind) and (value is not None or kind is tuple):
            return f"{name} of the type {type(value).__name__}", "what Trajectory says"
    return None


def flaw_of_times(run: Trajectory, dt: float, samples: int, every: int) -> Flaw | None:
    """How far a run's instants, of the right number, are from every `every` times dt [s] from 0 on; None if not."""
    off = float(np.max(np.abs(run.t - np.arange(samples + 1) * (every * dt))))
    summed = (samples * every) ** 2 * np.finfo(float).eps  # the rounding of a sum of n steps, of a step
    if off <= max(OFF, summed) * dt:
        return None
    return f"an instant that is {off:.3g} s off with {every} steps a sample", f"multiples of {every * dt:g} s"


def flaw_of_reactions(run: Trajectory) -> Flaw | None:
    """The first row whose reactions are numbers at some samples after the first and not at others; None if none is."""
    if not (np.isfinite(run.pose).all() and np.isfinite(run.twist).all()):
        return None  # it diverges, and its last states may be too large for a force
    known = np.isfinite(run.reaction[1:])
    rows = np.flatnonzero(known.any(axis=0) & ~known.all(axis=0))
    if not rows.size:
        return None
    at = run.t[1 + int(np.argmin(known[:, rows[0]]))]
    return f"no reaction of row {rows[0]} at {at:.4g} s", "a number at every sample after the first, or at none"


def flaw(run: Any, mechanism: Mechanism, dt: float, samples: int, every: int) -> str:
    """How a run's answer differs from sentences 4 and 5, one sentence; empty if it does not."""
    found = flaw_of_shapes(run, mechanism, samples) or flaw_of_times(run, dt, samples, every)
    if found is None and not (math.isfinite(run.stepping) and run.stepping >= 0):
        found = f"stepping = {run.stepping!r} s", "CPU seconds from 0 on"
    found = found or flaw_of_reactions(run)
    return f"its run gave {found[0]}; the contract of engines asks for {found[1]}" if found else ""
