"""A Rod, a Gear, and a Weld that closes a loop, in MuJoCo.

A weld between bodies that nothing else joins is in the tree: a body without a coordinate. One that closes a loop is a
`connect` and a row of angles. Rows of angles, of gears too, are sums of tree coordinates with constant coefficients: a
fixed tendon, held by an equality that has no velocity term and needs none.

`RodBy` names what holds a rod:

- "tendon": MuJoCo's own parts alone, an equality of a spatial tendon between two sites. Up to 4.0.1 it leaves out the
  velocity term -(dJ/dt) v, which its spring has to make up for by a gap.
- "rows": the rod's own row, written by a callback in every stage.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco

from engines.mujoco.construction import Building
from engines.mujoco.joints.pin import add_pins
from engines.mujoco.written_rows import Law, Row, State, WrittenJoint
from engines.tree import world_offset
from reference.joints import Gear, Rod, Weld

RodBy = Literal["tendon", "rows"]


def add_rods(building: Building, rods: Sequence[Rod], by: RodBy) -> None:
    """Add the rods by this construction."""
    for rod in rods:
        if by == "rows":
            first, second = building.index(rod.first), building.index(rod.second)
            gains = building.stiffness.gains(building.mechanism, building.dt)
            building.written.append(WrittenJoint(first, second, 1, rod_rows(rod, *gains)))
            continue
        tendon = building.spec.add_tendon(name=f"rod {rod.name}")
        for name, point, end in ((rod.first, rod.first_point, "first"), (rod.second, rod.second_point, "second")):
            tendon.wrap_site(add_site(building, f"rod {rod.name} {end}", name, point))
        _hold(building, f"rod {rod.name}")
        building.size += 1


def add_gears(building: Building, gears: Sequence[Gear]) -> None:
    """Add the gears: the second body's angle less `ratio` times the first's stays as it is at the start."""
    for gear in gears:
        signs = dict(building.tree.turning(None, gear.second))
        for column, sign in building.tree.turning(None, gear.first).items():
            signs[column] = signs.get(column, 0.0) - gear.ratio * sign
        _hold_angles(building, f"gear {gear.name}", signs)


def add_welds(building: Building, welds: Sequence[Weld]) -> None:
    """Add the welds that close loops."""
    add_pins(building, welds)
    for weld in welds:
        _hold_angles(building, f"weld {weld.name}", building.tree.turning(weld.first, weld.second))


def add_site(building: Building, name: str, body: str | None, point: tuple[float, float]) -> str:
    """A site at a body's own point [m]; its name."""
    carrier = building.spec.worldbody if body is None else building.spec.body(f"body {building.index(body)}")
    carrier.add_site(name=name, pos=[*world_offset(building.mechanism, body, point), 0.0])
    return name


def _hold_angles(building: Building, name: str, signs: Mapping[int, float]) -> None:
    """An equality of the sum of coordinates; none where no coordinate can change it."""
    turning = {column: sign for column, sign in signs.items() if sign}
    if turning:
        tendon = building.spec.add_tendon(name=name)
        for column, sign in sorted(turning.items()):
            tendon.wrap_joint(f"coordinate {column}", sign)
        _hold(building, name)
        building.size += 1


def _hold(building: Building, name: str) -> None:
    building.spec.add_equality(
        type=mujoco.mjtEq.mjEQ_TENDON,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        name1=name,
        solref=list(building.stiffness.reference(building.mechanism, building.dt)),
        solimp=list(building.stiffness.impedance),
    )


def rod_rows(rod: Rod, stiffness: float, damping: float) -> Law:
    """The rod's row and -(dJ/dt) v - damping slip - stiffness gap, see `reference.joints.Rod`."""
    return Law(rod_row, (*rod.first_point, *rod.second_point, rod.length, stiffness, damping))


def rod_row(numbers: tuple[float, float, float, float, float, float, float], first: State, second: State) -> Row:
    """Of a point on either body [m], the length [m], stiffness [1/s^2] and damping [1/s]."""
    first_x, first_y, second_x, second_y, length, stiffness, damping = numbers
    x1, y1, angle1, vx1, vy1, omega1 = first
    x2, y2, angle2, vx2, vy2, omega2 = second
    cosine, sine = math.cos(angle1), math.sin(angle1)
    own_x1, own_y1 = cosine * first_x - sine * first_y, sine * first_x + cosine * first_y
    cosine, sine = math.cos(angle2), math.sin(angle2)
    own_x2, own_y2 = cosine * second_x - sine * second_y, sine * second_x + cosine * second_y
    x, y = x2 + own_x2 - x1 - own_x1, y2 + own_y2 - y1 - own_y1
    now = math.sqrt(x * x + y * y)
    x, y = x / now, y / now
    rate_x = vx2 - omega2 * own_y2 - vx1 + omega1 * own_y1
    rate_y = vy2 + omega2 * own_x2 - vy1 - omega1 * own_x1
    slip, across = x * rate_x + y * rate_y, x * rate_y - y * rate_x
    square1, square2 = omega1 * omega1, omega2 * omega2
    changing = x * (square1 * own_x1 - square2 * own_x2) + y * (square1 * own_y1 - square2 * own_y2)
    changing += across * across / now
    return (
        -x, -y, x * own_y1 - y * own_x1,
        x, y, y * own_x2 - x * own_y2,
        -changing - damping * slip - stiffness * (now - length),
    )  # fmt: skip
