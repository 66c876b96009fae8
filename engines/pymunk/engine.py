"""The engine pymunk: its settings, models and runs."""

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
from engines.pymunk.joints.slide import SkateConstruction
from engines.pymunk.model import PYMUNK_CAPABILITY, Model, Settings, build_model
from engines.pymunk.running import PymunkRun
from reference.checks import Count, Fraction, Name, NonNegative, Positive, Valid, validated
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll


def _shipped() -> tuple[int, float]:
    space = pymunk.Space()  # local, since a space that exists when Python ends can crash the process
    return space.iterations, PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0)).error_bias


# The values are 10 and 0.9 ** 60, with which a joint corrects a tenth of a gap in 1/60 s.
SHIPPED_ITERATIONS, SHIPPED_ERROR_BIAS = _shipped()
CONTRACTION = "contraction"
# CPU time [s] of a step of three bodies, and of an iteration of one joint.
STEP_COST, ITERATION_COST = 2e-6, 13e-9
# Iterations of a start-up step with contacts. After five iterations, half of a disc's contact force is missing.
CONTACT_ITERATIONS = 1000


@dataclass(frozen=True)
class Pymunk(Engine, Valid):
    """Settings of pymunk; raises ValueError for values with which pymunk would abort the process.

    `iterations`: iterations over the joints in a step. `error_bias`: fraction of a gap, in [0, 1], that remains after
    one second. If one of these settings is "contraction", it follows from the convergence of the iterations
    (`engines.pymunk.iterations`). A step then makes at least `min_iterations`. A step makes more than ITERATION_LIMIT
    iterations only if the product of iterations and joints is at most `max_work`. `startup_steps`: number of steps in
    each stage of the start-up, in which the iterations decrease; 0 for no start-up.

    `leapfrog`: start with half a kick and average the velocities. `skate`, `roll`: constructions of these joints
    (`joints.slide` and `joints.roll`). `contact`: settings of contacts for a Roll.

    A model with a `gain` below 1 uses the step as the unit of time. In seconds, the error_bias would underflow to 0
    (gain 1) for small steps.
    """

    name = "pymunk"
    packages = ("pymunk",)
    capability = PYMUNK_CAPABILITY

    variant: Name
    iterations: Count | Literal["contraction"] = SHIPPED_ITERATIONS
    error_bias: Fraction | Literal["contraction"] = SHIPPED_ERROR_BIAS
    leapfrog: bool = False
    skate: SkateConstruction = "centre"
    roll: RollConstruction = "contact"
    contact: ContactSettings = SHIPPED_CONTACT
    startup_steps: Whole = 0
    min_iterations: Count = MIN_ITERATIONS
    max_work: Whole = 0

    @property
    def uses_contacts(self) -> bool:
        return self.roll == "contact"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return declared.order(self, mechanism)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        iterations = ITERATION_COST * len(mechanism.joints) * self.plan(mechanism).iterations
        return STEP_COST * over_three(mechanism) + iterations

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return declared.enforcement(self, joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """The regularisation for steps of dt [s], or None if all rows are at the pose after the drift and correct the
        whole gap.

        A step removes all slip and corrects a fraction of each gap. Rows at the pose before the drift lack J_dot v.
        """
        rows_before_drift = self.uses_contacts and any(isinstance(joint, Roll) for joint in mechanism.joints)
        corrected = 1.0 if isinstance(self.error_bias, str) else 1 - self.error_bias**dt
        if not rows_before_drift and (corrected == 1 or not mechanism.holonomic.any()):
            return None
        return Regularisation(max(corrected, 1e-9) / dt**2, 1 / dt, 0.0, (True,) * mechanism.row_count, complete=False)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        return declared.instants(self, mechanism, dt, steps, built or mechanism)

    def stricter(self, mechanism: Mechanism) -> Pymunk | None:
        return replace(self, iterations=10 * self.iterations) if isinstance(self.iterations, int) else None

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> PymunkRun:
        return PymunkRun(self, mechanism, dt)

    @validated
    def settled_for(self, steps: Count) -> Pymunk:
        return replace(self, startup_steps=steps) if self.startup_steps else self

    @validated
    def iterations_of(self, mechanism: Mechanism) -> int:
        return self.plan(mechanism).iterations

    @validated
    def plan(self, mechanism: Mechanism, duration: NonNegative = 0.0) -> IterationPlan:
        """The plan of iterations for a motion of `duration` [s].

        If `iterations` is "contraction", the pose with the slowest convergence determines the number of iterations.
        """
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
        return self.model_with(mechanism, dt, self.plan(mechanism, duration))

    @validated
    def model_with(self, mechanism: Mechanism, dt: Positive, plan: IterationPlan) -> Model:
        bias, unit = self.error_bias, 1.0
        if isinstance(bias, str):
            bias, unit = 1 - plan.gain, (1.0 if plan.gain == 1 else dt)
        settings = Settings(plan.iterations, float(bias), unit, self.skate, self.roll, self.contact)
        return build_model(mechanism, settings)


@dataclass(frozen=True)
class Extended(EngineWrapper, Valid):
    """Extrapolation with the powers of the step that the error of the mechanism contains.

    `skates`: extrapolation for mechanisms with skates or dampers, which act at the end of a step, so that the error has
    order 1. `pins`: extrapolation for other mechanisms.
    """

    variant: Name
    skates: Extrapolated
    pins: Extrapolated

    @property
    def engine(self) -> Extrapolated:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.pins

    @validated
    def chosen(self, mechanism: Mechanism) -> Extrapolated:
        if any(isinstance(joint, Skate) for joint in mechanism.joints) or mechanism.applied.dissipate:
            return self.skates
        return self.pins

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        return self.chosen(mechanism).stricter(mechanism)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        return self.chosen(mechanism).build(mechanism, dt)
