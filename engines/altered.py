"""An engine that is given another mechanism than it is asked for: what a different start or a wrong number does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from engines import Engine, Holder, Promise, Run, Softness, Unpromised
from reference.joints import Joint
from reference.mechanism import Mechanism


@dataclass(frozen=True)
class Altered:
    """An engine in the sense of `engines.Engine`: another one, which builds `change(mechanism)`.

    It goes by the name of the engine inside and is held to what that one promises of the mechanism as it is. `change`
    is itself a frozen dataclass that can be called, so that it is data: compared, printed, and sent to other processes.
    """

    engine: Engine
    change: Callable[[Mechanism], Mechanism]

    @property
    def name(self) -> str:
        return self.engine.name

    @property
    def variant(self) -> str:
        return self.engine.variant

    @property
    def packages(self) -> tuple[str, ...]:
        return self.engine.packages

    @property
    def family(self) -> str:
        return self.engine.family

    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        return self.engine.order(mechanism)

    def step_cost(self, mechanism: Mechanism) -> float:
        return self.engine.step_cost(mechanism)

    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return self.engine.holder(joint, mechanism)

    def softness(self, mechanism: Mechanism, dt: float) -> Softness | None:
        return self.engine.softness(mechanism, dt)

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        """Raises whatever the change and the engine raise."""
        return self.engine.build(self.change(mechanism), dt)
