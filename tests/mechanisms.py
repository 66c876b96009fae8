"""Mechanisms with every joint and force class, and scenes in which methods fail."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

import numpy as np

from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Vector, Weld
from reference.mechanism import Body, Mechanism
from reference.plane import components
from reference.rolling.curves import Circle
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scenes.four_bar.scenes import OverdrivenFourBar, Parallelogram
from reference.scenes.pendulum.scenes import LongPendulum, SpinningRing
from reference.scenes.rolling.scenes import DiscInHole, SquareOnCatenaries
from reference.scenes.skates import HeldBySkates, SkateOnSlope
from reference.scenes.slider_crank import RodEndInSlot, SliderAtDeadCentre, SlottedLever

SCENES_OF_LIMITS = (
    *(Parallelogram(), OverdrivenFourBar(), SkateOnSlope(), HeldBySkates(), DiscInHole(), SquareOnCatenaries()),
    *(SpinningRing(links=5), RodEndInSlot(), SliderAtDeadCentre(), LongPendulum(), SlottedLever()),
)


def bar(
    name: str, start: tuple[float, float], end: tuple[float, float], velocity=(0.0, 0.0), rate: float = 0.0
) -> Body:
    """A uniform bar of 1 kg/m from start to end [m] whose start moves at `velocity` [m/s]; `rate` [rad/s]."""
    along = np.subtract(end, start)
    length = float(np.hypot(*along))
    centre = np.add(start, end) / 2
    twist = np.add(velocity, rate * np.array([-along[1], along[0]]) / 2)
    angle = float(np.arctan2(along[1], along[0]))
    pose = (float(centre[0]), float(centre[1]), angle)
    return Body(name, length, length**3 / 12, pose, (float(twist[0]), float(twist[1]), rate))


def four_bar(crank_rate: float = 0.0, drive: float | None = None) -> Mechanism:
    """The chapter's linkage with B = (0, 0.4), C = (0.4, 0.8), D = (1.2, 0) and rates by (18.70), (18.71)."""
    b, c, d = (0.0, 0.4), (0.4, 0.8), (1.2, 0.0)
    bodies = (
        bar("crank", (0.0, 0.0), b, rate=crank_rate),
        bar("coupler", b, c, velocity=(-0.4 * crank_rate, 0.0), rate=-crank_rate / 2),
        bar("rocker", d, c, rate=crank_rate / 4),
    )
    half = [body.mass / 2 for body in bodies]  # 1 kg/m
    joints: tuple[Joint, ...] = (
        Pin("A", None, "crank", (0.0, 0.0), (-half[0], 0.0)),
        Pin("B", "crank", "coupler", (half[0], 0.0), (-half[1], 0.0)),
        Pin("C", "coupler", "rocker", (half[1], 0.0), (half[2], 0.0)),
        Pin("D", None, "rocker", d, (-half[2], 0.0)),
    )
    if drive is not None:
        joints += (Drive("drive", None, "crank", drive, np.pi / 2),)
    return Mechanism(bodies, joints, (0.0, -9.81))


def pendulum(angle: float = -np.pi / 2 + 1.0, rate: float = 0.0, length: float = 1.0) -> Mechanism:
    """A uniform bar that hangs from the origin at `angle` [rad] from +x."""
    end = (length * np.cos(angle), length * np.sin(angle))
    body = bar("bar", (0.0, 0.0), end, rate=rate)
    return Mechanism((body,), (Pin("A", None, "bar", (0.0, 0.0), (-length / 2, 0.0)),), (0.0, -9.81))


def rolling_disc(
    rolling: Rolling, rate: float = 0.0, name: str = "disc", first: str | None = None
) -> tuple[Body, Roll]:
    """A disc of 1 kg that rolls at `rate` [rad/s] on a curve of `first` or the ground, and the joint."""
    x, y, angle = (float(value) for value in rolling.pose(rolling.theta))
    vx, vy = (float(value) for value in rolling.velocity(rolling.theta, rate))
    inertia = cast(Circle, rolling.body).radius ** 2 / 2
    return Body(name, 1.0, inertia, (x, y, angle), (vx, vy, rate)), Roll(f"{name} rolls", first, name, rolling)


def elbow() -> Mechanism:
    """Two bars from the origin with a drive at the pin between the bars."""
    upper, lower = bar("upper", (0.0, 0.0), (1.0, 0.0)), bar("lower", (1.0, 0.0), (1.0, -0.7), rate=2.0)
    joints = (
        Pin("A", None, "upper", (0.0, 0.0), (-0.5, 0.0)),
        Pin("B", "upper", "lower", (0.5, 0.0), (-0.35, 0.0)),
        Drive("motor", "upper", "lower", 2.0, -np.pi / 2),
    )
    return Mechanism((upper, lower), joints, (0.0, -9.81))


GRAVITY = (0.0, -9.81)
POSES = {"a": (1.0, 0.0, 0.3), "b": (2.0, 0.0, 0.5), "c": (2.2, 0.5, -0.2), "d": (3.2, 0.5, -0.2)}
MASSES = {"a": (1.0, 0.3), "b": (1.5, 0.2), "c": (0.7, 0.1), "d": (0.7, 0.1)}


def bodies(*names: str) -> tuple[Body, ...]:
    return tuple(Body(name, *MASSES[name], POSES[name]) for name in names)


def world(name: str | None, point: Vector) -> Vector:
    """The world coordinates [m] of a body's point at the start."""
    if name is None:
        return point
    x, y, angle = POSES[name]
    along, across = components(angle, *point)
    return (float(x + along), float(y + across))


def own(name: str | None, point: Vector) -> Vector:
    """The coordinates [m] of a world point in a body's frame at the start."""
    if name is None:
        return point
    x, y, angle = POSES[name]
    along, across = components(-angle, point[0] - x, point[1] - y)
    return (float(along), float(across))


def pin(name: str, first: str | None, second: str, point: Vector) -> Pin:
    return Pin(name, first, second, own(first, point), own(second, point))


def rod(name: str, first: str | None, second: str, first_point: Vector, second_point: Vector) -> Rod:
    """A rod whose length is the distance of its points at the start."""
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
