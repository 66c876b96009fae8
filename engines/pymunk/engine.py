"""pymunk as an engine: its validated settings, and the models and runs that they give for a mechanism."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import pymunk
from pymunk.constraints import PivotJoint

from engines import ConvergenceOrder, Enforcement, Engine, EngineWrapper, Instant, NotDeclared, Regularisation, Run
from engines.extrapolated import Extrapolated
from engines.motions import over_three
from engines.pymunk import declared
from engines.pymunk.convergence import MIN_ITERATIONS
from engines.pymunk.iterations import IterationPlan, Whole, plan_by_rule, plan_with, worst_factor
from engines.pymunk.joints.roll import SHIPPED_CONTACT, ContactSettings, RollConstruction
from engines.pymunk.joints.slide import SkateConstruction, SlotConstruction
from engines.pymunk.model import Model, Settings, build_model
from engines.pymunk.running import PymunkRun
from reference.checks import Count, Fraction, Name, NonNegative, Positive, Valid, validated
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll


def _shipped() -> tuple[int, float]:
    """A space's iterations and a joint's error_bias as pymunk sets them.

    The objects end with this function: a space that still exists when Python ends can crash the process.
    """
    space = pymunk.Space()
    return space.iterations, PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0)).error_bias


# 10, and 0.9 ** 60: a tenth of the gap is corrected in a sixtieth of a second.
SHIPPED_ITERATIONS, SHIPPED_ERROR_BIAS = _shipped()
CONTRACTION = "contraction"
# CPU time [s] of a step with three bodies, and of one joint in one iteration.
STEP_COST, ITERATION_COST = 2e-6, 13e-9
# Iterations of the start-up for contacts, whose points act on each other, which is not part of the convergence factor:
# after five iterations half of a disc's force is missing.
CONTACT_ITERATIONS = 1000


@dataclass(frozen=True)
class Pymunk(Engine, Valid):
    """An engine in the sense of `engines.Engine`.

    `iterations` over the joints in a step; `error_bias` in [0, 1], the fraction of a joint's gap that is left after one
    second. Either may be "contraction": by the convergence of the iterations (`engines.pymunk.iterations`). Then a step
    makes at least `min_iterations`, and more than `iterations.ITERATION_LIMIT` only while iterations times joints do
    not exceed `max_work`. `startup_steps`: steps in each stage of the start-up, in which the iterations decrease from
    converged; 0 for no start-up.

    `leapfrog`: start half a step ahead, average the velocities, and step without the checks of `Space.step`, which
    concern changes of the model. `skate`, `roll` and `slot` name the construction of such a joint (`joints.slide`,
    `joints.roll`), `contact` the settings of contact for a Roll.

    A `gain` below 1 in every step would be an error_bias ** dt, which underflows to 0 (gain 1) at small steps. Models
    with such a gain therefore use a unit of time in which the step is 1.

    Raises ValueError for other values, for which pymunk would abort the process.
    """

    name = "pymunk"
    packages = ("pymunk",)

    variant: Name
    iterations: Count | Literal["contraction"] = SHIPPED_ITERATIONS
    error_bias: Fraction | Literal["contraction"] = SHIPPED_ERROR_BIAS
    leapfrog: bool = False
    # pymunk has no joint for a skate. "centre" is what users try: after each step the velocity of the centre of mass
    # across the blade is set to zero.
    skate: SkateConstruction = "centre"
    roll: RollConstruction = "contact"
    slot: SlotConstruction = "exact"
    contact: ContactSettings = SHIPPED_CONTACT
    startup_steps: Whole = 0
    min_iterations: Count = MIN_ITERATIONS
    max_work: Whole = 0

    @property
    def uses_contacts(self) -> bool:
        return self.roll == "contact"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """See `engines.pymunk.declared`."""
        return declared.order(self, mechanism)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """The estimated CPU time of a step [s]."""
        iterations = ITERATION_COST * len(mechanism.joints) * self.plan(mechanism).iterations
        return STEP_COST * over_three(mechanism) + iterations

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """See `engines.pymunk.declared`."""
        return declared.enforcement(self, joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """The regularisation with steps of dt [s]; None if rows are at the pose after the drift and gaps are corrected.

        A step removes all slip and corrects a fraction of a gap; rows at the pose before the drift lack J_dot v.
        """
        rows_before_drift = self.uses_contacts and any(isinstance(joint, Roll) for joint in mechanism.joints)
        corrected = 1.0 if isinstance(self.error_bias, str) else 1 - self.error_bias**dt
        if not rows_before_drift and (corrected == 1 or not mechanism.holonomic.any()):
            return None
        return Regularisation(max(corrected, 1e-9) / dt**2, 1 / dt, 0.0, (True,) * mechanism.row_count, complete=False)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Velocities after each step; see `engines.pymunk.declared`."""
        return declared.instants(self, mechanism, dt, steps, built or mechanism)

    def stricter(self, mechanism: Mechanism) -> Pymunk | None:
        """With ten times as many iterations, where their number is a setting."""
        return replace(self, iterations=10 * self.iterations) if isinstance(self.iterations, int) else None

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> PymunkRun:
        """A model of the mechanism at t = 0 for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        return PymunkRun(self, mechanism, dt)

    @validated
    def settled_for(self, steps: Count) -> Pymunk:
        """This engine with `steps` steps in each start-up stage, if it has any; see `extrapolated.Settling`."""
        return replace(self, startup_steps=steps) if self.startup_steps else self

    @validated
    def iterations_of(self, mechanism: Mechanism) -> int:
        """Iterations in a step for this mechanism, as it starts."""
        return self.plan(mechanism).iterations

    @validated
    def plan(self, mechanism: Mechanism, duration: NonNegative = 0.0) -> IterationPlan:
        """The iterations for a motion of `duration` [s]: for its worst pose, if they follow from the convergence."""
        if isinstance(self.iterations, int) and self.error_bias != CONTRACTION:
            return IterationPlan(self.iterations)
        rho = worst_factor(mechanism, duration, self.uses_contacts)
        if isinstance(self.iterations, int):
            return plan_with(rho, self.iterations)
        plan = plan_by_rule(rho, max(1, len(mechanism.joints)), self.min_iterations, self.max_work)
        if self.uses_contacts and any(isinstance(joint, Roll) for joint in mechanism.joints):
            plan = replace(plan, converged=max(plan.converged, CONTACT_ITERATIONS))
        return plan

    @validated
    def model(self, mechanism: Mechanism, dt: Positive, duration: NonNegative = 0.0) -> Model:
        """The engine's objects for steps of dt [s], not yet stepped, with the plan for `duration` [s]."""
        return self.model_with(mechanism, dt, self.plan(mechanism, duration))

    @validated
    def model_with(self, mechanism: Mechanism, dt: Positive, plan: IterationPlan) -> Model:
        """The engine's objects with a given plan."""
        bias, unit = self.error_bias, 1.0
        if isinstance(bias, str):
            bias, unit = 1 - plan.gain, (1.0 if plan.gain == 1 else dt)
        settings = Settings(plan.iterations, float(bias), unit, self.skate, self.roll, self.slot, self.contact)
        return build_model(mechanism, settings)


@dataclass(frozen=True)
class Extended(EngineWrapper, Valid):
    """Extrapolation with the powers of the step that the mechanism's error has.

    `skates`: for skates and dampers, which act at the end of a step and are of first order. `pins`: for all others.
    """

    variant: Name
    skates: Extrapolated
    pins: Extrapolated

    @property
    def engine(self) -> Extrapolated:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.pins

    @validated
    def chosen(self, mechanism: Mechanism) -> Extrapolated:
        """The extrapolation that runs this mechanism."""
        if any(isinstance(joint, Skate) for joint in mechanism.joints) or mechanism.applied.dissipate:
            return self.skates
        return self.pins

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        return self.chosen(mechanism).stricter(mechanism)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Raises whatever the chosen engine raises."""
        return self.chosen(mechanism).build(mechanism, dt)
