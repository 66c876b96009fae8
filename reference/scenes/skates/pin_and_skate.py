"""A body with a pin or a skate at C (box 18.3): the rows, the skate's kinematics on a given path, the pinned body.

The pinned body (18.62), coasting or under gravity, is exact: the holonomic case beside the skate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Valid, sample_times, validated
from reference.joints import Pin, Triple, Vector
from reference.kinds import of_shape
from reference.mechanism import Body, Mechanism
from reference.numerics.calculus import Antiderivative
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scene import Scene
from reference.scenes.pendulum.link import Pendulum
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
Rate = float | Callable[[Any], Any]

COMPLEX_STEP = 1e-100


@validated
def pin_rows(angle: Complexes, point: Vector) -> Array:
    """The rows of (18.62) (..., 2, 3) in the rates of x_O', y_O', theta, for C at `point` [m] in the body's frame."""
    angle = np.asarray(angle)
    cosine, sine = np.cos(angle), np.sin(angle)
    one, zero = np.ones_like(cosine), np.zeros_like(cosine)
    return np.stack(
        [
            np.stack([one, zero, -sine * point[0] - cosine * point[1]], axis=-1),
            np.stack([zero, one, cosine * point[0] - sine * point[1]], axis=-1),
        ],
        axis=-2,
    )


@validated
def skate_row(angle: Complexes, point: Vector) -> Array:
    """The row of (18.64) (..., 1, 3): C can't move across the body's i'. The coordinate y'_C drops out."""
    angle = np.asarray(angle)
    return np.stack([-np.sin(angle), np.cos(angle), np.full_like(np.cos(angle), point[0])], axis=-1)[..., None, :]


@validated
def pin_constants(pose: Annotated[Complexes, of_shape("...", 3)], point: Vector) -> Array:
    """C_1 and C_2 of (18.63) (..., 2) [m] for poses (..., 3): the pin's place, which integrates (18.62)."""
    x, y, angle = np.moveaxis(np.asarray(pose), -1, 0)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([x + cosine * point[0] - sine * point[1], y + sine * point[0] + cosine * point[1]], axis=-1)


@validated
def pinned_pose(angle: ArrayLike, constants: Vector, point: Vector) -> Array:
    """Poses (..., 3) of the pinned body at an angle [rad]: (18.63) solved for x_O' and y_O'."""
    angle = np.asarray(angle, dtype=float)
    cosine, sine = np.cos(angle), np.sin(angle)
    x = constants[0] - cosine * point[0] + sine * point[1]
    y = constants[1] - sine * point[0] - cosine * point[1]
    return np.stack([x, y, angle], axis=-1)


def _derivative(function: Callable[[Any], Any], t: Array, name: str) -> Array:
    """df/dt by complex step, checked against a central difference: a function with abs() in it would be wrong."""
    try:
        exact = np.broadcast_to(np.imag(function(t + 1j * COMPLEX_STEP)) / COMPLEX_STEP, t.shape)
    except TypeError as error:
        raise InvalidMechanism(
            f"skate path: {name} takes no complex times, so it can't be differentiated exactly ({error}); "
            f"write it with numpy's analytic functions"
        ) from error
    step = 1e-5 * np.maximum(1.0, np.abs(t))
    forward, backward = function(t + step), function(np.maximum(t - step, 0.0))
    rough = np.broadcast_to(np.real(forward - backward), t.shape) / (step + np.minimum(step, t))
    if np.any(np.abs(rough - exact) > 1e-2 * (1 + np.abs(rough).max(initial=0.0))):
        raise InvalidMechanism(
            f"skate path: {name} is not an analytic function of time, so its derivative is not known exactly; "
            f"write it with numpy's analytic functions and without abs or jumps"
        )
    return exact


@dataclass(frozen=True)
class SkatePath(Valid):
    """The motion of a skate at C with a given speed v_C [m/s] along i' (signed) and turning rate [rad/s].

    Each is a number, or a function that takes an array of times [s] from 0 on and gives an array. `start` is the pose
    of C and i' at t = 0. With two numbers the path is an arc in closed form; otherwise x' = v_C cos theta, y' = v_C sin
    theta (last equations of the section) are integrated to rounding, in panels no longer than `panel` [s], which must
    not exceed by much the fastest time in the functions. `acceleration` needs functions that take complex times.
    """

    speed: Rate
    turning_rate: Rate
    start: Triple = (0.0, 0.0, 0.0)
    panel: Positive = 0.5

    def _given(self, name: str, t: Array) -> Array:
        value = getattr(self, name)
        if not callable(value):
            return np.full(t.shape, float(value))
        out = np.broadcast_to(np.asarray(value(t), dtype=float), t.shape)
        if not np.all(np.isfinite(out)):
            raise InvalidMechanism(f"skate path: {name} is not finite at {t[~np.isfinite(out)][0]!r} s; it must be")
        return out

    def _rate_of(self, name: str, t: Array) -> Array:
        value = getattr(self, name)
        return _derivative(value, t, name) if callable(value) else np.zeros(t.shape)

    @cached_property
    def _turned(self) -> Antiderivative:
        return Antiderivative(lambda t: self._given("turning_rate", t), self.panel)

    @cached_property
    def _moved(self) -> Antiderivative:
        return Antiderivative(lambda t: self._given("speed", t) * np.exp(1j * self._heading(t)), self.panel)

    def _heading(self, t: Array) -> Array:
        if callable(self.turning_rate):
            return self.start[2] + self._turned(t)
        return self.start[2] + self.turning_rate * t

    def pose(self, t: ArrayLike) -> Array:
        """x, y of C and the heading theta (times, 3) [m, m, rad, not wrapped] at times t >= 0."""
        times = sample_times("skate path", t)
        if callable(self.speed) or callable(self.turning_rate):
            moved = self._moved(times)
        else:
            half = 0.5 * self.turning_rate * times
            moved = self.speed * times * np.sinc(half / np.pi) * np.exp(1j * (self.start[2] + half))
        return np.stack([self.start[0] + np.real(moved), self.start[1] + np.imag(moved), self._heading(times)], axis=-1)

    def _arm(self, times: Array, point: Vector) -> tuple[Array, Array]:
        """i' (times, 2) and r_G/C (times, 2) in world components."""
        heading = self._heading(times)
        along = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        left = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
        return along, point[0] * along + point[1] * left

    @validated
    def velocity(self, t: ArrayLike, point: Vector = (0.0, 0.0)) -> Array:
        """v_G = v_C i' + theta_dot k x r_G/C (times, 2) [m/s]; `point` is G from C in the frame of i', j' [m]."""
        times = sample_times("skate path", t)
        along, arm = self._arm(times, point)
        own = self._given("speed", times)[:, None] * along
        return own + rotation_velocity(self._given("turning_rate", times), arm)

    @validated
    def acceleration(self, t: ArrayLike, point: Vector = (0.0, 0.0)) -> Array:
        """a_G = v_C' i' + v_C theta_dot j' + theta_ddot k x r_G/C - theta_dot^2 r_G/C (times, 2) [m/s^2].

        The second term is Coriolis-like but has no factor 2, and is not v_C d(j')/dt as printed (that points along i').
        Raises InvalidMechanism if a given function is not analytic, so that its derivative is not known exactly.
        """
        times = sample_times("skate path", t)
        along, arm = self._arm(times, point)
        speed, turning_rate = self._given("speed", times), self._given("turning_rate", times)
        of_c = self._rate_of("speed", times)[:, None] * along + rotation_velocity(speed * turning_rate, along)
        return of_c + rotation_acceleration(turning_rate, self._rate_of("turning_rate", times), arm)


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
