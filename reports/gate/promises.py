"""What theory promises of a method: with which power of the step each of its errors falls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

# The order of an error that no step makes: a joint between coordinates that can't part, a motion that is prescribed.
EXACT = math.inf


@dataclass(frozen=True)
class Promise:
    """The power of the step with which each error of a method falls.

    `order` is that of poses, and of the others unless they are given. `integrator`: the order of what the step alone
    costs, where a softness that is tied to the step sets the others. `differences`: reactions are a change of velocity
    over the step divided by this number; 0 where they are read as forces. `amplified`: how many times the usual
    rounding of velocities a combination of runs carries.
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
        """The order of a quantity of `reports.grid.quantities`."""
        name = {"angle": "order", "position": "order", "velocity": "rate"}.get(quantity, quantity)
        own = getattr(self, name)
        return self.order if own is None else own

    def step(self, quantity: str) -> float:
        """The order of what the step alone costs."""
        if self.integrator is None or self.of(quantity) != self.order:
            return self.of(quantity)
        return self.integrator


# Method -> promise; (scene, method) -> promise where a scene's motion makes it another.
Promises = Mapping[Any, Promise]  # Any: a key of either kind, since a Mapping's keys are invariant


def promised(promises: Promises, scene: str, method: str) -> Promise:
    """The promise of a method in a scene; raises KeyError for a method without one."""
    return promises[scene, method] if (scene, method) in promises else promises[method]
