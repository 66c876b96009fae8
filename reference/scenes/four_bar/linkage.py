"""The four-bar linkage in closed form: position, rates, accelerations, limits and forces (sample 18.15, 18.67-18.71).

Angles [rad] from +x, counter-clockwise: theta of A -> B (crank), beta of B -> C (coupler), phi of D -> C (rocker, the
chapter's "rod CD"). A is the origin, and D is any other point. `branch` (assembly mode) is +1 if C is left of the
directed line B -> D, as in the chapter's figure, else -1.
Forces are those of uniform bars, by Newton's and Euler's laws.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import Count, InvalidMechanism, Positive, Sign, Signs, Valid, short_repr, validated
from reference.joints import Vector
from reference.plane import from_complex
from reference.scenes.four_bar.closed_form import Constants, Interval, Kinematics, OutOfReach, closed_form, grashof
from reference.validators import Array, of_shape

Densities = Positive | tuple[Positive, Positive, Positive]  # kg/m, one number for all bars or three numbers


class Forces(NamedTuple):
    """Pin forces (..., 2) [N] on each pin's second body, and the torque (...) [N m] on the crank from the ground.

    A is from ground to crank, B from crank to coupler, C from coupler to rocker, D from ground to rocker.
    """

    A: Any
    B: Any
    C: Any
    D: Any
    torque: Any


@validated
def three_densities(density: Densities) -> tuple[float, float, float]:
    return density if isinstance(density, tuple) else (density, density, density)


def _cross(first: Any, second: Any) -> Any:
    return (np.conj(first) * second).imag


# The chapter's pseudocode, which integrates the printed rates, is a method under test and no reference. With the
# default tolerance of common packages (rtol 1e-3) the coupler's angle has an error of 0.02 rad after 1 and of 1 rad
# after 100 revolutions.

# The stages' nodes, as fractions of the step, for methods with a fixed step.
FIXED_STEP_NODES = {"euler": (0.0,), "rk4": (0.0, 0.5, 0.5, 1.0)}
Method = Literal["euler", "rk4", "RK45", "RK23", "DOP853", "Radau", "BDF", "LSODA"]  # the last six are scipy's


class RateIntegration(NamedTuple):
    """Angles [rad] at times t [s], the number of evaluations, and the reason if the method stopped, else ''.

    Angles are NaN after the method stopped.
    """

    t: Array
    theta: Array
    beta: Array
    phi: Array
    evaluations: int
    stopped: str


@validated
def integrate_rates(
    lengths: tuple[Positive, Positive, Positive],
    start: tuple[float, float, float],
    theta_dot: float,
    t: Annotated[Array, of_shape("times")],
    method: Method = "RK45",
    rtol: Positive = 1e-3,
    atol: Positive = 1e-6,
    every: Count = 10,
    limit: Count = 100_000,
) -> RateIntegration:
    """Integrate (theta, beta, phi) from `start` at t[0] with the rates (18.70), (18.71) and a constant theta'.

    lengths l1, l2, l3 [m]; theta_dot [rad/s]; t [s] increasing. "euler" and "rk4" take `every` steps between samples;
    scipy's RK45, RK23, DOP853, Radau, BDF and LSODA choose steps by rtol and atol, as solve_ivp does. The integration
    stops after `limit` evaluations, or if scipy's method fails. Steps tend to zero near sin(beta - phi) = 0, which
    drift reaches even for a crank that turns fully. Raises InvalidMechanism, a ValueError.
    """
    times = t
    if times.size < 2 or not np.all(np.diff(times) > 0):
        raise InvalidMechanism(
            f"rate integration: t is {short_repr(t)}; it must be a row of at least two increasing times"
        )
    l1, l2, l3 = lengths

    def odes(_: float, angles: Array) -> Array:
        theta, beta, phi = (float(value) for value in angles)
        closing = math.sin(beta - phi) or math.nan
        beta_dot = (l1 / l2) * math.sin(phi - theta) / closing * theta_dot
        phi_dot = (l1 / l3) * math.sin(beta - theta) / closing * theta_dot
        return np.array([theta_dot, beta_dot, phi_dot])

    out = np.full((times.size, 3), np.nan)
    out[0] = start
    if method in FIXED_STEP_NODES:
        evaluations, stopped = _fixed(odes, FIXED_STEP_NODES[method], times, out, every, limit)
    else:
        from scipy import integrate

        solver = getattr(integrate, method)(odes, times[0], out[0].copy(), times[-1], rtol=rtol, atol=atol)
        evaluations, stopped = _adaptive(solver, times, out, limit)
    return RateIntegration(times, out[:, 0], out[:, 1], out[:, 2], evaluations, stopped)


def _adaptive(solver: Any, times: Array, out: Array, limit: int) -> tuple[int, str]:
    done = 1
    while solver.status == "running":
        if solver.nfev >= limit:
            return solver.nfev, f"stopped at t = {solver.t:.6g} s after {solver.nfev} evaluations"
        with np.errstate(all="ignore"):
            message = solver.step()
        if solver.status == "failed":
            return solver.nfev, f"failed at t = {solver.t:.6g} s: {message}"
        reached = int(np.searchsorted(times, solver.t, side="right"))
        if reached > done:
            out[done:reached] = solver.dense_output()(times[done:reached]).T
            done = reached
    return solver.nfev, ""


def _fixed(
    odes: Callable[[float, Array], Array], nodes: tuple[float, ...], times: Array, out: Array, every: int, limit: int
) -> tuple[int, str]:
    evaluations, weights = 0, np.array([1.0] if len(nodes) == 1 else [1 / 6, 1 / 3, 1 / 3, 1 / 6])
    for index in range(1, times.size):
        angles, step = out[index - 1], (times[index] - times[index - 1]) / every
        for _ in range(every):
            if evaluations + len(nodes) > limit:
                return evaluations, f"stopped at t = {times[index - 1]:.6g} s after {evaluations} evaluations"
            slopes = [np.zeros(3)]
            for node in nodes:
                slopes.append(odes(0.0, angles + step * node * slopes[-1]))  # autonomous
            angles = angles + step * (weights @ np.array(slopes[1:]))
            evaluations += len(nodes)
        out[index] = angles
        if not np.all(np.isfinite(angles)):
            return evaluations, f"failed before t = {times[index]:.6g} s: the rates are not finite"
    return evaluations, ""


class Unreachable(InvalidMechanism):
    """A crank angle at which the loop can't close; the message states the angle and the possible range."""


@dataclass(frozen=True)
class FourBar(Valid):
    """A planar four-bar A B C D with lengths AB, BC, CD [m] and D at `ground` [m].

    Every method broadcasts its arguments. Angles are not wrapped and are continuous in theta within one reachable
    interval. The angles increase with the crank's turns if the crank is longer than AD. The chapter's start, theta =
    pi/2, has beta = pi/4 and phi = 3 pi/4. Both branches measure angles from the same direction D -> B.

    Errors are a few roundings in regular positions. At a distance x [rad] from the end of a reachable interval, angles
    have an error of about eps / sqrt(x), at most sqrt(eps) = 1e-8. Near the end rates grow like 1 / sqrt(x), with a
    relative error of eps / x. At the end rates are infinite or NaN. At a change point the crank does not determine C,
    and each `branch` has a kink. If crank = AD and coupler = rocker, B meets D, where C is not determined. This crank
    angle is Unreachable, and the angles of coupler and rocker jump by pi there.

    Raises InvalidMechanism for lengths that are not positive, D on A, or bars that can't be assembled at any crank
    angle. Methods raise Unreachable, and ValueError for a crank angle that is not finite or a wrong branch.
    """

    crank: Positive
    coupler: Positive
    rocker: Positive
    ground: tuple[float, float]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.ground_length == 0:
            raise InvalidMechanism(
                f"four-bar: ground is {self.ground!r}; it must be a point (x, y) other than A = (0, 0)"
            )
        lengths = sorted([self.crank, self.coupler, self.rocker, self.ground_length])
        if self._constants.outer_near < 0 or self._constants.inner_far < 0:
            raise InvalidMechanism(
                f"four-bar: crank {self.crank:.6g}, coupler {self.coupler:.6g}, rocker {self.rocker:.6g} and ground "
                f"{self.ground_length:.6g} can't be assembled at any crank angle; the longest must be at most the sum "
                f"of the others, {sum(lengths[:3]):.6g}"
            )

    @property
    def lengths(self) -> tuple[float, float, float]:
        """Crank, coupler and rocker [m]."""
        return self.crank, self.coupler, self.rocker

    @property
    def ground_length(self) -> float:
        return math.hypot(*self.ground)

    @cached_property
    def _constants(self) -> Constants:
        return Constants.of(*self.lengths, self.ground)

    @validated
    def angles(self, theta: ArrayLike, branch: Signs = 1) -> tuple[Any, Any]:
        """beta and phi [rad] in a closed form, although the chapter claims that none exists."""
        return self._evaluated(theta, 0.0, 0.0, branch, order=0)  # type: ignore[return-value]

    @validated
    def rates(self, theta: ArrayLike, theta_dot: ArrayLike, branch: Signs = 1) -> tuple[Any, Any]:
        """beta_dot (18.71) and phi_dot (18.70) [rad/s]."""
        return self._evaluated(theta, theta_dot, 0.0, branch, order=1)[2:]  # type: ignore[return-value]

    @validated
    def accelerations(
        self, theta: ArrayLike, theta_dot: ArrayLike, theta_ddot: ArrayLike = 0.0, branch: Signs = 1
    ) -> tuple[Any, Any]:
        """beta_ddot and phi_ddot [rad/s^2] from the time derivative of (18.69)."""
        return self.kinematics(theta, theta_dot, theta_ddot, branch)[4:]

    @validated
    def kinematics(
        self, theta: ArrayLike, theta_dot: ArrayLike, theta_ddot: ArrayLike = 0.0, branch: Signs = 1
    ) -> Kinematics:
        return Kinematics(*self._evaluated(theta, theta_dot, theta_ddot, branch, order=2))

    def _evaluated(
        self, theta: ArrayLike, theta_dot: ArrayLike, theta_ddot: ArrayLike, branch: ArrayLike, order: int
    ) -> tuple[Any, ...]:
        arguments = [np.asarray(value, dtype=float) for value in (theta, theta_dot, theta_ddot, branch)]
        try:
            angle, *others = np.broadcast_arrays(*arguments)
        except ValueError:
            shapes = ", ".join(str(value.shape) for value in arguments)
            raise InvalidMechanism(f"four-bar: arguments of the shapes {shapes} don't go together") from None
        try:
            columns = closed_form(self._constants, angle, *others, order=order)
        except OutOfReach as refusal:
            raise self._refusal(float(angle.flat[refusal.index]), refusal.undetermined) from None
        return tuple(column[()] for column in columns)

    def _refusal(self, theta: float, undetermined: bool) -> Unreachable:
        if undetermined:
            return Unreachable(f"four-bar: at crank angle {theta:.9g} rad B lies on D, and C is not determined")
        ranges = " or ".join(f"[{low:.9g}, {high:.9g}]" for low, high in self.crank_limits() or ())
        return Unreachable(
            f"four-bar: at crank angle {theta:.9g} rad the loop can't close; "
            f"possible is {ranges} rad, give or take whole turns"
        )

    def crank_limits(self) -> tuple[Interval, ...] | None:
        """The intervals (low, high) of theta [rad] in which the loop closes, up to whole turns, or None for all
        theta."""
        return self._constants.crank_limits()

    def grashof(self) -> str:
        """The Grashof class: crank-rocker, double-crank, double-rocker, triple-rocker or change-point."""
        return grashof(*self.lengths, self.ground_length)

    @validated
    def forces(
        self,
        theta: ArrayLike,
        theta_dot: ArrayLike,
        theta_ddot: ArrayLike = 0.0,
        branch: Signs = 1,
        density: Densities = 1.0,
        gravity: Vector = (0.0, -9.81),
    ) -> Forces:
        """Pin forces A, B, C, D (..., 2) [N] and the crank's torque (...) [N m] in this motion of uniform bars.

        density [kg/m], one number or three (crank, coupler, rocker); gravity [m/s^2]. A is the ground's force on the
        crank, B the crank's on the coupler, C the coupler's on the rocker, and D the ground's on the rocker. Forces are
        not finite at a crank limit.
        """
        motion = self.kinematics(theta, theta_dot, theta_ddot, branch)
        lengths, falling = self.lengths, complex(*gravity)
        angles, rates = (theta, motion.beta, motion.phi), (theta_dot, motion.beta_dot, motion.phi_dot)
        accelerations = (theta_ddot, motion.beta_ddot, motion.phi_ddot)
        masses = [rho * length for rho, length in zip(three_densities(density), lengths, strict=True)]
        # Vectors of the plane are complex numbers. `half` is the vector from a bar's first end to its centre, and
        # `moving` is the acceleration of the centre relative to that end.
        half = [length / 2 * np.exp(1j * np.asarray(angle)) for length, angle in zip(lengths, angles, strict=True)]
        moving = [
            arm * (1j * np.asarray(acceleration) - np.asarray(rate) ** 2)
            for arm, rate, acceleration in zip(half, rates, accelerations, strict=True)
        ]
        pull = [
            masses[0] * (moving[0] - falling),
            masses[1] * (2 * moving[0] + moving[1] - falling),
            masses[2] * (moving[2] - falling),
        ]  # m (a - g) of each bar is the sum of its pin forces
        spin = [
            mass * length**2 / 12 * np.asarray(acceleration)
            for mass, length, acceleration in zip(masses, lengths, accelerations, strict=True)
        ]
        # The balances of moments of the coupler about B and of the rocker about D determine the force at C.
        coupler, rocker = 2 * half[1], 2 * half[2]
        about_b = -(spin[1] + _cross(half[1], pull[1]))
        about_d = spin[2] + _cross(half[2], pull[2])
        at_c = (rocker * about_b - coupler * about_d) / _cross(coupler, rocker)
        at_b = pull[1] + at_c
        at_a = pull[0] + at_b
        at_d = pull[2] - at_c
        torque = spin[0] + _cross(half[0], pull[0]) + _cross(2 * half[0], at_b)
        return Forces(from_complex(at_a), from_complex(at_b), from_complex(at_c), from_complex(at_d), torque)

    @validated
    def integrate_rates(
        self, t: ArrayLike, theta_dot: float = 10.0, theta: float = math.pi / 2, branch: Sign = 1, **settings: Any
    ) -> RateIntegration:
        """The motion by the chapter's pseudocode, a method under test, with the settings of `integrate_rates`."""
        beta, phi = self.angles(theta, branch)
        return integrate_rates(self.lengths, (theta, float(beta), float(phi)), theta_dot, np.asarray(t), **settings)
