"""Exudyn under test: bodies in maximal coordinates, joints as algebraic equations, implicit integrators.

A body is a NodeRigidBody2D with an ObjectRigidBody2D. A Pin is an ObjectJointRevolute2D, and a Rod is an
ObjectConnectorDistance. A Slot is an ObjectJointPrismatic2D with free rotation. A Gear is an ObjectConnectorCoordinate
between two rotations, and a Drive is the same object at velocity level. A Weld is such an object with a revolute joint.
A Skate is the engine's rolling disc (ObjectJointRollingDisc) with a constraint on the velocity along the axle alone.
The disc is perpendicular to the plane, so its radius has no effect. A Roll of a circle on a straight line is a rolling
disc in the plane, with constraints on the rolling velocity and on the velocity along the line's normal. The engine has
no equation for other shapes. Springs, dampers, forces and torques are elements of the engine.
All variants switch off `timeIntegration.adaptiveStep`, which would halve a step if Newton's method fails.

The joints are exact up to the tolerance of Newton's method. The integrator "GeneralizedAlpha" satisfies the joints for
positions (index 3), and "TrapezoidalIndex2" for velocities (index 2). Both integrators have order 2. The engine's
explicit integrators accept none of these joints.

The engine provides accelerations, so that reactions belong to the sampled instant. Both integrators use the
accelerations of the last step. The engine's accelerations at the start ignore constraints on velocities (skates,
rolling, drives). GeneralizedAlpha reduces this error by about a tenth in every step, and the trapezoidal rule does not
reduce it. Poses and twists do not have this error. Therefore *default* has no reactions for mechanisms with such
constraints. The other variants pass consistent initial accelerations to the engine by its public settings.

As shipped, one norm combines the residuals of forces, torques and constraints, so the tolerance depends on units and
masses. In a mechanism with inertias of 2e-11 and 0.8 kg m^2, the error was 6e-7 of the motion at every step, and no
estimate showed it. The other variants use the norm of Newton's increment (`residualMode` 1), in units of the
mechanism's length. An increment d of a pose changes its rate by 2 d / dt for the rest of the motion, and `absolute` is
the tolerance of that rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from engines.capability import Capability, Lack
from engines.contract import EXACT, ConvergenceOrder, NotDeclared
from engines.extrapolated import Extrapolated
from engines.exudyn_model import EXUDYN_FORCES, EXUDYN_JOINTS, ExudynSystem, holds_velocities
from engines.motions import is_prescribed, over_three
from engines.single_run import ExtraEngine
from reference.checks import Name, Positive, validated
from reference.couplings import Coupling
from reference.mechanism import Mechanism

Integrator = Literal["GeneralizedAlpha", "TrapezoidalIndex2"]
# CPU time [s] of a step of three bodies.
EXUDYN_STEP_COST = 19e-6


@dataclass(frozen=True)
class Exudyn(ExtraEngine):
    """relative, absolute: tolerances of Newton's method.
    damping: spectral radius of GeneralizedAlpha at infinite frequency; 1 means no damping.
    consistent: pass initial accelerations to the engine, which then does not compute them.
    sparse: use a sparse factorisation in Newton's method.
    own_units: use the mechanism's length, mass and time as units of the model. Constants of the engine, such as the
        shortest time between samples, 1e-10, are then in these units. Newton's increment then decides convergence:
        `relative` refers to the first increment, and `absolute` is a rate in these units.
    """

    name = "exudyn"
    packages = ("exudyn",)
    modules: ClassVar[tuple[str, ...]] = ("exudyn",)
    library: ClassVar[tuple[str, str] | None] = ("libGL.so.1", "libgl1")  # for a window that we do not open
    capability: ClassVar[Capability] = Capability(
        "exudyn", EXUDYN_JOINTS, EXUDYN_FORCES, {Coupling: Lack("our adapter of exudyn builds no coupling")}
    )

    variant: Name
    integrator: Integrator = "GeneralizedAlpha"
    relative: Positive = 1e-8
    absolute: Positive = 1e-10
    damping: Positive = 0.9
    consistent: bool = False
    sparse: bool = False
    own_units: bool = False

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        velocities = holds_velocities(mechanism)
        reaction = math.nan if velocities and not self.consistent else None
        if self.integrator == "TrapezoidalIndex2":
            return ConvergenceOrder(2, slip=EXACT, reaction=reaction)
        if velocities or is_prescribed(mechanism):
            return ConvergenceOrder(2, reaction=reaction)
        return ConvergenceOrder(2, gap=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        size = over_three(mechanism)
        return EXUDYN_STEP_COST * size * (1.0 if self.sparse else max(1.0, size / 5) ** 2)

    def stricter(self, mechanism: Mechanism) -> Exudyn | None:
        """The method with tolerances of Newton's method divided by 1000, or None with `own_units`."""
        if self.own_units:
            return None
        return replace(self, relative=1e-3 * self.relative, absolute=1e-3 * self.absolute)

    def model(self, mechanism: Mechanism, dt: float) -> ExudynSystem:
        return ExudynSystem(self, mechanism, dt)


DEFAULT = Exudyn("default")
# The tolerance of 1e-13 is 450 units of rounding. The error of Newton's method is equal at all levels, so the estimate
# does not include this error. In 1e4 steps it grows to a rate of 1e-9, which is a hundredth of the claim.
TUNED = Exudyn(
    "tuned", "TrapezoidalIndex2", relative=1e-10, absolute=1e-13, consistent=True, sparse=True, own_units=True
)
# Reactions have an error h^2 (-1)^n after n steps. Extrapolation removes this error if its sign is equal in all runs,
# so all levels are odd. With the levels (1, 2, 3, 4) the estimated error of reactions was 6.8 times too small.
EXTENDED = Extrapolated(replace(TUNED, relative=1e-12), "extended", levels=(1, 3, 5, 7), powers=(2, 4, 6))
VARIANTS = (DEFAULT, TUNED, EXTENDED)
