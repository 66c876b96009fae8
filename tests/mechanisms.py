"""Mechanisms built by hand for tests of the core, and scenes at the limits of their parameters."""

from __future__ import annotations

from typing import cast

import numpy as np

from reference.joints import Drive, Joint, Pin
from reference.mechanism import Body, Mechanism
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
    """The chapter's linkage at its start: B = (0, 0.4), C = (0.4, 0.8), D = (1.2, 0); rates by (18.70), (18.71)."""
    b, c, d = (0.0, 0.4), (0.4, 0.8), (1.2, 0.0)
    bodies = (
        bar("crank", (0.0, 0.0), b, rate=crank_rate),
        bar("coupler", b, c, velocity=(-0.4 * crank_rate, 0.0), rate=-crank_rate / 2),
        bar("rocker", d, c, rate=crank_rate / 4),
    )
    half = [body.mass / 2 for body in bodies]  # 1 kg/m: a bar's mass is its length
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
    """One uniform bar that hangs from the origin at `angle` [rad] from +x."""
    end = (length * np.cos(angle), length * np.sin(angle))
    body = bar("bar", (0.0, 0.0), end, rate=rate)
    return Mechanism((body,), (Pin("A", None, "bar", (0.0, 0.0), (-length / 2, 0.0)),), (0.0, -9.81))


def rolling_disc(
    rolling: Rolling, rate: float = 0.0, name: str = "disc", first: str | None = None
) -> tuple[Body, Roll]:
    """A disc of 1 kg whose circle rolls at `rate` [rad/s] on a curve of `first` or the ground; and its joint."""
    x, y, angle = (float(value) for value in rolling.pose(rolling.theta))
    vx, vy = (float(value) for value in rolling.velocity(rolling.theta, rate))
    inertia = cast(Circle, rolling.body).radius ** 2 / 2
    return Body(name, 1.0, inertia, (x, y, angle), (vx, vy, rate)), Roll(f"{name} rolls", first, name, rolling)


def elbow() -> Mechanism:
    """Two bars from the origin, driven against each other where they meet."""
    upper, lower = bar("upper", (0.0, 0.0), (1.0, 0.0)), bar("lower", (1.0, 0.0), (1.0, -0.7), rate=2.0)
    joints = (
        Pin("A", None, "upper", (0.0, 0.0), (-0.5, 0.0)),
        Pin("B", "upper", "lower", (0.5, 0.0), (-0.35, 0.0)),
        Drive("motor", "upper", "lower", 2.0, -np.pi / 2),
    )
    return Mechanism((upper, lower), joints, (0.0, -9.81))
