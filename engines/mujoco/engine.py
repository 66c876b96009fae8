"""The MuJoCo engine as a value: its settings, what they may be, and the variants and methods that the report shows."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import mujoco
import numpy as np

from engines import (
    EXACT,
    ConvergenceOrder,
    Enforcement,
    Engine,
    Instant,
    NotDeclared,
    Regularisation,
    Size,
    Unsupported,
)
from engines.motions import is_prescribed, over_three, turns_steadily
from engines.mujoco import declared
from engines.mujoco.joints.links import DriveBy, RodBy
from engines.mujoco.joints.roll import RollBy, RollContact
from engines.mujoco.joints.skate import STEPWISE, SkateBy, slip_damping
from engines.mujoco.joints.slot import SlotBy, resting_line
from engines.mujoco.model import Coordinates, Model, build_model
from engines.mujoco.running import ORDER, MuJoCoRun
from engines.mujoco.solver_check import choose_solver, ease
from engines.mujoco.stiffness import Hardened, Shipped, Stiffness, TiedToStep
from engines.mujoco.writers import mjcf
from engines.tree import Tree, spanning_tree
from reference.checks import Count, InvalidMechanism, Name, NonNegative, Positive, Valid, validated
from reference.joints import Drive, Joint, Rod, Skate, Slot
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Integrator = Literal["Euler", "RK4", "implicit", "implicitfast", "discrete"]
Solver = Literal["Newton", "CG", "PGS"]
Factorisation = Literal["auto", "dense", "sparse"]

# A loop closed by a spring of some steps: its gap falls as the square of the step, whatever integrates it.
SPRUNG = ConvergenceOrder(1, gap=2)
# The same in a motion that is prescribed, where a pose is wrong by its gap alone.
SPRUNG_PRESCRIBED = ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1)


@dataclass(frozen=True)
class MuJoCo(Engine, Valid):
    """A mechanism in MuJoCo; every field but `variant` is a setting.

    `coordinates`: "tree" hinges bodies on one another and closes only the loops, "free" gives every body three
    coordinates and makes every pin a constraint. `drive`: see `engines.mujoco.joints.links`; with "inertia" the
    armature of a driven joint is `armature` times the mechanism's own inertia (the rate is missed by about 0.1 /
    armature). `solvers` are tried at the start in this order, and the first that solves it is taken. `tolerance`:
    MuJoCo's, relative to the inertia of what is not driven. `slots`, `skates`, `rolls`, `rods`: the constructions that
    hold them, see `engines.mujoco.joints`; skates whose rows change once a step are stepped by Euler, since four stages
    of the same stale row cost more and gain nothing. `estimates`: error estimate by step doubling, with half steps
    where double ones are inconclusive, if the error falls with the fourth power of the step; see
    `engines.mujoco.running`. Where the estimate is above `engines.CLAIM` the motion is unresolved.
    Raises ValueError for a setting that MuJoCo would not understand.
    """

    name = "mujoco"
    packages = ("mujoco-core",)

    variant: Name
    integrator: Integrator = "Euler"
    stiffness: Stiffness = field(default_factory=Shipped)
    coordinates: Coordinates = "tree"
    drive: DriveBy = "inertia"
    armature: Positive = 1e8
    solvers: tuple[Solver, ...] = ("Newton",)
    iterations: Count = 100
    tolerance: NonNegative = 1e-8
    jacobian: Factorisation = "auto"
    islands: bool = True
    slots: SlotBy = "halves"
    skates: SkateBy = "blade"
    rolls: RollBy = field(default_factory=RollContact)
    estimates: bool = False
    rods: RodBy = "tendon"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.solvers:
            raise InvalidMechanism("MuJoCo: solvers is (); it must be a tuple of at least one of Newton, CG and PGS")

    @property
    def uses_contacts(self) -> bool:
        return isinstance(self.rolls, RollContact)

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The integrator's order, reduced where a constraint row is of lower order."""
        tree = self._tree(mechanism)
        skating, rolling = (any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Skate, Roll))
        driven = any(isinstance(joint, Drive) and joint not in tree.kept for joint in mechanism.joints)
        tied = tree.closed and isinstance(self.stiffness, TiedToStep)
        order, gap = ORDER if self.integrator == "RK4" else 1, None if tree.closed or rolling else EXACT
        # The slip of a row that is held at the ends of steps is of first order, at the predicted pose of second.
        slip = 2 if self.skates == "predicted tendon" else None
        overwritten = "a state that is overwritten between steps obeys no equation of which an order is known"
        # The first row whose condition holds.
        table: tuple[tuple[bool, ConvergenceOrder | NotDeclared], ...] = (
            (driven and self.drive == "overwrite", NotDeclared(overwritten)),
            # A contact's row has the velocity and not its change.
            (rolling and isinstance(self.rolls, RollContact), ConvergenceOrder(1)),
            (skating and self.skates != "rows", ConvergenceOrder(1, gap=gap, slip=slip)),
            (tied and order > 1, ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1, integrator=order)),
            (tied and is_prescribed(mechanism), SPRUNG_PRESCRIBED),
            (tied, SPRUNG),
            (tree.closed or rolling or skating, ConvergenceOrder(order, gap=gap)),
            # Coordinates that turn at a constant rate, which any integrator adds up.
            (turns_steadily(mechanism), ConvergenceOrder(EXACT)),
            (True, ConvergenceOrder(order, gap=EXACT, slip=EXACT)),
        )
        return next(promise for holds, promise in table if holds)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About how long a step takes [s]."""
        return 12e-6 * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """Coordinates of the tree, connects, fixed tendons and contacts are MuJoCo's; rows that callbacks or
        hooks write are shared; a state that is worked out beside MuJoCo is ours.
        """
        tree = self._tree(mechanism)
        match joint:
            case Drive() if joint not in tree.kept and self.drive == "overwrite":
                return "ours"
            case Slot() if tree.closes_by(joint) and self.slots == "rows" and resting_line(joint, tree) is None:
                return "engine, our rows"
            case Rod() if self.rods == "rows":
                return "engine, our rows"
            case Skate() if self.skates != "blade":
                return "engine, our rows"
            case Roll() if self.rolls == "rows":
                return "engine, our rows"
        return "engine"

    def _tree(self, mechanism: Mechanism) -> Tree:
        return spanning_tree(mechanism, hanging=self.coordinates == "tree")

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """An estimate takes a second run, by double steps."""
        return (2.0, 1.0) if self.estimates else (1.0,)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """How loops, skates and rolls give way with steps of dt [s]; None where the tree holds every joint."""
        tree = self._tree(mechanism)
        soft = [joint for joint in mechanism.joints if tree.closes_by(joint) or isinstance(joint, Skate | Roll)]
        if not soft:
            return None
        rods, skates, rolls = (
            any(isinstance(joint, kind) for joint in mechanism.joints) for kind in (Rod, Skate, Roll)
        )
        stiffness = self.stiffness
        lacking = (rods and self.rods == "tendon") or (skates and self.skates == "blade")
        if rolls and isinstance(self.rolls, RollContact):
            stiffness, lacking = Shipped() if self.rolls.steps is None else TiedToStep(self.rolls.steps), True
        gain, damping = stiffness.gains(mechanism, dt)
        if self.skates == "rows" and all(isinstance(joint, Skate) for joint in soft):
            damping = slip_damping(mechanism)  # which such a row brings along, whatever the springs of loops have
        softening = stiffness.softening
        if stiffness is self.stiffness and isinstance(stiffness, Hardened) and stiffness.eased:
            with suppress(Unsupported):  # only a model has the softening of rows that are eased
                softening = self.model(mechanism, dt).softening or softening
        # The impedance of a gap of a millimetre and more; as shipped a closed gap is about twice as soft.
        compliance = (1 - stiffness.impedance[1]) / stiffness.impedance[1] * softening
        rows = tuple(joint in soft for joint in mechanism.joints for _ in range(joint.size))
        return Regularisation(gain, damping, compliance, rows, complete=not lacking)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Accelerations and reactions; see `engines.mujoco.declared`."""
        return declared.instants(self, mechanism, dt, steps, built or mechanism)

    def stricter(self, mechanism: Mechanism) -> MuJoCo | None:
        """With a tolerance at which its solver leaves nothing but rounding."""
        return None if self.tolerance <= declared.SOLVED else replace(self, tolerance=declared.SOLVED)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> MuJoCoRun:
        """See the contract of `engines`. Raises Unsupported, or ValueError for a bad step."""
        model = self.model(mechanism, dt)
        data = model.start()
        _refuse_what_is_huge(data)
        if self.estimates:
            # From nothing, Newton's method ends where it sees the cost no longer fall: accelerations of light bodies
            # then miss 1e-5 of themselves. From there it goes on, as from step to step.
            data.qacc_warmstart[:] = data.qacc
        size = Size(
            bodies=model.compiled.nbody - 1,
            coordinates=model.compiled.nq,
            rows=model.rows + (len(model.driven) if self.drive != "overwrite" else 0),
            solver_rows=data.nefc,
        )
        order = self.order(mechanism) if self.estimates else None
        if isinstance(order, ConvergenceOrder) and order.order >= ORDER:
            return MuJoCoRun(model, data, size, lambda other: self.build(mechanism, other))
        return MuJoCoRun(model, data, size)

    @validated
    def model(self, mechanism: Mechanism, dt: Positive, unit: Positive | None = None) -> Model:
        """The compiled model alone; `unit`: that of mass [kg], if not `engines.mujoco.model.unit_of_mass`."""
        return self._model(mechanism, dt, unit)

    @validated
    def text(self, mechanism: Mechanism, dt: Positive) -> str:
        """MJCF that runs without this suite, in kg, with the start as its keyframe.

        Raises Unsupported where rows are written, or compliances changed, while or before it is stepped.
        """
        return mjcf(self._model(mechanism, dt, 1.0), self.stiffness.softening)

    def _model(self, mechanism: Mechanism, dt: float, unit: float | None = None) -> Model:
        stepwise = self.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints)
        integrator = "Euler" if stepwise else self.integrator
        options = {
            "integrator": getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"),
            "jacobian": getattr(mujoco.mjtJacobian, f"mjJAC_{self.jacobian.upper()}"),
            "iterations": self.iterations,
            "tolerance": self.tolerance,
        }
        model = build_model(mechanism, dt, self, options, unit)
        start = choose_solver(model, self.solvers)
        if isinstance(self.stiffness, Hardened) and self.stiffness.eased:
            return replace(model, softening=ease(model, self.stiffness.softening, start))
        return model


def _refuse_what_is_huge(data: Any) -> None:
    """Raise Unsupported for a start that MuJoCo's first step would take for an instability, and reset."""
    largest = max(float(np.abs(values).max(initial=0.0)) for values in (data.qvel, data.qacc))
    if largest > mujoco.mjMAXVAL:
        raise Unsupported(
            f"a rate or an acceleration of the start is {largest:.1e} in SI units, and MuJoCo resets a state with any "
            f"above {mujoco.mjMAXVAL:.0e} (mjMAXVAL); describe it in larger units of time"
        )


@validated
def bare_loop(engine: MuJoCo, mechanism: Mechanism, dt: Positive, steps: Count) -> float:
    """CPU seconds of the plainest loop over `mj_step`: what any user pays, to hold a run's cost against."""
    model = engine.model(mechanism, dt)
    compiled, data, advance = model.compiled, model.start(), mujoco.mj_step
    begin = time.process_time()
    for _ in range(steps):
        advance(compiled, data)
    return time.process_time() - begin
