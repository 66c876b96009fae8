"""Scenes of bodies that are not round, or eccentric, and roll under gravity on flat and on curved ground.

Methods fail in two scenes: a disc in a hole of nearly the same size, and a square that rolls to its corner.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from reference.checks import Positive
from reference.mechanism import Body, Mechanism
from reference.plane import placed
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring, Side, Vector
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import Catenary
from reference.rolling.roll import Roll
from reference.scene import Scene, shared
from reference.scenes.rolling.body import GRAVITY, RollingBody
from reference.trajectory import Trajectory
from reference.validators import Array, Rule


@dataclass(frozen=True)
class RollingScene(Scene):
    """Base class of scenes in which one body rolls on fixed ground.

    The body's curve has the centre of mass as its origin.
    """

    source: ClassVar[str] = "rolling of not round objects, (18.66)"

    # This limits the cost, since every step searches the contact and bodies on an incline accelerate.
    max_durations: ClassVar[float] = 2.0

    mass: Positive = 1.0  # kg.
    start_angle: float = 0.0  # rad.
    start_rate: float = 4.0  # rad/s.
    ground_arc: float = 0.0  # m, at the start.
    gravity: Vector = (0.0, -GRAVITY)  # m/s^2.
    duration: Positive = 2.0  # s.
    friction: Positive = 1.0  # Of real contacts.

    @abstractmethod
    def body_curve(self) -> Curve:
        """The body's boundary in its own frame, from the centre of mass."""

    def ground_curve(self) -> Curve:
        """The ground's boundary, by default flat ground through the origin."""
        return Line()

    @property
    @abstractmethod
    def inertia(self) -> float:
        """Inertia about the centre of mass [kg m^2]."""

    @property
    def motion_law(self) -> RollingBody:
        """The rolling body with its forces, friction, hop, slip and small oscillations."""
        return shared(RollingScene._motion_law, self)

    def _motion_law(self) -> RollingBody:
        rolling = Rolling.at_angle(self.body_curve(), self.ground_curve(), self.start_angle, self.ground_arc)
        return RollingBody(rolling, self.mass, self.inertia, self.start_rate, self.gravity)

    @cached_property
    def hop(self) -> float | None:
        """The time [s] after which the contact would have to pull, or None without such a time."""
        return self.motion_law.hop(self.duration)

    @cached_property
    def comparable_until(self) -> float:  # type: ignore[override]
        """The time [s] of the first slip or hop of a contact with this friction, after which engines may differ."""
        return shared(RollingScene._until_slip, self)

    def _until_slip(self) -> float:
        slip = self.motion_law.slip(self.friction, self.duration)
        return math.inf if slip is None else slip

    @cached_property
    def horizon(self) -> float:  # type: ignore[override]
        return min(self.duration, self.comparable_until)

    def mechanism(self) -> Mechanism:
        law = self.motion_law
        x, y, angle = (float(value) for value in law.rolling.pose(law.rolling.theta))
        vx, vy = (float(value) for value in law.rolling.velocity(law.rolling.theta, self.start_rate))
        body = Body("roller", self.mass, self.inertia, (x, y, angle), (vx, vy, self.start_rate))
        return Mechanism((body,), (Roll("contact", None, "roller", law.rolling),), self.gravity)

    def _motion(self, times: Array) -> Trajectory:
        law = self.motion_law
        theta, rate = law.states(times)
        twist = placed(law.rolling.velocity(theta, rate), rate)
        return Trajectory(times, law.rolling.pose(theta)[:, None], twist[:, None], np.stack(law.forces(times), axis=-1))


@dataclass(frozen=True)
class RollingEllipse(RollingScene):
    """A uniform elliptic disc on flat ground."""

    name: ClassVar[str] = "rolling_ellipse"

    along_x: Positive = 0.5  # m, semi-axis
    along_y: Positive = 0.3

    def body_curve(self) -> Curve:
        return Ellipse(self.along_x, self.along_y)

    @property
    def inertia(self) -> float:
        return self.mass * (self.along_x**2 + self.along_y**2) / 4


@dataclass(frozen=True)
class RollingDisc(RollingScene):
    """A round disc with an eccentric centre of mass and the inertia of a uniform disc."""

    name: ClassVar[str] = "rolling_disc"

    radius: Positive = 0.4  # m.
    eccentricity: float = 0.15  # m.

    def body_curve(self) -> Curve:
        return Circle(self.radius, (self.eccentricity, 0.0))

    @property
    def inertia(self) -> float:
        return self.mass * self.radius**2 / 2


@dataclass(frozen=True)
class RollingCam(RollingScene):
    """A three-lobed, slightly eccentric cam on flat ground."""

    name: ClassVar[str] = "rolling_cam"

    radius: Positive = 0.4  # m, mean radius.
    cosines: tuple[float, ...] = (0.05, 0.0, 0.02)  # m, its harmonics.
    sines: tuple[float, ...] = (0.0, 0.02)
    gyration: Positive = 0.28  # m

    def body_curve(self) -> Curve:
        return Cam(self.radius, self.cosines, self.sines)

    @property
    def inertia(self) -> float:
        return self.mass * self.gyration**2


@dataclass(frozen=True)
class RollingDownhill(RollingEllipse):
    """The ellipse on an incline that falls to -x, on which the ellipse accelerates."""

    name: ClassVar[str] = "rolling_incline"

    slope: float = 0.1  # rad, positive upwards
    along_y: Positive = 0.4
    start_rate: float = 2.5

    def ground_curve(self) -> Curve:
        return Line(math.pi + self.slope)


@dataclass(frozen=True)
class RollingInRing(RollingEllipse):
    """The ellipse rolls to and fro about the bottom of a round hole."""

    name: ClassVar[str] = "rolling_in_ring"

    ring: Positive = 1.5  # m, radius of the hole about the origin
    start_rate: float = 2.0

    @property
    def samples(self) -> int:
        """Half of the usual number, since contacts on curved ground cost several times as much."""
        return max(1, super().samples // 2)

    def ground_curve(self) -> Curve:
        return Placed(Ring(self.ring), turn=-math.pi / 2)


@dataclass(frozen=True)
class RollingOnCircle(RollingDisc):
    """The eccentric disc rolls down a fixed round hill, and hops when N falls to zero."""

    name: ClassVar[str] = "rolling_on_circle"

    hill: Positive = 1.0  # m, radius of the hill about the origin
    radius: Positive = 0.25
    eccentricity: float = 0.05
    start_rate: float = 1.0
    duration: Positive = 1.2

    def ground_curve(self) -> Curve:
        return Placed(Circle(self.hill), turn=math.pi / 2)


Clearance = Annotated[float, Rule(lambda value: 0 < value < 1, "between 0 and 1")]


@dataclass(frozen=True)
class DiscInHole(RollingScene):
    """A round disc that rolls without gravity in a hole, with (hole - radius) / hole = `clearance`.

    The disc rotates at a constant rate w; the contact and the disc's centre go round at the much higher rate w /
    clearance.
    """

    name: ClassVar[str] = "disc_in_hole"

    hole: Positive = 1.0  # m, radius.
    clearance: Clearance = 0.1
    start_rate: float = 1.0
    gravity: Vector = (0.0, 0.0)
    duration: Positive = 1.0

    @property
    def radius(self) -> float:
        """Radius of the disc [m]."""
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
        """Infinite, since N = mass clearance hole (w radius / (clearance hole))^2 is positive and T is zero."""
        return math.inf

    def _motion(self, times: Array) -> Trajectory:
        rolling = self.motion_law.rolling
        theta = rolling.theta + self.start_rate * times
        contact = rolling.contact(theta)
        force = self.mass * rolling.acceleration(theta, self.start_rate, 0.0)
        pose = placed(contact.point + contact.arm, theta)
        twist = placed(rolling.velocity(theta, self.start_rate), np.full(len(times), self.start_rate))
        reaction = [np.sum(force * direction, axis=-1) for direction in (contact.tangent, contact.normal)]
        return Trajectory(times, pose[:, None], twist[:, None], np.stack(reaction, axis=-1))


@dataclass(frozen=True)
class SquareOnCatenaries(RollingScene):
    """A square that rolls on an arch of a catenary. Its centre moves on a horizontal line.

    The curvature is infinite at a corner of the square, so the motion ends with an error when a corner touches.
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
        """The contact at the start is the middle of the side and the top of the arch."""
        rolling = Rolling.at_arcs(self.body_curve(), self.ground_curve())
        return RollingBody(rolling, self.mass, self.inertia, self.start_rate, self.gravity)

    @cached_property
    def comparable_until(self) -> float:  # type: ignore[override]
        """Infinite, since a friction of 1 suffices until the corner."""
        return math.inf

    @property
    def corner(self) -> float:
        """The time [s] at which the corner is reached, after an eighth of a turn.

        The centre moves on a level line, so the kinetic energy M(theta) theta'^2 / 2 is constant. Here M = inertia +
        mass r^2, and r = side / (2 cos theta) for this arch.
        """
        from scipy.integrate import quad

        def mass(theta: float) -> float:
            return self.inertia + self.mass * (self.side / 2 / math.cos(theta)) ** 2

        angle, _ = quad(lambda theta: math.sqrt(mass(theta) / mass(0.0)), 0.0, math.pi / 4, epsabs=1e-14, epsrel=1e-14)
        return angle / abs(self.start_rate)
