"""What pymunk can do at best: extrapolation to zero step, of the method whose error it knows, by kind of mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from engines import Engine, Holder, Promise, Run, Softness, Unpromised
from engines.extrapolated import Extrapolated
from reference.checks import Name, Positive, Valid, validated
from reference.joints import Joint, Skate
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Extended(Engine, Valid):
    """An engine in the sense of `engines.Engine` that takes one of two others, by the mechanism's joints and forces.

    `skates`: skates, or dampers, which act at the end of a step instead of around it, so of first order. `pins`: all
    others.
    """

    name = "pymunk"
    packages = ("pymunk",)

    variant: Name
    skates: Extrapolated
    pins: Extrapolated

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """That of the chosen engine."""
        return self.chosen(mechanism).order(mechanism)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """That of the chosen engine [s]."""
        return self.chosen(mechanism).step_cost(mechanism)

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        """That of the chosen engine."""
        return self.chosen(mechanism).holder(joint, mechanism)

    def softness(self, mechanism: Mechanism, dt: float) -> Softness | None:
        """That of the chosen engine."""
        return self.chosen(mechanism).softness(mechanism, dt)

    @validated
    def chosen(self, mechanism: Mechanism) -> Extrapolated:
        """The engine that this one takes for a mechanism."""
        if any(isinstance(joint, Skate) for joint in mechanism.joints) or mechanism.applied.dissipate:
            return self.skates
        return self.pins

    def within(self, mechanism: Mechanism) -> Engine:
        return self.chosen(mechanism).within(mechanism)

    def steps_of_runs(self, mechanism: Mechanism) -> tuple[float, ...]:
        return self.chosen(mechanism).steps_of_runs(mechanism)

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Raises whatever the chosen engine raises."""
        return self.chosen(mechanism).build(mechanism, dt)
