"""A Pin in MuJoCo: a hinge of the tree, or a `connect` where it closes a loop.

The hinges are made with the tree (`engines.tree`). `connect` has three rows; out of the plane nothing can move,
so the third row is empty and harmless.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from engines.mujoco.construction import Building
from engines.tree import world_offset
from reference.joints import Pin, Weld


def add_pins(building: Building, pins: Sequence[Pin | Weld]) -> None:
    """Add a `connect` each, bound by MuJoCo in the assembled start pose; its force acts on `name1`: the second body."""
    for pin in pins:
        names = ["world" if name is None else f"body {building.index(name)}" for name in (pin.first, pin.second)]
        name, point = (pin.second, pin.second_point) if pin.second is not None else (pin.first, pin.first_point)
        if pin.second is None:
            # The anchor is given in the frame of name1; on a body it stays as exact as the body's frame.
            names.reverse()
        x, y = world_offset(building.mechanism, name, point)
        loop = building.spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=names[1],
            name2=names[0],
            solref=list(building.stiffness.reference(building.mechanism, building.dt)),
            solimp=list(building.stiffness.impedance),
        )
        loop.data[:3] = [x, y, 0.0]
    building.size += 2 * len(pins)
