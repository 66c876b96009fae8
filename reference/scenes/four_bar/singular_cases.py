"""Four-bars where methods fail: a parallelogram through its change points, and a crank driven into its limit."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.checks import InvalidMechanism, Positive
from reference.joints import Vector
from reference.scenes.four_bar.free_motion import BarAngles
from reference.scenes.four_bar.linkage import Unreachable
from reference.scenes.four_bar.scenes import Array, DrivenFourBar
from reference.trajectory import Trajectory

# Within this of a change point (the sine of the transmission angle) the rows are as good as dependent, and the
# reactions of ideal rigid bars are not determined.
IN_LINE = 1e-6


@dataclass(frozen=True)
class Parallelogram(DrivenFourBar):
    """Crank and rocker equal, coupler and ground equal: twice a revolution all bars lie in line.

    There two motions satisfy the joints, parallel bars and crossed ones. The truth is the one that is smooth: the
    coupler stays parallel to the ground. `branch` can't express it, as C passes from one side of B -> D to the other.
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
        """Reactions are NaN where the bars are in line: rigid bars then share them in no definite way."""
        angles = self._angles(times)
        pose, twist, acceleration = self._bodies(angles)
        reaction = np.full((len(times), 9), np.nan)
        apart = np.abs(np.sin(angles.angle[:, 2] - angles.angle[:, 1])) > IN_LINE
        reaction[apart] = self.mechanism().reaction(pose[apart], acceleration[apart])
        return Trajectory(times, pose, twist, reaction)

    def _angles(self, times: Array) -> BarAngles:
        theta = self.start + self.rate * times
        still = np.zeros_like(theta)
        heading = np.full_like(theta, math.atan2(self.ground[1], self.ground[0]))
        rate = np.full_like(theta, self.rate)
        return BarAngles(
            np.stack([theta, heading, theta], axis=-1),
            np.stack([rate, still, rate], axis=-1),
            np.zeros((len(theta), 3)),
        )


@dataclass(frozen=True)
class OverdrivenFourBar(DrivenFourBar):
    """A triple-rocker whose crank is driven beyond what the other bars can follow: `motion` refuses from there."""

    name: ClassVar[str] = "overdriven_four_bar"
    source: ClassVar[str] = "the singular set sin(beta - phi) = 0 of eqs. 18.70-18.71"

    crank: Positive = 0.8
    coupler: Positive = 0.5
    rocker: Positive = 0.5
    start: float = 0.0
    rate: float = 4.0
    revolutions: Positive = 0.5

    def _motion(self, times: Array) -> Trajectory:
        """Raises Unreachable beyond the stopping time, also where the crank's angle alone could be reached again."""
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
        """When the crank meets its limit [s]; infinite if it never does."""
        limits = self.four_bar.crank_limits()
        if limits is None:
            return math.inf
        turn = 2 * math.pi
        ends = [bound for interval in limits for bound in interval]
        return min(math.copysign(1, self.rate) * (end - self.start) % turn for end in ends) / abs(self.rate)
