"""A skate that slips when it would have to give more than a limit: pymunk's groove, with its `max_force`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from engines.pymunk.contraction import Sweeping
from engines.pymunk.engine import Pymunk
from reference.checks import Positive, validated
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class LimitedGroove(Pymunk):
    """A groove that gives way when it would need more than `limit` [N], like dry friction."""

    limit: Positive = 1.0

    def swept_model(self, mechanism: Mechanism, dt: float, sweeping: Sweeping) -> Any:
        model = super().swept_model(mechanism, dt, sweeping)
        for constraint in model.space.constraints:
            constraint.max_force = self.limit
        return model


@validated
def limited_groove(limit: Positive) -> LimitedGroove:
    """The groove with a limit [N] on its force."""
    return LimitedGroove("groove with max_force", 5, 0.0, skate="groove", limit=limit)
