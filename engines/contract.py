"""The contract of an engine under test. The suite uses only these members of an engine.

1. Write a frozen dataclass that inherits from `Engine`. The dataclass has the engine's settings as fields, which the
   report prints. Inherit from `reference.checks.Valid`, and decorate `build` and the call of a run with `validated`.
   Invalid settings, steps and counts then raise ValueError and do not reach the engine's code.
2. Set `name` and `variant`, which together name the method in the report. `variant` is any printable string that is not
   empty. Methods of one `family` share a colour and a marker in charts. By default `family` is equal to `name`.
3. Set `packages` to the packages of Python or npm whose code computes the numbers. The report prints their versions.
4. `build(mechanism, dt)` returns a `Run`, which is the model at t = 0 for steps of dt [s]. If the engine cannot
   represent the mechanism, `build` raises `Unsupported` with one sentence. A model must not leave out a joint or force
   element. `capability` is the table of the elements that the engine builds. An engine that has only gravity calls
   `refuse_forces`.
5. `run(samples, every)` takes `samples * every` steps and returns a `Trajectory` of samples + 1 states. State 0 is the
   start, and the engine reaches state k after `k * every` steps. Pose, twist and reaction of a state belong to the same
   instant. If the engine does not provide the reactions of a row, they are NaN at all samples, or at the first sample
   alone. A run can be called only once.
6. `Trajectory.stepping` is the CPU time [s] of stepping and recording states. The CPU time includes pilot runs that
   choose steps or iterations, but not the building of the model and the evaluation of the recorded states.
7. `Trajectory.warnings` are `RunWarning`s or plain strings. `reset_at` [s] is the time at which the engine reset
   itself. A method that estimates its error sets `estimate`. From `unresolved_at` [s] on, the estimate exceeds the
   method's claim. The run continues after all these events. A method without an estimate claims only an order.
8. `order(mechanism)` returns the expected convergence order of the errors as a `ConvergenceOrder`, which the gate
   checks, or `NotDeclared` with the reason. The order depends only on the settings and the mechanism.
9. `step_cost(mechanism)` returns the approximate CPU time of a step [s], which decides how small steps may be.
   `step_cost` is a formula and no measurement, so that all machines run the same steps.
10. `enforcement(joint, mechanism)` returns which code enforces the joint. "engine" means a joint, contact or coordinate
   of the engine. "engine, our rows" means the engine's solver with rows that our code writes during the steps. "ours"
   means that our code alone enforces the joint between steps of free bodies.
11. `regularisation(mechanism, dt)` returns how the engine's settings regularise the joints, or None.
12. `instants` declares the law of the joints, `stricter` the solver's tolerance, `precision` and `angle_error` the
   rounding. `crosscheck search` compares the engine with these declarations. By default an engine declares double
   precision, but no law and no tolerance.

An engine may have an entry point of its name in the group `crosscheck.bare_loops`. The entry point is a function of
(engine, mechanism, dt, steps). For `crosscheck bench` it returns the CPU time [s] of the steps without any recording,
or raises `Unsupported`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal, Protocol

import numpy as np

from engines.capability import Capability, Unsupported
from reference.checks import Count
from reference.joints import Joint
from reference.mechanism import Mechanism
from reference.trajectory import RunWarning, Trajectory

# The order of a quantity without discretisation error, for example the gap of a joint in reduced coordinates.
EXACT = math.inf
# A method with an error estimate claims this largest error of poses, in rad or relative to the mechanism's length.
CLAIM = 1e-7
SINGLE_PRECISION = 2.0**-23  # `Engine.precision` of an engine that computes in single precision

Enforcement = Literal["engine", "engine, our rows", "ours"]


def refuse_forces(mechanism: Mechanism, engine: str) -> None:
    """Raise Unsupported for force elements, since the engine has no force but gravity."""
    if mechanism.forces:
        force = mechanism.forces[0]
        kind, lacking = type(force).__name__, f"the adapter of {engine} knows no force but gravity"
        raise Unsupported(f"force {force.name!r} is a {kind}; {lacking}", engine=engine, kind=kind, lacking=lacking)


def unresolved(time: float, reason: str) -> RunWarning:
    """The warning that the error of a run may exceed the claim from `time` [s] on."""
    return RunWarning(f"ours: unresolved from {time:.4g} s on, {reason}", "unresolved", "adapter", time)


@dataclass(frozen=True)
class Size:
    """The size of an engine's model.

    bodies: number of moving bodies.
    coordinates: number of position coordinates that the engine integrates.
    rows: number of scalar constraints that the engine enforces by forces.
    solver_rows: number of rows in the engine's solver, including empty rows.
    """

    bodies: int
    coordinates: int
    rows: int
    solver_rows: int


@dataclass(frozen=True)
class Regularisation:
    """Regularised joints: J a = bias - damping * slip - stiffness * gap - compliance * A * reaction.

    stiffness [1/s^2], damping [1/s]
    compliance: factor on A, the row's inverse inertia J M^-1 J^T.
    rows (rows,): whether a row of the mechanism is regularised; the engine satisfies the other rows exactly.
    complete: whether the law contains `bias`, which is -(dJ/dt) v.
    """

    stiffness: float
    damping: float
    compliance: float
    rows: tuple[bool, ...]
    complete: bool = True


@dataclass(frozen=True)
class ConvergenceOrder:
    """Expected convergence order of each error; EXACT (inf) where there is no discretisation error.

    order: order of the poses, and of each quantity below whose field is None.
    rate, gap, slip, energy: orders of these quantities.
    reaction: order of the reactions, or NaN if the engine provides no reactions.
    integrator: order of the integrator, if a regularisation that depends on the step determines the other orders.
    differences: 0 if the engine provides forces; otherwise reactions are changes of velocity over dt / differences.
    amplified: factor on the rounding errors of poses, velocities and energies in a combination of runs.
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
        """The order of an angle, position, rate, velocity, gap, slip, energy or reaction."""
        field = {"angle": "order", "position": "order", "velocity": "rate"}.get(quantity, quantity)
        order = getattr(self, field)
        return self.order if order is None else order

    def step(self, quantity: str) -> float:
        """The order of a quantity that the integrator alone would have."""
        return self.of(quantity) if self.integrator is None else self.integrator


@dataclass(frozen=True)
class NotDeclared:
    reason: str


@dataclass(frozen=True, eq=False)
class Instant:
    """A result of the engine in one state, and its expected value by the declared law.

    check: "acceleration", "velocity" (after a step), "reaction", or another name that the engine chooses.
    state: pose and twist (bodies, 3).
    found, expected: (bodies, 3), or (rows,) for reactions.
    scales: arrays of the same shape; errors are relative to the largest value in `scales` and `expected`.
    """

    check: str
    state: tuple[np.ndarray, np.ndarray]
    found: np.ndarray
    expected: np.ndarray
    scales: tuple[np.ndarray, ...] = ()


class Run(Protocol):
    @property
    def size(self) -> Size: ...
    def __call__(self, samples: Count, every: Count) -> Trajectory: ...


class OneShot:
    """The base class of a run, which refuses a second call."""

    _has_begun = False

    def begin(self) -> None:
        if self._has_begun:
            raise RuntimeError("this run is over: a run is one shot, build the engine again to repeat it")
        self._has_begun = True


class Engine(ABC):
    """The base class of every engine: the members of the contract, most of which have a default.

    name, variant, packages: see items 2 and 3 of the contract.
    modules: slow modules, which are imported when the first mechanism is built.
    build_time: approximate CPU time to build a model [s]; 0 for a few milliseconds.
    precision: relative rounding of the engine's numbers; 0 for double precision.
    angle_error: error of the engine's angles between bodies, in addition to rounding [rad].
    forces_by: who evaluates the force elements.
    capability: the joints and force elements that the engine builds, or None for an engine without such a table.
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
        """Classes of joints and force elements that the engine does not have by its documentation."""
        return self.capability.absent if self.capability else frozenset()

    @property
    def missing(self) -> str:
        """One sentence on how to install a missing package; empty if all packages are installed."""
        return ""

    @property
    def uses_contacts(self) -> bool:
        """Whether a roll is a contact of shapes. Rounding then decides whether touching shapes have a contact."""
        return False

    def prepare(self) -> None:  # noqa: B027  (an engine without this method prepares nothing)
        """Load or compile code once per process, before the build time is measured."""

    @abstractmethod
    def build(self, mechanism: Mechanism, dt: float) -> Run: ...

    @abstractmethod
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared: ...

    @abstractmethod
    def step_cost(self, mechanism: Mechanism) -> float: ...

    @abstractmethod
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement: ...

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """How the settings regularise the joints, or None if the engine does not declare it."""
        return None

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Results at t = 0 and in the first `steps` steps of dt [s], with their expected values by the declared law.

        `built`: the mechanism that the engine builds; tests pass a mechanism with a deliberate mistake.
        """
        return NotDeclared("it declares no law of an instant")

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        """The method with a far smaller solver tolerance, for an estimate of the solver's error."""
        return None

    def iterations_of(self, mechanism: Mechanism) -> int | None:
        """The number of Gauss-Seidel iterations in the first step, or None for an engine without such iterations."""
        return None

    def stepped(self, mechanism: Mechanism) -> Engine:
        """The innermost engine of a wrapper; the engine itself if it is no wrapper."""
        return self

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """The steps of the inner runs as fractions of dt; (1.0,) for an engine without inner runs."""
        return (1.0,)


def _forwarded(member: str) -> Any:
    return property(lambda wrapper: getattr(wrapper.engine, member))


class EngineWrapper(Engine):
    """The base class of an engine that runs another engine, `engine`, and forwards its declarations.

    A subclass defines `variant` and `build`, and overrides members that differ from those of `engine`.
    """

    engine: Engine

    def chosen(self, mechanism: Mechanism) -> Engine:
        """The engine that runs this mechanism; a subclass may choose another one than `engine`."""
        return self.engine

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

    def iterations_of(self, mechanism: Mechanism) -> int | None:
        return self.chosen(mechanism).iterations_of(mechanism)

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        stricter = self.engine.stricter(mechanism)
        return None if stricter is None else replace(self, engine=stricter)  # type: ignore[type-var]

    def stepped(self, mechanism: Mechanism) -> Engine:
        return self.chosen(mechanism).stepped(mechanism)

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        return self.chosen(mechanism).inner_steps(mechanism)


for _member in (
    *("name", "packages", "modules", "family", "missing", "uses_contacts", "build_time", "precision", "angle_error"),
    *("steps_in_child", "capability", "forces_by"),
):
    setattr(EngineWrapper, _member, _forwarded(_member))


def method_name(engine: Engine) -> str:
    return f"{engine.name} {engine.variant}"
