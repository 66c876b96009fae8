"""The constructions of a skate that the skate's and the wheels' pages compare, by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from engines import Engine
from engines.mujoco import MuJoCo
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import Pymunk
from engines.pymunk import methods as pymunk_methods
from engines.registry import VARIANTS
from reference.mechanism import Mechanism

CONSTRUCTIONS: tuple[Engine, ...] = (*pymunk_methods.SKATES, *mujoco_methods.SKATES)
_KNOWN = {f"{engine.name} {engine.variant}": engine for engine in (*VARIANTS, *CONSTRUCTIONS)}


def method(name: str) -> Engine:
    """The engine called "pymunk groove"; raises KeyError for an unknown name."""
    return _KNOWN[name]


@dataclass(frozen=True)
class LimitedGroove(Pymunk):
    """A skate by a groove that gives way when it would need more than `limit` [N]: friction, by `max_force`."""

    limit: float = float("inf")

    def model(self, mechanism: Mechanism, dt: float, iterations: int | None = None) -> Any:
        model = super().model(mechanism, dt, iterations)
        for constraint in model.space.constraints:
            constraint.max_force = self.limit
        return model


@dataclass(frozen=True)
class LimitedTendon(MuJoCo):
    """A skate by friction loss of a tendon that gives way beyond `limit` [N]."""

    limit: float = float("inf")

    def model(self, mechanism: Mechanism, dt: float) -> Any:
        model = super().model(mechanism, dt)
        model.compiled.tendon_frictionloss[:] = self.limit
        return model


def limited(limit: float) -> tuple[Engine, ...]:
    """Skates that slip when they would have to give more than this side force [N]."""
    tendon = next(engine for engine in mujoco_methods.SKATES if engine.variant == "tendon friction")
    settings = {name: value for name, value in vars(tendon).items() if name != "variant"}
    return (
        LimitedGroove("groove with max_force", 5, 0.0, skate="groove", limit=limit),
        LimitedTendon("tendon with friction loss", **settings, limit=limit),
    )
