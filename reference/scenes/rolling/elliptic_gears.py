"""The closed form of two congruent elliptic gears that are pinned at foci and roll on each other."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import Positive, validated
from reference.joints import Drive, Pin, bodies_of
from reference.mechanism import Mechanism
from reference.plane import swung
from reference.reactions import undetermined
from reference.rolling.closed_curves import Ellipse
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scene import PlacedScene
from reference.trajectory import Trajectory
from reference.validators import Array, from_to


@dataclass(frozen=True)
class EllipticGears(PlacedScene):
    """The first gear turns at a constant rate about a focus at the origin, the second gear about a focus at (2a, 0).

    The distances from the contact to the two pins add up to 2a, so the contact is on the line of the pins. The angles
    satisfy tan(theta_2 / 2) = -(1 + e) / (1 - e) tan(theta_1 / 2). The ratio of the rates varies between (1 + e) / (1 -
    e) and its inverse. Gears are uniform discs, described at their centres.

    The motion does not determine the forces along the line of the pins, since the pins also fix the distance of the
    gears. Reactions along the line of the pins are NaN.
    """

    name: ClassVar[str] = "elliptic_gears"
    source: ClassVar[str] = "rolling of not round objects, (18.66), between two moving bodies"

    major: Positive = 0.3  # m, semi-axis a
    eccentricity: Annotated[float, from_to(0, 0.99)] = 0.5
    turning_rate: float = 3.0  # rad/s, first gear.
    start_angle: float = 0.4  # rad, first gear.
    mass: Positive = 1.0  # kg, each.
    duration: Positive = 2.0  # s.
    horizon: Positive = 2.0  # s.

    @property
    def samples(self) -> int:
        """A fifth of the usual number, since contacts of ellipses cost ten times as much as those of circles."""
        return max(1, super().samples // 5)

    @property
    def _minor(self) -> float:
        return self.major * math.sqrt(1 - self.eccentricity**2)

    @property
    def _focus(self) -> tuple[float, float]:
        return (-self.major * self.eccentricity, 0.0)

    @validated
    def second_angle(self, first: ArrayLike) -> Array:
        """theta_2 (...) [rad] at theta_1 (...) [rad], both unwrapped."""
        half = np.asarray(first, dtype=float) / 2
        ratio = (1 + self.eccentricity) / (1 - self.eccentricity)
        sine, cosine = np.sin(half), np.cos(half)
        return -2 * (half + np.arctan2((ratio - 1) * sine * cosine, cosine**2 + ratio * sine**2))

    @validated
    def second_rate(self, first: ArrayLike) -> tuple[Array, Array]:
        """theta_2' and theta_2'' (...) [rad/s, rad/s^2] from the distances of the contact to the pins."""
        first = np.asarray(first, dtype=float)
        e, semi_latus_rectum = self.eccentricity, self.major * (1 - self.eccentricity**2)
        near = semi_latus_rectum / (1 - e * np.cos(first))
        far = 2 * self.major - near
        receding = -(near**2) * e * np.sin(first) / semi_latus_rectum * self.turning_rate
        return -self.turning_rate * near / far, -self.turning_rate * 2 * self.major / far**2 * receding

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        first = self.start_angle + self.turning_rate * times
        rate, angular_acceleration = self.second_rate(first)
        angle = np.stack([first, self.second_angle(first)], axis=-1)
        rates = np.stack([np.full(times.shape, self.turning_rate), rate], axis=-1)
        accelerations = np.stack([np.zeros(times.shape), angular_acceleration], axis=-1)
        arm = -self._focus[0] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        pose, twist, acceleration = swung(arm, angle, rates, accelerations)
        pose[:, 1, 0] += 2 * self.major  # the second pin
        return pose, twist, acceleration

    def mechanism(self) -> Mechanism:
        shape = Ellipse(self.major, self._minor)
        pose, twist, _ = self.placement(np.zeros(1))
        inertia = self.mass * (self.major**2 + self._minor**2) / 4
        bodies = bodies_of(("first", "second"), (self.mass,) * 2, (inertia,) * 2, pose[0], twist[0])
        # At theta_1 = theta_2 = 0 the far end of the first ellipse touches the near end of the second ellipse.
        rolling = Rolling(shape, shape, 0.0, 0.0, shape.length / 2)
        return Mechanism(
            bodies,
            (
                Pin("first pin", None, "first", (0.0, 0.0), self._focus),
                Pin("second pin", None, "second", (2 * self.major, 0.0), self._focus),
                Drive("motor", None, "first", self.turning_rate, self.start_angle),
                Roll("mesh", "first", "second", rolling),
            ),
        )

    def _motion(self, times: Array) -> Trajectory:
        motion, mechanism = super()._motion(times), self._mechanism
        loose = undetermined(mechanism.rows(motion.pose), mechanism.length_scale)
        return replace(motion, reaction=np.where(loose, np.nan, motion.reaction))
