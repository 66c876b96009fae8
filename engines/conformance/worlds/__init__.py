"""Small mechanisms whose motions are known in closed form: what an engine's run is held against.

Each has one or a few bodies, and the joints that its name says. Nothing here comes from a scene or from an engine, and
the formulas stand beside the numbers. Units: kg, m, s, rad, N, N m.
"""

from __future__ import annotations

from engines.conformance.worlds import pins, rolls, skates, slots
from engines.conformance.worlds.pins import SPINNING
from engines.conformance.worlds.world import Motion, World

# One body each, which nothing moves: what reactions say of its weight.
RESTING: tuple[World, ...] = (*pins.RESTING, *slots.RESTING, *skates.RESTING, *rolls.RESTING)
MOVING: tuple[World, ...] = (*pins.MOVING, *slots.MOVING, *skates.MOVING, *rolls.MOVING)
WORLDS = (*RESTING, *MOVING)

__all__ = ["MOVING", "RESTING", "SPINNING", "WORLDS", "Motion", "World"]
