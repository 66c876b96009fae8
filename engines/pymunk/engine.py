"""Pymunk: the engine's settings, checked, and what they make of a mechanism."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import pymunk
from pymunk.constraints import PivotJoint

from engines import ConvergenceOrder, Enforcement, Engine, EngineWrapper, Instant, NotDeclared, Regularisation, Run
from engines.extrapolated import Extrapolated
from engines.motions import over_three
from engines.pymunk import declared
from engines.pymunk.contraction import CONTACT_CONVERGED, FEWEST, Sweeping, Whole, sweeping, swept_by
from engines.pymunk.expected import worst_contraction
from engines.pymunk.joints.roll import SHIPPED_CONTACT, Contact, RollConstruction
from engines.pymunk.joints.slide import SkateConstruction, SlotConstruction
from engines.pymunk.model import Model, Settings, build_model
from engines.pymunk.running import PymunkRun
from reference.checks import Count, Fraction, Name, NonNegative, Positive, Valid, validated
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll


def _shipped() -> tuple[int, float]:
    """A space's iterations and a joint's error_bias as pymunk sets them.

    The objects end with this function: a space that is still there when Python ends can crash the process.
    """
    space = pymunk.Space()
    return space.iterations, PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0)).error_bias


# 10, and 0.9 ** 60: a tenth of the gap is closed in a sixtieth of a second.
SHIPPED_ITERATIONS, SHIPPED_ERROR_BIAS = _shipped()
CONTRACTION = "contraction"
# CPU time [s] of a step with three bodies, and of one joint in one sweep.
STEP_COST, SWEEP_COST = 2e-6, 13e-9


@dataclass(frozen=True)
class Pymunk(Engine, Valid):
    """An engine in the sense of `engines.Engine`.

    `iterations` sweeps over the joints in a step; `error_bias` in [0, 1], the fraction of a joint's gap that is left
    after one second; either may be "contraction": by how fast sweeps converge here (`engines.pymunk.contraction`).
    `fewest` sweeps are made by contraction, and more than `engines.pymunk.contraction.MOST` only while a step takes no
    more `work`, sweeps times joints. `settled`: how many steps has each stage at the beginning of a run, in which
    sweeps become fewer, from as many as leave nothing; 0 for none.
    `leapfrog`: start half a step ahead, read velocities in between, and step without the checks in `Space.step`, which
    never apply to a model that does not change. `skate`, `roll` and `slot` name what stands for such a joint
    (`engines.pymunk.joints.slide`, `.roll`), `contact` how contact is set where it stands for a Roll.

    A `gain` below 1 in every step would be an error_bias ** dt; that power underflows to 0 at small steps, which is a
    gain of 1. Models by "contraction" are therefore built in a unit of time in which the step is 1, where that matters.

    Raises ValueError for other values: the engine would abort the process.
    """

    name = "pymunk"
    packages = ("pymunk",)

    variant: Name
    iterations: Count | Literal["contraction"] = SHIPPED_ITERATIONS
    error_bias: Fraction | Literal["contraction"] = SHIPPED_ERROR_BIAS
    leapfrog: bool = False
    # pymunk has no joint for a skate. "centre" is a user's naive trick and no part of pymunk: after each step the
    # velocity of the centre of mass across the blade is set to zero.
    skate: SkateConstruction = "centre"
    roll: RollConstruction = "contact"
    slot: SlotConstruction = "exact"
    contact: Contact = SHIPPED_CONTACT
    settled: Whole = 0
    fewest: Count = FEWEST
    work: Whole = 0

    @property
    def uses_contacts(self) -> bool:
        return self.roll == "contact"

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """See `engines.pymunk.declared`."""
        return declared.promise(self, mechanism)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About how long a step takes [s]: the bodies, and every joint in every sweep."""
        sweeps = SWEEP_COST * len(mechanism.joints) * self.sweeping(mechanism).iterations
        return STEP_COST * over_three(mechanism) + sweeps

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        """See `engines.pymunk.declared`."""
        return declared.enforcement(self, joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        """How joints give way with steps of dt [s], None where they are set for the pose after the drift.

        One step stops a slip and closes a share of a gap; a row of the pose before the drift has no term of velocities.
        """
        stale = self.uses_contacts and any(isinstance(joint, Roll) for joint in mechanism.joints)
        closed = 1.0 if isinstance(self.error_bias, str) else 1 - self.error_bias**dt
        if not stale and (closed == 1 or not mechanism.holonomic.any()):
            return None
        return Regularisation(max(closed, 1e-9) / dt**2, 1 / dt, 0.0, (True,) * mechanism.row_count, complete=False)

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """Velocities after each step; see `engines.pymunk.declared`."""
        return declared.instants(self, mechanism, dt, steps, built or mechanism)

    def stricter(self, mechanism: Mechanism) -> Pymunk | None:
        """With ten times as many sweeps, where their number is a setting."""
        return replace(self, iterations=10 * self.iterations) if isinstance(self.iterations, int) else None

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> PymunkRun:
        """A model of the mechanism at t = 0 for steps of dt [s]; raises Unsupported, and ValueError for a bad dt."""
        return PymunkRun(
            mechanism,
            dt,
            lambda sweeping: self.swept_model(mechanism, dt, sweeping),
            lambda duration: self.sweeping(mechanism, duration),
            self.leapfrog,
            self.settled,
        )

    @validated
    def settled_for(self, steps: Count) -> Pymunk:
        """The same with stages of so many steps, if it settles: see `engines.extrapolated.Settling`."""
        return replace(self, settled=steps) if self.settled else self

    @validated
    def iterations_of(self, mechanism: Mechanism) -> int:
        """Iterations in a step for this mechanism, as it starts."""
        return self.sweeping(mechanism).iterations

    @validated
    def sweeping(self, mechanism: Mechanism, duration: NonNegative = 0.0) -> Sweeping:
        """How the mechanism is swept in a motion of `duration` [s]: by its worst pose, where it is by contraction."""
        if isinstance(self.iterations, int) and self.error_bias != CONTRACTION:
            return Sweeping(self.iterations)
        rho = worst_contraction(mechanism, duration, self.uses_contacts)
        if isinstance(self.iterations, int):
            return swept_by(rho, self.iterations)
        found = sweeping(rho, max(1, len(mechanism.joints)), self.fewest, self.work)
        if self.roll == "contact" and any(isinstance(joint, Roll) for joint in mechanism.joints):
            found = replace(found, converged=max(found.converged, CONTACT_CONVERGED))
        return found

    @validated
    def model(self, mechanism: Mechanism, dt: Positive, duration: NonNegative = 0.0) -> Model:
        """The engine's objects for steps of dt [s], not yet stepped, swept as a motion of `duration` [s] asks for."""
        return self.swept_model(mechanism, dt, self.sweeping(mechanism, duration))

    @validated
    def swept_model(self, mechanism: Mechanism, dt: Positive, sweeping: Sweeping) -> Model:
        """The same, swept as told."""
        bias, unit = self.error_bias, 1.0
        if not isinstance(bias, int | float):
            bias, unit = 1 - sweeping.gain, (1.0 if sweeping.gain == 1 else dt)
        settings = Settings(
            sweeping.iterations,
            float(bias),
            unit,
            self.skate,
            self.roll,
            self.slot,
            self.contact,
        )
        return build_model(mechanism, settings)


@dataclass(frozen=True)
class Extended(EngineWrapper, Valid):
    """The extrapolation whose powers fit the mechanism: pymunk has two orders.

    `skates`: for skates, or dampers, which act at the end of a step instead of around it, so of first order. `pins`:
    for all others.
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
