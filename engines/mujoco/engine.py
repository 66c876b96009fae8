"""The engine MuJoCo with its settings and declarations."""

from __future__ import annotations

import time
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any, Literal, assert_never

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
from engines.mujoco.joints.links import RodBy, SlotBy, free_link_on_fixed_line
from engines.mujoco.joints.roll import RollBy, RollContact
from engines.mujoco.joints.skate import STEPWISE, SkateBy, slip_damping
from engines.mujoco.model import MUJOCO_CAPABILITY, Coordinates, MuJoCoModel, build_model
from engines.mujoco.running import MuJoCoRun
from engines.mujoco.solver_check import choose_solver, soften_until_solvable
from engines.mujoco.step_doubling import ORDER
from engines.mujoco.stiffness import Hardened, Shipped, Stiffness, TiedToStep
from engines.mujoco.writers import mjcf
from engines.tree import Tree, spanning_tree
from reference.checks import Count, InvalidMechanism, Name, NonNegative, Positive, Valid, validated
from reference.couplings import Coupling
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Integrator = Literal["Euler", "RK4", "implicit", "implicitfast", "discrete"]
Solver = Literal["Newton", "CG", "PGS"]
Factorisation = Literal["auto", "dense", "sparse"]


@dataclass(frozen=True)
class MuJoCo(Engine, Valid):
    """Settings of MuJoCo; raises ValueError for invalid settings.

    `coordinates`: with "tree" a body moves relative to its parent in a kinematic tree, and only loops need constraints.
    `slots`, `skates`, `rolls`, `rods`: constructions of these joints, see `engines.mujoco.joints`. `armature`:
    armature of a driven joint relative to the inertia of the mechanism; the relative error of the rate is about 0.1 /
    armature. `solvers`: the first of these solvers that solves the equations at t = 0 is used. `tolerance`: tolerance
    of the solver, relative to the inertia of the coordinates without drives. `estimates`: whether methods of order 4
    estimate their error, see `engines.mujoco.step_doubling`. If an estimate exceeds `engines.CLAIM`, the motion is
    unresolved.
    """

    name = "mujoco"
    packages = ("mujoco-core",)
    capability = MUJOCO_CAPABILITY

    variant: Name
    integrator: Integrator = "Euler"
    stiffness: Stiffness = field(default_factory=Shipped)
    coordinates: Coordinates = "tree"
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
        tree = self._tree(mechanism)
        has_skates, has_rolls = _has(mechanism, Skate), _has(mechanism, Roll)
        is_tied = tree.closed and isinstance(self.stiffness, TiedToStep)
        order, gap = ORDER if self.integrator == "RK4" else 1, None if tree.closed or has_rolls else EXACT
        # For a row at the predicted pose, the slip has order 2; otherwise it has order 1.
        slip = 2 if self.skates == "predicted tendon" else None
        # The first entry with a true condition applies.
        table: tuple[tuple[bool, ConvergenceOrder], ...] = (
            # The row of a contact lacks the rate of change of its direction.
            (has_rolls and self.uses_contacts, ConvergenceOrder(1)),
            (has_skates and self.skates != "rows", ConvergenceOrder(1, gap=gap, slip=slip)),
            # If the time constant of a loop's spring is a multiple of the step, the gap has order 2.
            (is_tied and order > 1, ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1, integrator=order)),
            # In a prescribed motion the errors of the poses are the gaps.
            (is_tied and is_prescribed(mechanism), ConvergenceOrder(2, rate=1, slip=1, energy=1, reaction=1)),
            (is_tied, ConvergenceOrder(1, gap=2)),
            (tree.closed or has_rolls or has_skates, ConvergenceOrder(order, gap=gap)),
            # Every integrator is exact for constant rates.
            (turns_steadily(mechanism), ConvergenceOrder(EXACT)),
            (True, ConvergenceOrder(order, gap=EXACT, slip=EXACT)),
        )
        return next(convergence for applies, convergence in table if applies)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        return 12e-6 * over_three(mechanism)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """Tree coordinates, connects, tendons and contacts are "engine".

        If a callback writes the rows, the result is "engine, our rows".
        """
        MUJOCO_CAPABILITY.require(mechanism)
        tree = self._tree(mechanism)
        match joint:
            case Slot():
                by_row = tree.closes_by(joint) and free_link_on_fixed_line(joint, tree) is None
                uses_our_rows = self.slots == "rows" and by_row
            case Rod():
                uses_our_rows = self.rods == "rows"
            case Skate():
                uses_our_rows = self.skates != "blade"
            case Roll():
                uses_our_rows = self.rolls == "rows"
            case Pin() | Weld() | Gear() | Drive() | Coupling():
                uses_our_rows = False
            case _:
                assert_never(joint)
        return "engine, our rows" if uses_our_rows else "engine"

    def _tree(self, mechanism: Mechanism) -> Tree:
        return spanning_tree(mechanism, hanging=self.coordinates == "tree")

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        """The steps of all runs relative to dt; an error estimate needs a run with double steps."""
        return (2.0, 1.0) if self.estimates else (1.0,)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """The regularisation of loops, skates and rolls for steps of dt [s]; None if the tree enforces every joint."""
        tree, stiffness = self._tree(mechanism), self.stiffness
        soft = [joint for joint in mechanism.joints if tree.closes_by(joint) or isinstance(joint, Skate | Roll)]
        if not soft:
            return None
        # The law is incomplete if rows have no velocity term, or if rows hold only at the ends of steps.
        is_incomplete = _has(mechanism, Rod) and self.rods == "tendon"
        is_incomplete |= _has(mechanism, Skate) and self.skates == "blade"
        if _has(mechanism, Roll) and isinstance(self.rolls, RollContact):
            stiffness, is_incomplete = Shipped() if self.rolls.steps is None else TiedToStep(self.rolls.steps), True
        gain, damping = stiffness.gains(mechanism, dt)
        if self.skates == "rows" and all(isinstance(joint, Skate) for joint in soft):
            damping = slip_damping(mechanism)  # user rows of skates always have this damping
        softening = stiffness.softening
        if stiffness is self.stiffness and isinstance(stiffness, Hardened) and stiffness.eased:
            with suppress(Unsupported):  # with `eased`, the softening depends on the model
                softening = self.model(mechanism, dt).softening
        # impedance[1] is valid for gaps of at least a millimetre.
        compliance = (1 - stiffness.impedance[1]) / stiffness.impedance[1] * softening
        rows = tuple(joint in soft for joint in mechanism.joints for _ in range(joint.size))
        return Regularisation(gain, damping, compliance, rows, complete=not is_incomplete)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        return declared.instants(self, mechanism, dt, steps, built or mechanism)

    def stricter(self, mechanism: Mechanism) -> MuJoCo | None:
        tolerance = declared.ROUNDING_TOLERANCE
        return None if self.tolerance <= tolerance else replace(self, tolerance=tolerance)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> MuJoCoRun:
        model = self.model(mechanism, dt)
        data = model.start()
        _refuse_huge_rates(data)
        if self.estimates:
            # Newton's method ends when its cost no longer decreases. The first solution therefore has a relative error
            # of 1e-5 in the accelerations of light bodies. The next solution starts from the first one and corrects
            # this error.
            data.qacc_warmstart[:] = data.qacc
        size = Size(
            bodies=model.compiled.nbody - 1,
            coordinates=model.compiled.nq,
            rows=model.rows + len(model.driven),
            solver_rows=data.nefc,
        )
        order = self.order(mechanism) if self.estimates else None
        if isinstance(order, ConvergenceOrder) and order.order >= ORDER:
            return MuJoCoRun(model, data, size, lambda other: self.build(mechanism, other))
        return MuJoCoRun(model, data, size)

    @validated
    def model(self, mechanism: Mechanism, dt: Positive, unit: Positive | None = None) -> MuJoCoModel:
        """The compiled model with masses in `unit` [kg], by default `engines.mujoco.model.unit_of_mass`."""
        is_stepwise = self.skates in STEPWISE and _has(mechanism, Skate)
        integrator = "Euler" if is_stepwise else self.integrator
        options = {
            "integrator": getattr(mujoco.mjtIntegrator, f"mjINT_{integrator.upper()}"),
            "jacobian": getattr(mujoco.mjtJacobian, f"mjJAC_{self.jacobian.upper()}"),
            "iterations": self.iterations,
            "tolerance": self.tolerance,
        }
        model = build_model(mechanism, dt, self, options, unit)
        start = choose_solver(model, self.solvers)
        if isinstance(self.stiffness, Hardened) and self.stiffness.eased:
            return replace(model, softening=soften_until_solvable(model, start))
        return model

    @validated
    def text(self, mechanism: Mechanism, dt: Positive) -> str:
        """An MJCF file that does not need this suite, with masses in kg and the initial state as a keyframe.

        Raises Unsupported if our code writes rows or changes compliances.
        """
        return mjcf(self.model(mechanism, dt, 1.0))


def _has(mechanism: Mechanism, kind: type[Joint]) -> bool:
    return any(isinstance(joint, kind) for joint in mechanism.joints)


def _refuse_huge_rates(data: Any) -> None:
    largest = max(float(np.abs(values).max(initial=0.0)) for values in (data.qvel, data.qacc))
    if largest > mujoco.mjMAXVAL:
        raise Unsupported(
            f"a rate or an acceleration of the start is {largest:.1e} in SI units, and MuJoCo resets a state with any "
            f"above {mujoco.mjMAXVAL:.0e} (mjMAXVAL); describe it in larger units of time"
        )


@validated
def bare_loop(engine: MuJoCo, mechanism: Mechanism, dt: Positive, steps: Count) -> float:
    """CPU time [s] of `steps` calls of `mj_step` without recording."""
    model = engine.model(mechanism, dt)
    compiled, data, advance = model.compiled, model.start(), mujoco.mj_step
    begin = time.process_time()
    for _ in range(steps):
        advance(compiled, data)
    return time.process_time() - begin
