"""Faults that are planted in an engine: the mechanism that it builds from is another one than it is asked for.

The catalogue of the search's controls: a part of a number, or a sign. `tests.mistakes` has those of the gate's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

from engines.box2d import Box2D
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.pymunk import Pymunk
from reference.joints import Gear
from reference.mechanism import Mechanism
from tests.mistakes import Misbuilt, Mistake

Change = Callable[[Mechanism], Mechanism]

FORCES = ("spring", "torsion-spring", "damper", "torsion-damper", "force", "torque")
FIELD = {"spring": "stiffness", "torsion-spring": "stiffness", "force": "second_point"}  # a force's is its lever arm
FIELD |= {"damper": "damping", "torsion-damper": "damping", "torque": "torque"}
# Of joints that hold velocities: a kind of Mistake, and its detail.
WRONG = {"skate": ("angle", ""), "roll": ("size", "body"), "drive": ("rate", "")}


@dataclass(frozen=True)
class Heavier:
    """Every inertia off by a part."""

    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return replace(mechanism, bodies=tuple(_larger(body, "inertia", self.relative) for body in mechanism.bodies))


@dataclass(frozen=True)
class Stronger:
    """This number of every force element off by a part."""

    name: str
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return replace(mechanism, forces=tuple(_larger(force, self.name, self.relative) for force in mechanism.forces))


@dataclass(frozen=True)
class Moved:
    """A number of the last joint of a kind off by a part: its point on the second body, unless WRONG says another."""

    kind: str
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        own = [joint for joint in mechanism.joints if type(joint).__name__.lower() == self.kind]
        what, detail = WRONG.get(self.kind, ("point", "second_point x"))
        return Mistake(what, own[-1].name, detail).made(mechanism, self.relative) if own else mechanism


@dataclass(frozen=True)
class Reversed:
    """Gears turn the wrong way round: a sign of their row."""

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        joints = tuple(
            replace(joint, ratio=-joint.ratio) if isinstance(joint, Gear) else joint for joint in mechanism.joints
        )
        return Misbuilt(mechanism.bodies, joints, mechanism.gravity, mechanism.forces, right=mechanism)


def _larger(part: Any, name: str, relative: float) -> Any:
    if not hasattr(part, name):
        return part
    value = getattr(part, name)
    return replace(part, **{name: tuple((1 + relative) * v for v in value) if isinstance(value, tuple) else
                            (1 + relative) * value})  # fmt: skip


def planted(kind: str, relative: float) -> Change:
    """The fault of a kind of joint, of a force element, or of all inertias."""
    if kind == "inertia":
        return Heavier(relative)
    if kind == "gear":
        return Reversed()
    return Stronger(FIELD[kind], relative) if kind in FORCES else Moved(kind, relative)


def plant(monkeypatch: pytest.MonkeyPatch, change: Change) -> None:
    """Have the engines whose laws of an instant are asked build their models from changed mechanisms."""
    for engine, name in ((MuJoCo, "model"), (Mjx, "model"), (Pymunk, "swept_model"), (Box2D, "build")):
        monkeypatch.setattr(engine, name, _planted(getattr(engine, name), change))


def _planted(right: Callable[..., Any], change: Change) -> Callable[..., Any]:
    def wrong(self: Any, mechanism: Mechanism, *given: Any, **named: Any) -> Any:
        made = right(self, change(mechanism), *given, **named)
        if isinstance(self, MuJoCo):  # what is read out belongs to the mechanism that was asked for
            return replace(made, mechanism=mechanism)
        return (replace(made[0], mechanism=mechanism), made[1]) if isinstance(self, Mjx) else made

    return wrong
