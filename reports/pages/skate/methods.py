"""The constructions of a skate that the skate's and the wheels' pages compare, by name."""

from __future__ import annotations

from collections.abc import Iterable

from engines import Engine
from engines.mujoco import methods as mujoco_methods
from engines.mujoco.methods import limited_tendon
from engines.pymunk import methods as pymunk_methods
from engines.pymunk.engine import limited_groove
from engines.registry import VARIANTS

CONSTRUCTIONS: tuple[Engine, ...] = (*pymunk_methods.SKATES, *mujoco_methods.SKATES)
_KNOWN = {f"{engine.name} {engine.variant}": engine for engine in (*VARIANTS, *CONSTRUCTIONS)}


def method(name: str) -> Engine:
    """The engine called "pymunk groove"; raises KeyError for an unknown name."""
    return _KNOWN[name]


def known(names: Iterable[str]) -> dict[str, Engine]:
    """The engines of these names; a name that is not registered here is left out."""
    return {name: _KNOWN[name] for name in names if name in _KNOWN}


def limited(limit: float) -> tuple[Engine, ...]:
    """Skates that slip when they would have to give more than this side force [N]."""
    return limited_groove(limit), limited_tendon(limit)


# What a user would take, and the best of each kind.
ORDINARY: tuple[Engine, ...] = tuple(
    engine for engine in VARIANTS if engine.name != "lagrange" or engine.variant.startswith("rk4")
)
