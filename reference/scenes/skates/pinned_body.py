"""A body on a fixed pin (18.62), coasting or under gravity, exact: the holonomic case beside the skate."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Positive, validated
from reference.joints import Pin, Vector
from reference.mechanism import Body, Mechanism
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scene import Scene
from reference.scenes.pendulum.link import Pendulum
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@validated
def pinned_pose(angle: ArrayLike, constants: Vector, point: Vector) -> Array:
    """Poses (..., 3) of the pinned body at an angle [rad]: (18.63) solved for x_O' and y_O'."""
    angle = np.asarray(angle, dtype=float)
    cosine, sine = np.cos(angle), np.sin(angle)
    x = constants[0] - cosine * point[0] + sine * point[1]
    y = constants[1] - sine * point[0] - cosine * point[1]
    return np.stack([x, y, angle], axis=-1)


@dataclass(frozen=True)
class PinnedBody(Scene):
    """mass [kg], inertia [kg m^2] about the centre of mass; the body's `point` [m], from there, is pinned at `pin` [m].

    angle [rad] of the body and turning_rate [rad/s] at t = 0; gravity [m/s^2] in any direction, or none. Under gravity
    the line from the pin to the centre of mass is a pendulum, frequency^2 = m g r / (I + m r^2), swinging or whirling.
    Raises InvalidMechanism for numbers not finite, or mass or inertia not positive.
    """

    name: ClassVar[str] = "pinned_body"
    source: ClassVar[str] = "box 18.3, eqs. 18.62-18.63"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    point: Vector = (-0.5, 0.0)
    pin: Vector = (0.0, 0.0)
    angle: float = 0.5
    turning_rate: float = 2.0
    gravity: Vector = (0.0, -9.81)
    duration: Positive = 3.0
    horizon: Positive = 3.0  # an error in the energy makes the phase drift in proportion to time

    @cached_property
    def _lag(self) -> float:
        """What to add to the body's angle to have the pendulum's, from the direction of gravity [rad]."""
        return math.atan2(-self.point[1], -self.point[0]) - math.atan2(self.gravity[1], self.gravity[0])

    @cached_property
    def frequency(self) -> float:
        """Of small swings [rad/s]; zero without gravity, or pinned at the centre of mass: then it only turns."""
        arm, pull = math.hypot(*self.point), math.hypot(*self.gravity)
        return math.sqrt(self.mass * pull * arm / (self.inertia + self.mass * arm**2))

    def _turning(self, t: Array) -> tuple[Array, Array, Array]:
        """Angle [rad], rate [rad/s] and acceleration [rad/s^2] of the body."""
        if self.frequency == 0:
            return self.angle + self.turning_rate * t, np.full(t.shape, self.turning_rate), np.zeros(t.shape)
        pendulum = Pendulum(self.frequency, self.angle + self._lag, self.turning_rate)
        angle, rate, acceleration = pendulum.motion(t)
        return angle - self._lag, rate, acceleration

    def mechanism(self) -> Mechanism:
        motion = self.motion(0.0)
        pose, twist = motion.pose[0, 0].tolist(), motion.twist[0, 0].tolist()
        body = Body("body", self.mass, self.inertia, tuple(pose), tuple(twist))
        return Mechanism((body,), (Pin("pin", None, "body", self.pin, self.point),), self.gravity)

    def _motion(self, times: Array) -> Trajectory:
        angle, rate, acceleration = self._turning(times)
        pose = pinned_pose(angle, self.pin, self.point)
        arm = pose[:, :2] - np.array(self.pin)
        twist = np.concatenate([rotation_velocity(rate, arm), rate[:, None]], axis=-1)
        pull = rotation_acceleration(rate, acceleration, arm) - np.array(self.gravity)
        return Trajectory(times, pose[:, None, :], twist[:, None, :], self.mass * pull)


@dataclass(frozen=True)
class FreelyPinnedBody(PinnedBody):
    """The pinned body seen from above: nothing pulls, it turns evenly for ever."""

    name: ClassVar[str] = "pinned_body_free"

    gravity: Vector = (0.0, 0.0)
