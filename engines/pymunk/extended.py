"""What pymunk can do at best: extrapolation to zero step, of the method whose error it knows, by kind of mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from engines import Run
from engines.extrapolated import Extrapolated
from engines.pymunk.reflection import reflectable
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.validation import Name, Positive, Valid, validated


@dataclass(frozen=True)
class Extended(Valid):
    """An engine in the sense of `engines.Engine` that takes one of three others, by the mechanism's joints alone.

    `single`: bodies each on one skate or contact of their own. `skates`: skates among other joints, held at the end of
    a step instead of around it, so of first order. `pins`: all others.
    """

    variant: Name
    single: Extrapolated
    skates: Extrapolated
    pins: Extrapolated

    @property
    def name(self) -> str:
        return "pymunk"

    @property
    def step_cost(self) -> float:
        """About what a step costs [s]: of the levels together, which is what the grid is cut by."""
        return 2e-6 * max(sum(method.levels) for method in (self.single, self.skates, self.pins))

    @validated
    def chosen(self, mechanism: Mechanism) -> Extrapolated:
        """The engine that this one takes for a mechanism."""
        if reflectable(mechanism):
            return self.single
        if any(isinstance(joint, Skate) for joint in mechanism.joints):
            return self.skates
        return self.pins

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Raises whatever the chosen engine raises."""
        return self.chosen(mechanism).build(mechanism, dt)
