"""Mechanisms of rods, gears, welds and every kind of force, built by hand; and one for each alone."""

from __future__ import annotations

import math
from dataclasses import replace

from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Gear, Pin, Rod, Vector, Weld
from reference.mechanism import Body, Mechanism
from reference.plane import components

GRAVITY = (0.0, -9.81)
POSES = {"a": (1.0, 0.0, 0.3), "b": (2.0, 0.0, 0.5), "c": (2.2, 0.5, -0.2), "d": (3.2, 0.5, -0.2)}
MASSES = {"a": (1.0, 0.3), "b": (1.5, 0.2), "c": (0.7, 0.1), "d": (0.7, 0.1)}


def bodies(*names: str) -> tuple[Body, ...]:
    """At rest."""
    return tuple(Body(name, *MASSES[name], POSES[name]) for name in names)


def world(name: str | None, point: Vector) -> Vector:
    """A body's own point [m] in the world at the start."""
    if name is None:
        return point
    x, y, angle = POSES[name]
    along, across = components(angle, *point)
    return (float(x + along), float(y + across))


def own(name: str | None, point: Vector) -> Vector:
    """The world's point [m] in the body's own frame at the start."""
    if name is None:
        return point
    x, y, angle = POSES[name]
    along, across = components(-angle, point[0] - x, point[1] - y)
    return (float(along), float(across))


def pin(name: str, first: str | None, second: str, point: Vector) -> Pin:
    """At a point of the world."""
    return Pin(name, first, second, own(first, point), own(second, point))


def rod(name: str, first: str | None, second: str, first_point: Vector, second_point: Vector) -> Rod:
    """As long as its points are apart at the start."""
    length = math.dist(world(first, first_point), world(second, second_point))
    return Rod(name, first, second, first_point, second_point, length)


HUNG = pin("A", None, "a", (0.0, 0.0))
BETWEEN = pin("B", "a", "b", (1.5, 0.1))
GROUND_ROD = rod("ground rod", None, "a", (0.0, 0.0), (0.2, 0.1))
ROD = rod("rod", "a", "b", (0.1, 0.0), (0.0, 0.2))
GEAR = Gear("gear", "a", "b", -2.0, 0.5 + 2 * 0.3)
WELD = Weld("weld", "b", "c", own("b", (2.1, 0.2)), own("c", (2.1, 0.2)), -0.2 - 0.5)
SPRING = Spring("spring", None, "a", (0.3, 1.0), (0.2, 0.1), 30.0, 0.5)
SPRINGS = (
    SPRING,
    Spring("at a distance", "c", "d", (0.1, 0.0), (0.2, 0.1), 13.0, 0.5),
    Spring("without length", "c", "d", (0.1, 0.0), (0.2, 0.1), 3.0),
    TorsionSpring("twisted", "c", "d", 1.0, 0.2),
)
PUSHES = (
    Torque("grounded", None, "b", 1.0),
    Torque("mutual", "a", "d", 0.1),
    Force("push", "d", (0.1, 0.4), (1.0, 2.0)),
)
DAMPERS = (
    Damper("grounded damper", None, "d", (0.0, 0.0), (0.2, 0.1), 0.3),
    Damper("mutual damper", "c", "a", (0.0, 0.1), (0.2, 0.1), 0.3),
    TorsionDamper("turning damper", "c", "a", 0.1),
)
ALL = Mechanism(bodies("a", "b", "c", "d"), (GROUND_ROD, ROD, GEAR, WELD), GRAVITY, (*SPRINGS, *PUSHES))
DAMPED = replace(ALL, forces=(*ALL.forces, *DAMPERS))
TWO = Mechanism(bodies("a", "b"), (HUNG, BETWEEN), GRAVITY)
ALONE = {
    "spring": Mechanism(bodies("a"), (), GRAVITY, (SPRING,)),
    "damper": replace(TWO, joints=(HUNG,), forces=(Damper("d", "a", "b", (0.0, 0.1), (0.2, 0.1), 1.5),)),
    "torsion spring": replace(TWO, forces=(TorsionSpring("s", "a", "b", 5.0, 0.4),)),
    "torsion damper": replace(TWO, forces=(TorsionDamper("d", "a", "b", 0.5),)),
    "torque": replace(TWO, forces=(Torque("t", "a", "b", 0.5),)),
    "force": replace(TWO, forces=(Force("f", "b", (0.3, 0.4), (1.0, 12.0)),)),
    "rod to the ground": Mechanism(bodies("a"), (GROUND_ROD,), GRAVITY),
    "rod": Mechanism(bodies("a", "b"), (HUNG, ROD), GRAVITY),
    "gear": Mechanism(bodies("a", "b"), (GEAR, ROD), GRAVITY, (SPRING,)),
    "weld": Mechanism(bodies("a", "b", "c"), (HUNG, BETWEEN, WELD), GRAVITY),
    "weld to the ground": Mechanism(
        bodies("a", "b"), (Weld("w", None, "a", (0.0, 0.0), own("a", (0.0, 0.0)), 0.3), BETWEEN), GRAVITY
    ),
    "weld in a loop": Mechanism(
        bodies("a", "b", "c", "d"),
        (
            HUNG,
            BETWEEN,
            WELD,
            pin("D", None, "d", (3.2, 1.0)),
            pin("C", "c", "d", (2.7, 0.7)),
            Weld("closing", "b", "c", own("b", (2.1, 0.2)), own("c", (2.1, 0.2)), -0.2 - 0.5),
        ),
        GRAVITY,
    ),
}
