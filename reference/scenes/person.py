"""A person on one foot or two feet, whose trunk, thighs and shanks are five links that fall without muscle torques.

`reference/scenes/derivations.md` has coordinates, modes and the sources of the segments. The ankles are pins in the
ground, at y = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Fraction, InvalidMechanism, Positive, Sign, Valid, cached_readonly, validated
from reference.embedding import EmbeddedScene
from reference.joints import Joint, Pin, bodies_of
from reference.mechanism import Mechanism
from reference.validators import Array

SEGMENT_NAMES = ("left shank", "left thigh", "trunk", "right thigh", "right shank")
UPRIGHT = (math.pi / 2, math.pi / 2, math.pi / 2, -math.pi / 2, -math.pi / 2)


@dataclass(frozen=True)
class Segment(Valid):
    """A body segment, with its mass as a fraction of the person's mass and its length as a fraction of the height.

    `centre` is the distance of the centre of mass from the upper joint, or from the hip for the trunk. `gyration` is
    the radius of gyration about the centre of mass. Both lengths are fractions of the segment's length.
    """

    mass: Fraction
    length: Fraction
    centre: Fraction
    gyration: Fraction


# Winter, table 4.1 (mass, centre from the proximal end, radius of gyration about the centre) and figure 4.1 (length).
HEAD_ARMS_TRUNK = Segment(0.678, 0.288, 0.626, 0.496)
THIGH = Segment(0.100, 0.245, 0.433, 0.323)
SHANK = Segment(0.0465, 0.246, 0.433, 0.302)
SHANK_AND_FOOT = Segment(0.061, 0.246, 0.606, 0.416)


@dataclass(frozen=True)
class OneFoot(EmbeddedScene):
    """A person who stands on the left foot, with `mass` [kg], `height` [m] and gravity [m/s^2].

    The motion starts from rest. Angles [rad] are counter-clockwise. `left_shank`, `left_thigh` and `trunk` are from the
    upward vertical, `right_thigh` and `right_shank` (lifted leg) from the downward vertical.
    """

    name: ClassVar[str] = "person_one_foot"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a model of the human body, one foot on the ground"
    max_durations: ClassVar[float] = 1.0  # later contacts with the ground are not modelled
    mass: Positive = 75.0
    height: Positive = 1.75
    gravity: float = 9.81
    left_shank: float = -0.02
    left_thigh: float = 0.05
    trunk: float = 0.0
    right_thigh: float = 1.2
    right_shank: float = -0.6
    duration: Positive = 0.25  # the lifted foot touches the ground
    horizon: Positive = 0.25

    @property
    def segments(self) -> tuple[Segment, ...]:
        """The segments in the order of the bodies; the lifted foot is part of its shank."""
        return (SHANK, THIGH, HEAD_ARMS_TRUNK, THIGH, SHANK_AND_FOOT)

    @property
    def feet(self) -> float | None:
        """Distance between the ankles on the ground [m], or None for one foot."""
        return None

    @property
    def start(self) -> Array:
        """The bodies' angles and then zeros as rates; x axes are directed away from the left ankle."""
        aside = [self.left_shank, self.left_thigh, self.trunk, self.right_thigh, self.right_shank]
        return np.concatenate([np.array(aside) + UPRIGHT, np.zeros(5)])

    @cached_readonly
    def lengths(self) -> Array:
        """(5,) [m]."""
        return np.array([segment.length * self.height for segment in self.segments])

    @cached_readonly
    def _behind(self) -> Array:
        """Position [m] (5,) of each centre of mass on the body's x axis, from the joint nearer to the left ankle."""
        centres = np.array([segment.centre for segment in self.segments])
        centres[:2] = 1 - centres[:2]  # in the left leg the lower joint is nearer to the left ankle
        return centres * self.lengths

    @cached_readonly
    def masses(self) -> Array:
        """(5,) [kg]."""
        return np.array([segment.mass * self.mass for segment in self.segments])

    @cached_readonly
    def inertias(self) -> Array:
        """Inertias (5,) about the centres of mass [kg m^2]."""
        gyration = np.array([segment.gyration for segment in self.segments]) * self.lengths
        return self.masses * gyration**2

    def angle_rates(self, coordinates: Any) -> tuple[Any, Any]:
        """The bodies' angles (..., 5), and the matrix (..., 5, freedoms) of their rates."""
        identity = np.eye(5)
        return coordinates, np.broadcast_to(identity, (*coordinates.shape[:-1], 5, 5))

    def tangent(self, coordinates: Any) -> tuple[Any, Any]:
        """Poses (..., 5, 3), and velocities T (..., 15, freedoms) for a unit rate of each coordinate."""
        angle, turning = self.angle_rates(coordinates)
        cosine, sine = np.cos(angle), np.sin(angle)
        # along[i, j] is the length of segment j in the path from the left ankle to the centre of mass of body i.
        along = np.zeros((5, 5))
        along[1, 0] = along[2, 0] = along[3, 0] = along[4, 0] = self.lengths[0]
        along[2, 1] = along[3, 1] = along[4, 1] = self.lengths[1]
        along[4, 3] = self.lengths[3]
        along[np.arange(5), np.arange(5)] = self._behind
        pose = np.stack([cosine @ along.T, sine @ along.T, angle], axis=-1)
        across = np.stack(
            [
                -(along * sine[..., None, :]) @ turning,
                (along * cosine[..., None, :]) @ turning,
                turning + 0 * cosine[..., :1, None],
            ],
            axis=-2,
        )
        return pose, across.reshape((*across.shape[:-3], 15, across.shape[-1]))

    def mechanism(self) -> Mechanism:
        pose, _ = self.tangent(self.start[: self.freedoms])
        bodies = bodies_of(SEGMENT_NAMES, self.masses, self.inertias, pose, np.zeros((5, 3)))
        behind, ahead = -self._behind, self.lengths - self._behind
        joints: list[Joint] = [
            Pin("left ankle", None, SEGMENT_NAMES[0], (0.0, 0.0), (behind[0], 0.0)),
            Pin("left knee", SEGMENT_NAMES[0], SEGMENT_NAMES[1], (ahead[0], 0.0), (behind[1], 0.0)),
            Pin("hip of trunk", SEGMENT_NAMES[1], SEGMENT_NAMES[2], (ahead[1], 0.0), (behind[2], 0.0)),
            Pin("right hip", SEGMENT_NAMES[1], SEGMENT_NAMES[3], (ahead[1], 0.0), (behind[3], 0.0)),
            Pin("right knee", SEGMENT_NAMES[3], SEGMENT_NAMES[4], (ahead[3], 0.0), (behind[4], 0.0)),
        ]
        if self.feet is not None:
            joints.append(Pin("right ankle", None, SEGMENT_NAMES[4], (self.feet, 0.0), (ahead[4], 0.0)))
        return Mechanism(bodies, tuple(joints), (0.0, -self.gravity))


@dataclass(frozen=True)
class TwoFeet(OneFoot):
    """A person on both feet, with `stance` [m] between the ankles. The loop through the ground has three freedoms.

    The hip's position (`hip_x`, `hip_y`) [m] from the left ankle and the trunk's angle define the start. Both knees
    bend to the left (`knees` = +1) or to the right (-1). Raises InvalidMechanism if the hip is out of reach.
    """

    name: ClassVar[str] = "person_two_feet"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a person with two feet on the ground"
    stance: float = 0.5
    hip_x: float = 0.24
    hip_y: float = 0.8
    knees: Sign = 1
    trunk: float = -0.1
    duration: Positive = 0.3  # a knee touches the ground
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
    def start(self) -> Array:
        """Hip x and y [m] and the trunk's angle [rad], and then zeros as rates."""
        return np.array([self.hip_x, self.hip_y, self.trunk + math.pi / 2, 0.0, 0.0, 0.0])

    def angle_rates(self, coordinates: Any) -> tuple[Any, Any]:
        """The rates w1, w2 of a leg solve l1 n1 w1 + l2 n2 w2 = v_hip, with the segments' lengths l and normals n."""
        x, y, trunk = (coordinates[..., i] for i in range(3))
        lower, upper = self._leg(x, y)
        far_lower, far_upper = self._leg(x - self.stance, y)
        # The x axes of the right leg's bodies are directed away from the hip.
        angle = np.stack([lower, upper, trunk, far_upper - math.pi, far_lower - math.pi], axis=-1)
        turning = np.zeros((*angle.shape, 3), dtype=angle.dtype)
        turning[..., 2, 2] = 1
        shank, thigh = self.lengths[0], self.lengths[1]
        for first, second, a, b in ((0, 1, lower, upper), (4, 3, far_lower, far_upper)):
            between = np.sin(b - a)  # zero for straight knees
            turning[..., first, 0] = np.cos(b) / (shank * between)
            turning[..., first, 1] = np.sin(b) / (shank * between)
            turning[..., second, 0] = -np.cos(a) / (thigh * between)
            turning[..., second, 1] = -np.sin(a) / (thigh * between)
        return angle, turning

    def _leg(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Angles of shank (ankle to knee) and thigh (knee to hip) for a hip at (x, y) from the ankle."""
        shank, thigh = self.lengths[0], self.lengths[1]
        # sqrt is used instead of hypot, since the function must be analytic. The angle of (x, y) is measured from the
        # vertical, so that it is continuous for a hip above the ground.
        square = x * x + y * y
        reach = np.sqrt(square)
        bearing = math.pi / 2 - np.arctan(x / y)
        ankle = np.arccos((square + shank**2 - thigh**2) / (2 * shank * reach))
        hip = np.arccos((square + thigh**2 - shank**2) / (2 * thigh * reach))
        return bearing + self.knees * ankle, bearing - self.knees * hip

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        """+1 if both knees bend to the left of their legs, -1 if both bend to the right, 0 otherwise."""
        left_knee = np.sign(np.sin(pose[..., 0, 2] - pose[..., 1, 2]))
        right_knee = np.sign(np.sin(pose[..., 4, 2] - pose[..., 3, 2]))
        return np.where(left_knee == right_knee, left_knee, 0).astype(int)


@dataclass(frozen=True)
class SwayingOnOneFoot(OneFoot):
    """A person upright on one foot, with the lifted leg rotated by 0.1 rad, in the shape of the mode of 9.3 rad/s.

    The horizon is the time in which the unstable mode of the knee increases a difference tenfold.
    """

    name: ClassVar[str] = "person_swaying"
    left_shank: float = -0.00200745
    left_thigh: float = -0.00285913
    trunk: float = 0.00332792
    right_thigh: float = -0.0676988
    right_shank: float = 0.1
    duration: Positive = 0.3
    horizon: Positive = 0.1


@validated
def modes_upright(person: OneFoot) -> tuple[Array, Array]:
    """Eigenvalues s [1/s^2] (5,), ascending, and shapes (5, 5) in columns of small motions u'' = s u about upright.

    For s < 0 a mode swings at sqrt(-s) rad/s; for s > 0 a mode grows like e^(sqrt(s) t). The linear equations are
    finite differences of the equations of motion.
    """
    from scipy.linalg import eig

    upright, rest = np.array(UPRIGHT), np.zeros(5)

    def slope(step: float) -> Array:
        columns = [
            person.accelerations(upright + step * move, rest) - person.accelerations(upright - step * move, rest)
            for move in np.eye(5)
        ]
        return np.array(columns).T / (2 * step)

    # Central differences have errors of even powers only, so Richardson extrapolation is used. The steps balance
    # rounding and truncation.
    solution: Any = eig((4 * slope(1e-4) - slope(2e-4)) / 3)
    values, vectors = solution
    order = np.argsort(values.real)
    return values.real[order], vectors.real[:, order]
