"""What rounding may do to a run, measured: the same engine of a mechanism whose numbers are rounded otherwise.

A start alone does not tell it: where a motion is prescribed, or a projection puts the start back, no bit of a result
depends on the start's last one. So masses, gravity and the points where joints and forces act are rounded otherwise
too: all that enters a step. No order of summation is tried: another order of bodies is another tree of joints in
MuJoCo, and another order of sweeps in pymunk, which are other methods with other errors.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from engines import Around, Engine, Run
from reference.mechanism import Mechanism
from reports.grid.cells import Cell

# Roundings that are tried.
SEEDS = (1, 2, 3)
EPSILON = float(np.finfo(float).eps)

Part = TypeVar("Part")


@dataclass(frozen=True)
class Altered(Around):
    """An engine in the sense of `engines.Engine`: another one, which builds `change(mechanism)`.

    It goes by the name of the engine inside and is held to what that one promises of the mechanism as it is. `change`
    is itself a frozen dataclass that can be called, so that it is data: compared, printed, and sent to other processes.
    """

    engine: Engine
    change: Callable[[Mechanism], Mechanism]

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.engine.variant

    def within(self, mechanism: Mechanism) -> Engine:
        """Itself: what is inside is not stepped as it is."""
        return self

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        """Raises whatever the change and the engine raise."""
        return self.engine.build(self.change(mechanism), dt)


@dataclass(frozen=True)
class Nudge:
    """Masses, inertias and all vectors of a mechanism moved by one rounding up or down, or left; the same for a seed.

    Lone numbers of joints and forces (a gear's ratio, an angle) stay: engines treat some of them, such as 1, in a way
    of their own. So do zeros.
    """

    seed: int

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism in other roundings."""
        random = np.random.default_rng([self.seed, zlib.crc32(repr(mechanism.row_names).encode())])
        return replace(
            mechanism,
            bodies=tuple(_moved(body, random, ("mass", "inertia")) for body in mechanism.bodies),
            joints=tuple(_moved(joint, random) for joint in mechanism.joints),
            gravity=_rounded(mechanism.gravity, random),
            forces=tuple(_moved(force, random) for force in mechanism.forces),
        )


def _moved(part: Part, random: np.random.Generator, lone: tuple[str, ...] = ()) -> Part:
    """A body, joint or force with its vectors, and these lone numbers, rounded otherwise."""
    found: dict[str, Any] = {}
    for field in fields(part):  # type: ignore[arg-type]
        value = getattr(part, field.name)
        if isinstance(value, tuple) and value and all(isinstance(each, float) for each in value):
            found[field.name] = _rounded(value, random)
        elif field.name in lone:
            found[field.name] = _rounded((value,), random)[0]
    return replace(part, **found)  # type: ignore[type-var]


def _rounded(values: tuple[Any, ...], random: np.random.Generator) -> Any:
    signs = random.integers(-1, 2, len(values))
    return tuple(float(value * (1 + EPSILON * sign)) for value, sign in zip(values, signs, strict=True))


def nudged_cells(cell: Cell) -> tuple[Cell, ...]:
    """The same cell in other roundings of all that enters it."""
    return tuple(replace(cell, engine=Altered(cell.engine, Nudge(seed))) for seed in SEEDS)
