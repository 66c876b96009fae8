"""A Pin, a Weld, a Rod and a Gear in MuJoCo, where no coordinate of the tree stands for them.

A pin or a weld that closes a loop is a `connect`. It has three rows; out of the plane nothing can move, so the third
row is empty and harmless. The angles of a weld, and of a gear, are sums of tree coordinates with constant coefficients:
a fixed tendon, held by an equality that has no velocity term and needs none.

`RodBy` names what holds a rod:

- "tendon": MuJoCo's own parts alone, an equality of a spatial tendon between two sites. Up to 4.0.1 it leaves out the
  velocity term -(dJ/dt) v, which its spring has to make up for by a gap.
- "rows": the rod's own row, written by a callback in every stage.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco

from engines.mujoco.construction import Building
from engines.tree import world_offset
from reference.joints import Gear, Pin, Rod, Weld

RodBy = Literal["tendon", "rows"]


def add_pins(building: Building, pins: Sequence[Pin | Weld]) -> None:
    """Add a `connect` each, bound by MuJoCo in the assembled start pose; its force acts on `name1`: the second body."""
    for pin in pins:
        names = ["world" if name is None else f"body {building.index(name)}" for name in (pin.first, pin.second)]
        name, point = (pin.second, pin.second_point) if pin.second is not None else (pin.first, pin.first_point)
        if pin.second is None:
            # The anchor is given in the frame of name1; on a body it stays as exact as the body's frame.
            names.reverse()
        loop = building.hold(mujoco.mjtEq.mjEQ_CONNECT, names[1], names[0], rows=2)
        loop.data[:3] = [*world_offset(building.mechanism, name, point), 0.0]


def add_welds(building: Building, welds: Sequence[Weld]) -> None:
    """Add the welds that close loops."""
    add_pins(building, welds)
    for weld in welds:
        _hold_angles(building, f"weld {weld.name}", building.tree.turning(weld.first, weld.second))


def add_gears(building: Building, gears: Sequence[Gear]) -> None:
    """Add the gears: the second body's angle less `ratio` times the first's stays as it is at the start."""
    for gear in gears:
        signs = dict(building.tree.turning(None, gear.second))
        for column, sign in building.tree.turning(None, gear.first).items():
            signs[column] = signs.get(column, 0.0) - gear.ratio * sign
        _hold_angles(building, f"gear {gear.name}", signs)


def _hold_angles(building: Building, name: str, signs: Mapping[int, float]) -> None:
    """An equality of the sum of coordinates; none where no coordinate can change it."""
    turning = {column: sign for column, sign in signs.items() if sign}
    if turning:
        building.add_sum(name, turning)
        building.hold_tendon(name)


def add_rods(building: Building, rods: Sequence[Rod], by: RodBy) -> None:
    """Add the rods by this construction."""
    for rod in rods:
        if by == "rows":
            building.write("rod", rod, (*rod.first_point, *rod.second_point, rod.length, *building.gains))
        else:
            building.add_between(f"rod {rod.name}", rod)
            building.hold_tendon(f"rod {rod.name}")
