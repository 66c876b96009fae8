"""Rolling where methods fail: a disc in a hole of nearly its size, and a square that comes to its corner."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from scipy.integrate import quad

from reference.checks import Positive
from reference.kinds import Rule
from reference.rolling.circles_lines import Circle, Ring, Side
from reference.rolling.curves import Array, Curve, Placed, Vector
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary
from reference.scenes.rolling.body import RollingBody
from reference.scenes.rolling.scenes import RollingScene
from reference.trajectory import Trajectory

Clearance = Annotated[float, Rule(lambda value: 0 < value < 1, "between 0 and 1")]


@dataclass(frozen=True)
class DiscInHole(RollingScene):
    """A round disc that rolls round in a hole larger by the fraction `clearance`, without gravity.

    Nothing slows it, so that it turns at a constant rate w; but the contact runs round the hole at about
    w / clearance, and the disc's centre round a small circle as fast: the nearer to conformal, the faster.
    """

    name: ClassVar[str] = "disc_in_hole"

    hole: Positive = 1.0  # m, radius
    clearance: Clearance = 0.1  # of the hole's radius
    start_rate: float = 1.0
    gravity: Vector = (0.0, 0.0)
    duration: Positive = 1.0

    @property
    def radius(self) -> float:
        """m, of the disc."""
        return self.hole * (1 - self.clearance)

    def body_curve(self) -> Curve:
        return Circle(self.radius)

    def ground_curve(self) -> Curve:
        return Ring(self.hole)

    @property
    def inertia(self) -> float:
        return self.mass * self.radius**2 / 2

    @cached_property
    def comparable_until(self) -> float:  # type: ignore[override]
        """The hole presses with mass clearance hole (w radius / (clearance hole))^2 and needs no friction: always."""
        return math.inf

    def _motion(self, times: Array) -> Trajectory:
        """In closed form, since an integrator would follow rounding round the hole."""
        rolling = self.motion_law.rolling
        theta = rolling.theta + self.start_rate * times
        contact = rolling.contact(theta)
        force = self.mass * rolling.acceleration(theta, self.start_rate, 0.0)
        velocity = rolling.velocity(theta, self.start_rate)
        rate = np.full((len(times), 1), self.start_rate)
        return Trajectory(
            t=times,
            pose=np.concatenate([contact.point + contact.arm, theta[:, None]], axis=-1)[:, None, :],
            twist=np.concatenate([velocity, rate], axis=-1)[:, None, :],
            reaction=np.stack(
                [np.sum(force * contact.tangent, axis=-1), np.sum(force * contact.normal, axis=-1)], axis=-1
            ),
        )


@dataclass(frozen=True)
class SquareOnCatenaries(RollingScene):
    """A square on the arch of a catenary that fits its side: its centre stays level until it stands on a corner.

    At the corner the curvature is infinite and the contact has no direction to go on; the reference refuses there.
    """

    name: ClassVar[str] = "square_on_catenary"
    source: ClassVar[str] = "rolling of not round objects: a corner is a curve of infinite curvature"

    side: Positive = 1.0  # m
    start_rate: float = 1.0
    duration: Positive = 1.5

    def body_curve(self) -> Curve:
        return Side(self.side)

    def ground_curve(self) -> Curve:
        return Placed(Catenary(self.side / 2), turn=math.pi)

    @property
    def inertia(self) -> float:
        return self.mass * self.side**2 / 6

    @cached_property
    def motion_law(self) -> RollingBody:  # type: ignore[override]
        """From the middle of the side at the top of the arch: a straight side doesn't tell the place by its angle."""
        rolling = Rolling.at_arcs(self.body_curve(), self.ground_curve())
        return RollingBody(rolling, self.mass, self.inertia, self.start_rate, self.gravity)

    @cached_property
    def comparable_until(self) -> float:  # type: ignore[override]
        """The arch is never too steep for a friction of 1 before the corner: what ends the motion is the corner."""
        return math.inf

    @property
    def corner(self) -> float:
        """When it stands on its corner [s]: a quarter of a half turn, at a rate that energy gives in closed form.

        The centre is level, so the kinetic energy stays: M(theta) theta'^2 with M = inertia + mass r^2 and, for this
        arch, r = side / (2 cos theta).
        """

        def mass(theta: float) -> float:
            return self.inertia + self.mass * (self.side / 2 / math.cos(theta)) ** 2

        whole = quad(lambda theta: math.sqrt(mass(theta) / mass(0.0)), 0.0, math.pi / 4, epsabs=1e-14, epsrel=1e-14)
        return whole[0] / abs(self.start_rate)
