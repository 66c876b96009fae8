"""The contract of an engine under test. The suite uses nothing else of an engine.

1. Write a frozen dataclass that inherits from `Engine`. Its fields are its settings; the report prints them. Settings,
   steps and counts that are invalid raise ValueError: inherit from `reference.checks.Valid` and decorate `build` and
   the call of a run with `validated`, so that the engine's own code does not abort the process.
2. Set `name` and `variant`. Together they name the method in the report. `variant` is any printable string that is not
   empty. Methods of one `family` share a colour and a marker in charts; the family is the name unless it is overridden.
3. Set `packages` to the installed packages, of Python or npm, whose versions the numbers depend on. The report prints
   these versions.
4. `build(mechanism, dt)` returns a `Run`: the model at t = 0 for steps of dt [s]. It raises `Unsupported`, with one
   sentence, for a mechanism that the engine cannot represent. No joint or force element may be left out: `capability`
   is the table of the elements that the engine builds, and `refuse_forces` is for an engine that has only gravity.
5. `run(samples, every)` takes `samples * every` steps and returns a `Trajectory` of samples + 1 states; state 0 is the
   start, and state k is that after `k * every` steps. Pose, twist and reaction of a state belong to the same instant.
   Reactions that the engine does not provide are NaN, at all samples of a row or only at the first. A run is called
   once.
6. `Trajectory.stepping` is the CPU time [s] of the stepping loop with the recording of states. It includes pilot runs
   that choose steps or iterations. It excludes building, and computing results from the recorded states.
7. `Trajectory.warnings` are `RunWarning`s or plain strings. `reset_at` [s] is the time at which the engine reset
   itself. A method that estimates its error sets `estimate`, and `unresolved_at` [s] to the time from which the
   estimate exceeds its claim. None of these ends the run. A method without an estimate claims an order, and no
   accuracy at a step.
8. `order(mechanism)` returns the expected convergence order of the errors as a `ConvergenceOrder`, which the gate
   checks, or `NotDeclared` with the reason. It depends only on the settings and the mechanism.
9. `step_cost(mechanism)` returns the approximate CPU time of a step [s]. It decides which small steps are run. It is a
   formula and not a measurement, so that the same steps are run on every machine.
10. `enforcement(joint, mechanism)` returns who enforces the joint: "engine" (a joint, contact or coordinate of the
   engine), "engine, our rows" (the engine's solver with rows that our code writes while it steps) or "ours" (our code
   alone, between steps of free bodies).
11. `regularisation(mechanism, dt)` returns the regularisation of the joints by the engine's settings, or None.
12. `instants`, `stricter`, `precision` and `angle_error` declare the law at one instant, the tolerance of the solver
   and the rounding. `crosscheck search` compares the engine with these declarations. By default an engine declares no
   law and no tolerance, and double precision.

The entry point of the group `crosscheck.bare_loops` with the engine's name is a function of (engine, mechanism, dt,
steps). It returns the CPU time [s] of that many steps without any recording, for `crosscheck bench`, and may raise
`Unsupported`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal, Protocol

import numpy as np

from engines.capability import Capability, Unsupported
from reference.checks import Count
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

# The order of a quantity without discretisation error, such as the gap of a joint in reduced coordinates.
EXACT = math.inf
# The claim of every method with an error estimate: errors of poses in rad, or relative to the mechanism's length.
CLAIM = 1e-7

Enforcement = Literal["engine", "engine, our rows", "ours"]


def refuse_forces(mechanism: Mechanism, engine: str) -> None:
    """Raise Unsupported for a mechanism with force elements: for an engine that has no force but gravity."""
    if mechanism.forces:
        force = mechanism.forces[0]
        kind, lacking = type(force).__name__, f"the adapter of {engine} knows no force but gravity"
        raise Unsupported(f"force {force.name!r} is a {kind}; {lacking}", engine=engine, kind=kind, lacking=lacking)


def unresolved(time: float, reason: str) -> RunWarning:
    """The warning of a run whose error may exceed its claim from `time` [s] on."""
    return RunWarning(f"ours: unresolved from {time:.4g} s on, {reason}", "unresolved", "adapter", time)


@dataclass(frozen=True)
class Size:
    """The size of a model, to be compared with the mechanism's.

    bodies: moving bodies
    coordinates: position coordinates that the engine integrates
    rows: scalar constraints that the engine enforces by forces
    solver_rows: rows in the engine's solver, empty ones included
    """

    bodies: int
    coordinates: int
    rows: int
    solver_rows: int


@dataclass(frozen=True)
class Regularisation:
    """Regularisation of the joints: J a = bias - damping * slip - stiffness * gap - compliance * A * reaction.

    stiffness [1/s^2], damping [1/s]
    compliance: relative to A, the row's inverse inertia J M^-1 J^T
    rows (rows,): the rows of the mechanism that are regularised; all others hold exactly
    complete: whether the law has `bias`, the term -(dJ/dt) v
    """

    stiffness: float
    damping: float
    compliance: float
    rows: tuple[bool, ...]
    complete: bool = True


@dataclass(frozen=True)
class ConvergenceOrder:
    """Expected convergence order of each error; EXACT (inf) where there is no discretisation error.

    order: of the poses, and of every quantity below that is None
    rate, gap, slip, energy: of these quantities
    reaction: of the reactions; NaN where the engine provides none
    integrator: of the time discretisation alone, where a regularisation that depends on the step sets the other orders
    differences: reactions are changes of velocity over dt / differences; 0 if the engine provides forces
    amplified: factor on the rounding of poses, velocities and energies, if several runs are combined
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
        field = {"angle": "order", "position": "order", "velocity": "rate"}.get(quantity, quantity)
        order = getattr(self, field)
        return self.order if order is None else order

    def step(self, quantity: str) -> float:
        """The order of a quantity by the time discretisation alone."""
        return self.of(quantity) if self.integrator is None else self.integrator


@dataclass(frozen=True)
class NotDeclared:
    """No order, or no law, is declared; `reason` is one sentence. Errors are then estimated from several step sizes."""

    reason: str


@dataclass(frozen=True, eq=False)
class Instant:
    """A result of the engine in one state, and the value that the law of its settings gives.

    check: "acceleration", "velocity" (after a step), "reaction", or a name of the engine's own for another law
    state: pose and twist (bodies, 3)
    found, expected: (bodies, 3), or (rows,) for reactions
    scales: arrays of that shape; the error is relative to the largest value in them and in `expected`
    """

    check: str
    state: tuple[np.ndarray, np.ndarray]
    found: np.ndarray
    expected: np.ndarray
    scales: tuple[np.ndarray, ...] = ()


class Run(Protocol):
    """A model that is ready to be stepped once."""

    @property
    def size(self) -> Size: ...
    def __call__(self, samples: Count, every: Count) -> Trajectory: ...


class OneShot:
    """The base class of a run, which refuses a second call."""

    _has_begun = False

    def begin(self) -> None:
        """Mark the run as called. Raises RuntimeError if it was called before."""
        if self._has_begun:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._has_begun = True


class Engine(ABC):
    """The base class of every engine, with the members of the contract and defaults for most of them.

    name, variant, packages: see sentences 2 and 3 of the contract
    modules: modules that are imported when the first mechanism is built, since the import takes seconds
    build_time: approximate CPU time to build a model [s], if it is more than milliseconds
    precision: relative rounding of the engine's numbers; 0 for double precision
    angle_error: error of angles that the engine measures between bodies, besides rounding [rad]
    forces_by: who evaluates the force elements
    capability: the table of the joints and force elements that it builds; None for an engine without a table
    """

    name: str
    variant: str
    packages: tuple[str, ...]
    modules: ClassVar[tuple[str, ...]] = ()
    build_time: ClassVar[float] = 0.0
    precision: ClassVar[float] = 0.0
    angle_error: ClassVar[float] = 0.0
    forces_by: ClassVar[Enforcement] = "engine"
    steps_in_child: ClassVar[bool] = False
    capability: ClassVar[Capability | None] = None

    @property
    def family(self) -> str:
        return self.name

    @property
    def absent_elements(self) -> frozenset[type]:
        """The classes of joints and force elements that the engine, by its documentation, does not have."""
        return self.capability.absent if self.capability else frozenset()

    @property
    def missing(self) -> str:
        """One sentence that says how to install a missing package; empty if nothing is missing."""
        return ""

    @property
    def uses_contacts(self) -> bool:
        """Whether rolls are contacts of shapes. Rounding then decides whether two shapes in touch have a contact."""
        return False

    def prepare(self) -> None:  # noqa: B027  (most engines have nothing to prepare)
        """Load or compile what a process needs once, so that it does not count as build time."""

    @abstractmethod
    def build(self, mechanism: Mechanism, dt: float) -> Run: ...

    @abstractmethod
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared: ...

    @abstractmethod
    def step_cost(self, mechanism: Mechanism) -> float: ...

    @abstractmethod
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement: ...

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """The regularisation of the joints by the settings; None if none is declared."""
        return None

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Results at the start and in the first `steps` steps of dt [s], with the values by the declared law.

        `built`: the mechanism of the model, if it differs from `mechanism` (in tests, by a deliberate mistake)
        """
        return NotDeclared("it declares no law of an instant")

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        """The same method with a far smaller solver tolerance; the difference estimates the solver's error."""
        return None

    def iterations_of(self, mechanism: Mechanism) -> int | None:
        """The number of Gauss-Seidel iterations over the joints in the first step; None for another solver."""
        return None

    def stepped(self, mechanism: Mechanism) -> Engine:
        """The engine that is stepped: the innermost one of a wrapper."""
        return self

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """The step of each inner run as a fraction of dt; (1.0,) for an engine without inner runs."""
        return (1.0,)


def method_name(engine: Engine) -> str:
    """The name of an engine's variant in every row, table and message."""
    return f"{engine.name} {engine.variant}"
