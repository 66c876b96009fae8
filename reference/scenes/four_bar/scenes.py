"""Four-bar scenes: a crank with a constant rate, a free linkage, and two scenes in which methods fail.

The two scenes are a parallelogram at its change points, and a crank that is driven to its limit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, Positive, Sign
from reference.joints import Drive, Joint, Pin, Vector, bodies_of
from reference.mechanism import Mechanism
from reference.numerics.gauss_collocation import COARSE_STAGES, STAGES
from reference.plane import placed
from reference.scene import Scene, shared
from reference.scenes.four_bar.free_motion import BarAngles, CurveMotion, States
from reference.scenes.four_bar.linkage import Densities, FourBar, Unreachable, three_densities
from reference.trajectory import Trajectory
from reference.validators import Array


@dataclass(frozen=True)
class FourBarScene(Scene):
    """Uniform bars as bodies "crank", "coupler", "rocker", pins "A", "B", "C", "D" between them in that order.

    Body frames have the x axis along the bar (A -> B, B -> C, D -> C) and the origin at the bar's middle. Body angles
    are theta, beta, phi, not wrapped. Lengths and ground [m], start [rad], rate [rad/s], density [kg/m] (one or three
    numbers), gravity [m/s^2]. Raises InvalidMechanism, and Unreachable for a start at which the loop can't close.
    """

    crank: Positive = 0.4
    coupler: Positive = 0.4 * math.sqrt(2)
    rocker: Positive = 0.8 * math.sqrt(2)
    ground: Vector = (1.2, 0.0)
    branch: Sign = 1
    start: float = math.pi / 2
    rate: float = 0.0
    density: Densities = 1.0
    gravity: Vector = (0.0, -9.81)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.four_bar.angles(self.start, self.branch)

    @property
    def four_bar(self) -> FourBar:
        return FourBar(self.crank, self.coupler, self.rocker, self.ground)

    @property
    def masses(self) -> tuple[float, float, float]:
        densities = three_densities(self.density)
        return densities[0] * self.crank, densities[1] * self.coupler, densities[2] * self.rocker

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        """The sign of sin(phi - beta) (...,), which is +1 if C is left of the directed line B -> D."""
        angle = pose[..., 2]
        return np.sign(np.sin(angle[..., 2] - angle[..., 1])).astype(int)

    def _mechanism(self, motion: BarAngles, *drives: Joint) -> Mechanism:
        pose, twist, _ = self._bodies(motion)
        names, lengths = ("crank", "coupler", "rocker"), self.four_bar.lengths
        masses = np.array(self.masses)
        bodies = bodies_of(names, masses, masses * np.array(lengths) ** 2 / 12, pose[0], twist[0])
        crank, coupler, rocker = (length / 2 for length in lengths)
        pins = (
            Pin("A", None, "crank", (0.0, 0.0), (-crank, 0.0)),
            Pin("B", "crank", "coupler", (crank, 0.0), (-coupler, 0.0)),
            Pin("C", "coupler", "rocker", (coupler, 0.0), (rocker, 0.0)),
            Pin("D", None, "rocker", self.ground, (-rocker, 0.0)),
        )
        return Mechanism(bodies, pins + drives, self.gravity)

    def _bodies(self, motion: BarAngles) -> tuple[Array, Array, Array]:
        bars = np.array(self.four_bar.lengths) * np.exp(1j * motion.angle)

        def centres(ends: Any, origin: complex = 0j) -> Any:
            return np.stack([ends[:, 0] / 2, ends[:, 0] + ends[:, 1] / 2, origin + ends[:, 2] / 2], axis=-1)

        return (
            placed(centres(bars, complex(*self.ground)), motion.angle),
            placed(centres(1j * motion.rate * bars), motion.rate),
            placed(centres((1j * motion.acceleration - motion.rate**2) * bars), motion.acceleration),
        )


@dataclass(frozen=True)
class DrivenFourBar(FourBarScene):
    """The chapter's sample, in which the crank turns at a constant rate for a number of `revolutions`.

    The linkage has no freedom, so errors of a stepping method don't grow, and the horizon is the duration. `motion`
    raises Unreachable if the crank can't turn that far.
    """

    name: ClassVar[str] = "driven_four_bar"
    source: ClassVar[str] = "sample 18.15, eqs. 18.67-18.71, fig. 18.66"

    rate: float = 10.0
    revolutions: Positive = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rate == 0:
            raise InvalidMechanism(f"scene {self.name!r}: rate is 0; a driven crank needs a rate other than zero")

    @property
    def duration(self) -> float:  # type: ignore[override]
        return self.revolutions * 2 * math.pi / abs(self.rate)

    @property
    def horizon(self) -> float:  # type: ignore[override]
        return self.duration

    def mechanism(self) -> Mechanism:
        drive = Drive("drive", None, "crank", self.rate, self.start)
        return self._mechanism(self._angles(np.zeros(1)), drive)

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, _ = self._bodies(self._angles(times))
        forces = self.four_bar.forces(
            self.start + self.rate * times, self.rate, 0.0, self.branch, self.density, self.gravity
        )
        return Trajectory(times, pose, twist, np.concatenate([*forces[:4], forces.torque[:, None]], axis=-1))

    def _angles(self, times: Array) -> BarAngles:
        theta = self.start + self.rate * times
        motion = self.four_bar.kinematics(theta, self.rate, 0.0, self.branch)
        return BarAngles(
            np.stack([theta, motion.beta, motion.phi], axis=-1),
            np.stack([np.full_like(theta, self.rate), motion.beta_dot, motion.phi_dot], axis=-1),
            np.stack([np.zeros_like(theta), motion.beta_ddot, motion.phi_ddot], axis=-1),
        )


@dataclass(frozen=True)
class FreeFourBar(FourBarScene):
    """The linkage moves under its weight from rest or with a crank rate. The crank may pass its limits.

    Errors are drifts of energy and time and grow about linearly, since one freedom has constant energy. The duration is
    therefore the horizon. Errors grow faster at a change point and with the energy of an unstable equilibrium.
    """

    name: ClassVar[str] = "free_four_bar"
    source: ClassVar[str] = "sample 18.15 with the drive removed; truth by eqs. 18.70-18.71 with Lagrange's equation"

    duration: Positive = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._curve.start(self.start, self.rate, self.branch)

    @property
    def horizon(self) -> float:  # type: ignore[override]
        return self.duration

    @property
    def _curve(self) -> CurveMotion:
        return CurveMotion(self.four_bar, self.masses, self.gravity)

    def mechanism(self) -> Mechanism:
        return self._mechanism(self._angles(np.zeros(1)))

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, acceleration = self._bodies(self._angles(times))
        return Trajectory(times, pose, twist, self.mechanism().reaction(pose, acceleration))

    def truth_error(self, t: ArrayLike) -> Array:
        """The error (times,) of the motion, estimated by the largest difference [m, rad, m/s, rad/s] of a pose or twist
        to another collocation rule. The estimate includes rounding to double."""
        times = self.times(t)
        pairs = zip(self._bodies(self._angles(times)), self._bodies(self._angles(times, COARSE_STAGES)), strict=True)
        return np.max([np.abs(fine - coarse).max(axis=(1, 2)) for fine, coarse in list(pairs)[:2]], axis=0)

    def _angles(self, times: Array, stages: int = STAGES) -> BarAngles:
        curve = self._curve
        start = curve.start(self.start, self.rate, self.branch)
        if not times.any():  # a mechanism needs only the start
            return curve.bar_angles(np.repeat(start[None], len(times), axis=0))
        try:
            states = shared(FreeFourBar._solved, self, max(self.duration, float(times.max())), stages)
            return curve.bar_angles(states(times))
        except ArithmeticError as failure:
            if self.four_bar.grashof() != "change-point":
                raise
            raise Unreachable(
                f"scene {self.name!r}: with these lengths all bars can lie in line, and the motion comes to that "
                f"change point, beyond which two motions are possible and none is the truth ({failure})"
            ) from None

    def _solved(self, until: float, stages: int) -> States:
        return self._curve.motion(self._curve.start(self.start, self.rate, self.branch), until, stages)


@dataclass(frozen=True)
class SpinningFourBar(FreeFourBar):
    """The free linkage with a crank rate at which the bars' inertia dominates gravity."""

    name: ClassVar[str] = "spinning_four_bar"

    rate: float = 10.0


# If the sine of the transmission angle is below this value, rows count as dependent, and reactions are not determined.
IN_LINE = 1e-6


@dataclass(frozen=True)
class Parallelogram(DrivenFourBar):
    """A parallelogram linkage, whose bars are in line twice a revolution.

    At these positions two motions are possible, with parallel and with crossed bars. The reference motion is smooth,
    with a coupler that is always parallel to the ground. The `branch` is not constant, since C passes from one side of
    B -> D to the other.
    """

    name: ClassVar[str] = "parallelogram"
    source: ClassVar[str] = "the singular set sin(beta - phi) = 0 of eqs. 18.70-18.71"

    crank: Positive = 0.4
    coupler: Positive = 1.2
    rocker: Positive = 0.4
    ground: Vector = (1.2, 0.0)
    revolutions: Positive = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.crank != self.rocker or not math.isclose(self.coupler, math.hypot(*self.ground), rel_tol=1e-15):
            raise InvalidMechanism(
                f"parallelogram: crank {self.crank!r} and rocker {self.rocker!r} must be equal, and so must coupler "
                f"{self.coupler!r} and ground {math.hypot(*self.ground)!r}"
            )

    def _motion(self, times: Array) -> Trajectory:
        """Reactions are NaN if the bars are in line, since rigid bodies do not determine them there."""
        angles = self._angles(times)
        pose, twist, acceleration = self._bodies(angles)
        reaction = np.full((len(times), 9), np.nan)
        regular = np.abs(np.sin(angles.angle[:, 2] - angles.angle[:, 1])) > IN_LINE
        reaction[regular] = self.mechanism().reaction(pose[regular], acceleration[regular])
        return Trajectory(times, pose, twist, reaction)

    def _angles(self, times: Array) -> BarAngles:
        theta = self.start + self.rate * times
        zero = np.zeros_like(theta)
        heading = np.full_like(theta, math.atan2(self.ground[1], self.ground[0]))
        rate = np.full_like(theta, self.rate)
        return BarAngles(
            np.stack([theta, heading, theta], axis=-1), np.stack([rate, zero, rate], axis=-1), np.zeros((len(theta), 3))
        )


@dataclass(frozen=True)
class OverdrivenFourBar(DrivenFourBar):
    """A triple-rocker whose crank is driven beyond its limit. For times after the limit `motion` raises Unreachable."""

    name: ClassVar[str] = "overdriven_four_bar"
    source: ClassVar[str] = "the singular set sin(beta - phi) = 0 of eqs. 18.70-18.71"

    crank: Positive = 0.8
    coupler: Positive = 0.5
    rocker: Positive = 0.5
    start: float = 0.0
    rate: float = 4.0
    revolutions: Positive = 0.5

    def _motion(self, times: Array) -> Trajectory:
        """Times after the stopping time raise Unreachable, also for crank angles that the loop could reach again."""
        motion = super()._motion(times)
        late = times[times > self.stopping_time * (1 + 1e-12)]
        if late.size:
            raise Unreachable(
                f"scene {self.name!r}: at {float(late[0])!r} s the crank has met its limit, at "
                f"{self.stopping_time:.9g} s, and can't go on; earlier times are possible"
            )
        return motion

    @property
    def stopping_time(self) -> float:
        """The time [s] at which the crank meets its limit, or infinity if it never meets its limit."""
        limits = self.four_bar.crank_limits()
        if limits is None:
            return math.inf
        turn = 2 * math.pi
        ends = [bound for interval in limits for bound in interval]
        return min(math.copysign(1, self.rate) * (end - self.start) % turn for end in ends) / abs(self.rate)
