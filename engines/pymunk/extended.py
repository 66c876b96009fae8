"""What pymunk can do at best: extrapolation to zero step, of the method whose error it knows, by kind of mechanism."""

from __future__ import annotations

from dataclasses import dataclass

from engines import Holder, Promise, Run, Softness, Unpromised
from engines.extrapolated import Extrapolated
from engines.pymunk.engine import Pymunk
from engines.pymunk.reflection import Reflected, reflectable
from reference.joints import Joint, Skate
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
    def packages(self) -> tuple[str, ...]:
        return ("pymunk",)

    @property
    def family(self) -> str:
        return "pymunk"

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
        if reflectable(mechanism):
            return self.single
        if any(isinstance(joint, Skate) for joint in mechanism.joints):
            return self.skates
        return self.pins

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> Run:
        """Raises whatever the chosen engine raises."""
        return self.chosen(mechanism).build(mechanism, dt)


LEAPFROG = Pymunk("leapfrog", "contraction", "contraction", leapfrog=True, skate="groove", roll="pivot")
# Skates and hinges in one loop pass impulses round: with fewer sweeps, what they leave shows before the step's error.
AIMED = Pymunk("aimed", 40, 0.0, skate="groove", roll="pivot")
# The leapfrog's error has all powers from the second, not only even ones; with a skate from the first.
FIVE = (2, 3, 4, 6, 8)
# Even numbers of steps only, as a reflection asks for, and even powers, as it gives.
EVEN, EVEN_POWERS = (2, 4, 6, 8), (2, 4, 6)
EXTENDED = Extended(
    "extended",
    single=Extrapolated(Reflected("reflection"), "extended", levels=EVEN, powers=EVEN_POWERS),
    skates=Extrapolated(AIMED, "extended", levels=FIVE, powers=(1, 2, 3, 4)),
    pins=Extrapolated(LEAPFROG, "extended", levels=FIVE, powers=(2, 3, 4, 5)),
)
