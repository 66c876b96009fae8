"""The base of an engine that runs another engine."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from engines.contract import ConvergenceOrder, Enforcement, Engine, NotDeclared, Regularisation
from reference.joints import Joint
from reference.mechanism import Mechanism


def _forwarded(member: str) -> Any:
    return property(lambda wrapper: getattr(wrapper.engine, member))


class EngineWrapper(Engine):
    """The base class of an engine that runs another engine, `engine`, and forwards its declarations.

    A subclass defines `variant` and `build`, and overrides members that differ from those of `engine`.
    """

    engine: Engine

    def chosen(self, mechanism: Mechanism) -> Engine:
        """The engine that runs this mechanism; a subclass may choose another one than `engine`."""
        return self.engine

    name: Any = _forwarded("name")
    packages: Any = _forwarded("packages")
    modules: Any = _forwarded("modules")  # pyright: ignore[reportIncompatibleVariableOverride]
    family: Any = _forwarded("family")
    missing: Any = _forwarded("missing")
    uses_contacts: Any = _forwarded("uses_contacts")
    build_time: Any = _forwarded("build_time")  # pyright: ignore[reportIncompatibleVariableOverride]
    precision: Any = _forwarded("precision")  # pyright: ignore[reportIncompatibleVariableOverride]
    angle_error: Any = _forwarded("angle_error")  # pyright: ignore[reportIncompatibleVariableOverride]
    steps_in_child: Any = _forwarded("steps_in_child")  # pyright: ignore[reportIncompatibleVariableOverride]
    capability: Any = _forwarded("capability")  # pyright: ignore[reportIncompatibleVariableOverride]
    forces_by: Any = _forwarded("forces_by")  # pyright: ignore[reportIncompatibleVariableOverride]

    def prepare(self) -> None:
        self.engine.prepare()

    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return self.chosen(mechanism).order(mechanism)

    def step_cost(self, mechanism: Mechanism) -> float:
        return self.chosen(mechanism).step_cost(mechanism)

    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return self.chosen(mechanism).enforcement(joint, mechanism)

    def regularisation(self, mechanism: Mechanism, dt: float) -> Regularisation | None:
        return self.chosen(mechanism).regularisation(mechanism, dt)

    def iterations_of(self, mechanism: Mechanism) -> int | None:
        return self.chosen(mechanism).iterations_of(mechanism)

    def stricter(self, mechanism: Mechanism) -> Engine | None:
        stricter = self.engine.stricter(mechanism)
        return None if stricter is None else replace(self, engine=stricter)  # type: ignore[type-var]

    def stepped(self, mechanism: Mechanism) -> Engine:
        return self.chosen(mechanism).stepped(mechanism)

    def inner_steps(self, mechanism: Mechanism) -> tuple[float, ...]:
        return self.chosen(mechanism).inner_steps(mechanism)
