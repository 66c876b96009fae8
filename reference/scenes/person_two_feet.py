"""A person on two feet: a loop through the ground with three freedoms, the hip and the trunk's angle.

Each leg follows from the hip by the intersection of two circles, about its ankle and about the hip; the embedding is
that of `reference.scenes.person`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism, Positive, Sign
from reference.kinds import Floats
from reference.scenes.person import OneFoot
from reference.scenes.person_segments import HEAD_ARMS_TRUNK, SHANK, THIGH, Segment

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwoFeet(OneFoot):
    """Standing on both feet, `stance` [m] between the ankles: a loop through the ground, with three freedoms.

    The start is given by the hip, at `hip_x` [m] from the left ankle and `hip_y` above it, and the trunk's angle; both
    knees bend to the left (`knees` = +1) or to the right (-1). Raises InvalidMechanism when a leg can't reach.
    """

    name: ClassVar[str] = "person_two_feet"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a person with two feet on the ground"
    stance: float = 0.5
    hip_x: float = 0.24
    hip_y: float = 0.8
    knees: Sign = 1
    trunk: float = -0.1
    duration: Positive = 0.3  # then a knee meets the ground
    horizon: Positive = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        owner = f"scene {self.name!r}"
        shank, thigh = (segment.length * self.height for segment in (SHANK, THIGH))
        farthest = 2 * (shank + thigh)
        if abs(self.stance) >= farthest:
            raise InvalidMechanism(
                f"{owner}: stance is {self.stance!r} m; legs of {farthest / 2:.4g} m stand only on feet nearer than "
                f"{farthest:.4g} m"
            )
        for side, ankle in (("left", 0.0), ("right", self.stance)):
            reach = math.hypot(self.hip_x - ankle, self.hip_y)
            if not abs(shank - thigh) < reach < shank + thigh:
                raise InvalidMechanism(
                    f"{owner}: hip_x, hip_y = {self.hip_x!r}, {self.hip_y!r} is {reach:.4g} m from the {side} ankle; "
                    f"the leg reaches from {abs(shank - thigh):.4g} to {shank + thigh:.4g} m"
                )

    @property
    def segments(self) -> tuple[Segment, ...]:
        return (SHANK, THIGH, HEAD_ARMS_TRUNK, THIGH, SHANK)

    @property
    def feet(self) -> float | None:
        return self.stance

    @property
    def start(self) -> tuple[float, ...]:
        """The coordinates u: hip x and y [m], and the trunk's angle [rad]."""
        return (self.hip_x, self.hip_y, self.trunk + math.pi / 2)

    def angle_rates(self, coordinates: Any) -> tuple[Any, Any]:
        """Each leg is two circles, about its ankle and about the hip; its rates solve l1 n1 w1 + l2 n2 w2 = v_hip."""
        x, y, trunk = (coordinates[..., i] for i in range(3))
        lower, upper = self._leg(x, y)
        far_lower, far_upper = self._leg(x - self.stance, y)
        # The right leg is walked downwards: its bodies' x axes point from the hip away, against the leg's.
        angle = np.stack([lower, upper, trunk, far_upper - math.pi, far_lower - math.pi], axis=-1)
        turning = np.zeros((*angle.shape, 3), dtype=angle.dtype)
        turning[..., 2, 2] = 1
        shank, thigh = self.lengths[0], self.lengths[1]
        for first, second, a, b in ((0, 1, lower, upper), (4, 3, far_lower, far_upper)):
            between = np.sin(b - a)  # zero when the knee is straight: then the hip can't be a coordinate
            turning[..., first, 0] = np.cos(b) / (shank * between)
            turning[..., first, 1] = np.sin(b) / (shank * between)
            turning[..., second, 0] = -np.cos(a) / (thigh * between)
            turning[..., second, 1] = -np.sin(a) / (thigh * between)
        return angle, turning

    def _leg(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Angles of ankle-knee and knee-hip for a hip at (x, y) from the ankle, the knee to the left of it (+1)."""
        shank, thigh = self.lengths[0], self.lengths[1]
        # sqrt, not hypot: a complex step passes through it. The angle of (x, y) is measured from the vertical, where
        # a hip above the ground has no jump.
        square = x * x + y * y
        reach = np.sqrt(square)
        bearing = math.pi / 2 - np.arctan(x / y)
        ankle = np.arccos((square + shank**2 - thigh**2) / (2 * shank * reach))
        hip = np.arccos((square + thigh**2 - shank**2) / (2 * thigh * reach))
        return bearing + self.knees * ankle, bearing - self.knees * hip

    def _branch_of(self, pose: Floats) -> NDArray[np.int_]:
        """+1 where both knees bend to the left of their legs, -1 where both bend to the right, 0 otherwise."""
        left = np.sign(np.sin(pose[..., 0, 2] - pose[..., 1, 2]))
        right = np.sign(np.sin(pose[..., 4, 2] - pose[..., 3, 2]))
        return np.where(left == right, left, 0).astype(int)
