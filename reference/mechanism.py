"""Planar mechanisms: rigid bodies, and joints written as velocity rows J(q) v = rate.

Maximal coordinates: every body has a pose (x, y, angle) of its centre of mass and a twist (vx, vy, omega), and the
mechanism's vectors q and v stack them in the order of `Mechanism.bodies`.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import (
    AnyComplexes,
    InvalidMechanism,
    Name,
    Numbers,
    Valid,
    cached_readonly,
    require_room,
    validated,
)
from reference.forces import ForceElement
from reference.joints import Body, Joint, Vector
from reference.plane import COMPLEX_STEP
from reference.reactions import MANY_ROWS, banded_reaction, rank, reactions
from reference.rows import AppliedForces, JointRows
from reference.scales import length_scale, time_scale
from reference.validators import Array, of_shape

States = Annotated[AnyComplexes, of_shape("...", "bodies", 3)]
Reals = Annotated[Numbers, of_shape("...", "bodies", 3)]

# Maximum number of bytes of dense rows for which the rank is computed. The rank takes a minute at this size, and eight
# minutes with twice as many bodies.
LARGEST_RANK = 2**28


@dataclass(frozen=True)
class Mechanism(Valid):
    """Bodies, the joints between them, force elements, and gravity [m/s^2].

    Raises InvalidMechanism for a repeated or unknown name, a joint of a body with itself, or a start that does not
    satisfy the joints, whose error would be attributed to the engine.
    """

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Vector = (0.0, 0.0)
    forces: tuple[ForceElement, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.bodies:
            raise InvalidMechanism("mechanism: it has no bodies; give at least one")
        for kind, members in (("bodies", self.bodies), ("joints", self.joints), ("forces", self.forces)):
            for name, count in Counter(member.name for member in members).items():
                if count > 1:
                    raise InvalidMechanism(f"mechanism: two {kind} are called {name!r}; names must differ")
        for kind, members in (("joint", self.joints), ("force", self.forces)):
            for member in members:
                for first, second in member.pairs:
                    for name in (first, second):
                        if name is not None and name not in self._index:
                            raise self._unknown(f"{kind} {member.name!r}", name)
                    if first == second:
                        raise InvalidMechanism(
                            f"{kind} {member.name!r}: it joins {first!r} with itself; name two bodies"
                        )
        self._refuse_a_bad_start()

    def _refuse_a_bad_start(self) -> None:
        refuse_a_bad_start(self)

    @cached_property
    def _index(self) -> dict[str | None, int]:
        return {**{body.name: index for index, body in enumerate(self.bodies)}, None: len(self.bodies)}

    @cached_readonly
    def joint_rows(self) -> JointRows:
        """The rows of all joints, without checks of arguments, for use at every step."""
        return JointRows.of(self.joints, self._index)

    @validated
    def body_index(self, name: Name) -> int:
        """The index of a body in q, v and every trajectory of this mechanism."""
        if name not in self._index:
            raise self._unknown("mechanism", name)
        return self._index[name]

    def _unknown(self, owner: str, name: str) -> InvalidMechanism:
        names = ", ".join(repr(body.name) for body in self.bodies)
        return InvalidMechanism(f"{owner}: no body is called {name!r}; there are {names}")

    @cached_property
    def row_names(self) -> tuple[str, ...]:
        """The name of each row, 'B x' for the x row of joint B, in the order of reactions."""
        return tuple(f"{joint.name} {label}" for joint in self.joints for label in joint.labels)

    @cached_readonly
    def is_angular(self) -> NDArray[np.bool_]:
        """Mask (rows,) of the rows that are rotations [rad, rad/s, N m] and not lengths [m, m/s, N]."""
        return np.array([is_angular for joint in self.joints for is_angular in joint.is_angular], dtype=bool)

    @cached_property
    def row_count(self) -> int:
        return sum(joint.size for joint in self.joints)

    @cached_readonly
    def pose(self) -> Array:
        """Poses at t = 0 (bodies, 3) [m, m, rad]."""
        return np.array([body.pose for body in self.bodies], dtype=float)

    @cached_readonly
    def twist(self) -> Array:
        """Twists at t = 0 (bodies, 3) [m/s, m/s, rad/s]."""
        return np.array([body.twist for body in self.bodies], dtype=float)

    @cached_readonly
    def inertias(self) -> Array:
        """The diagonal of the mass matrix (bodies, 3) [kg, kg, kg m^2]."""
        return np.array([(body.mass, body.mass, body.inertia) for body in self.bodies], dtype=float)

    @cached_readonly
    def free_fall(self) -> Array:
        """Accelerations by gravity alone (bodies, 3) [m/s^2, m/s^2, rad/s^2]."""
        return np.array([(*self.gravity, 0.0)] * len(self.bodies), dtype=float)

    @cached_readonly
    def applied(self) -> AppliedForces:
        """The force elements, without checks of arguments, for use at every step."""
        return AppliedForces.of(self.forces, self._index)

    def unconstrained(self, pose: Array, twist: Array) -> Array:
        """Accelerations (..., bodies, 3) by gravity and forces, without joints and without checks of arguments."""
        return self.free_fall + self.applied.on(pose, twist) / self.inertias if self.forces else self.free_fall

    @validated
    def potential(self, pose: States) -> NDArray[Any]:
        """Potential energy (...) [J] of gravity, springs, constant forces and torques at poses (..., bodies, 3).

        The zero is at the world's origin for bodies, at the rest length for springs, and at equal angles for torques.
        """
        of_gravity = -np.sum(self.inertias * self.free_fall * pose, axis=(-2, -1))
        return of_gravity + self.applied.potential(pose) if self.forces else of_gravity

    @cached_readonly
    def rate(self) -> Array:
        """The right-hand side of J v = rate (rows,), which is zero except for drives."""
        return np.array([value for joint in self.joints for value in joint.rate], dtype=float)

    @cached_readonly
    def holonomic(self) -> NDArray[np.bool_]:
        """Mask (rows,) of the rows that are derivatives of a position."""
        return np.array([joint.holonomic for joint in self.joints for _ in range(joint.size)], dtype=bool)

    def require_room(self, samples: int) -> None:
        """Raise InvalidMechanism if a trajectory with this number of samples takes more than checks.LARGEST_ARRAY."""
        require_room("mechanism: a trajectory", (samples + 1, len(self.bodies), 3))

    @validated
    def gap(self, pose: States, t: ArrayLike) -> NDArray[Any]:
        """The position violation of every row (..., rows) [m or rad], or NaN if the row constrains velocity only.

        pose (..., bodies, 3) and times t (...) [s].
        """
        return self.joint_rows.gap(pose, np.asarray(t))

    @validated
    def rows(self, pose: States) -> NDArray[Any]:
        """The velocity rows J (..., rows, 3 bodies) at poses (..., bodies, 3), as a dense array; analytic in the poses.

        Raises InvalidMechanism if the array takes more than checks.LARGEST_ARRAY.
        """
        return self.joint_rows.dense(pose)

    @validated
    def slip(self, pose: States, twist: States) -> NDArray[Any]:
        """The velocity violation J v - rate of every row (..., rows) [m/s or rad/s]."""
        return self.joint_rows.velocities(pose, twist) - self.rate

    @validated
    def bias(self, pose: Reals, twist: Reals) -> Array:
        """-(dJ/dt) v (..., rows): the right-hand side of J a = bias, exact by a complex step along the motion."""
        return -np.imag(self.joint_rows.velocities(pose + 1j * COMPLEX_STEP * twist, twist)) / COMPLEX_STEP

    @validated
    def reaction(
        self,
        pose: Reals,
        acceleration: Reals,
        inertias: Annotated[Numbers, of_shape("bodies", 3)] | None = None,
        gravity: Annotated[Numbers, of_shape(2)] | None = None,
        twist: Reals | None = None,
    ) -> Array:
        """The joints' reactions (..., rows) [N, N m] from M a = f + J^T reaction with forces f without joints.

        pose, acceleration and twist are (..., bodies, 3); only dampers need the twist. By Newton's law an engine with
        this motion has applied these reactions. inertias (bodies, 3) [kg, kg, kg m^2] and gravity (2,) [m/s^2] are the
        mechanism's by default. With the engine's inertias a wrong mass in the engine changes the reactions even if the
        motion is prescribed. An unknown inertia is NaN. Dependent rows get minimum-norm reactions.
        """
        inertias = self.inertias if inertias is None else np.where(np.isnan(inertias), self.inertias, inertias)
        falling = self.free_fall if gravity is None else np.append(gravity, 0.0)
        if self.forces:
            if twist is None and self.applied.dissipate:
                raise InvalidMechanism("Mechanism.reaction: twist is None; dampers need it: (..., bodies, 3)")
            twist = np.zeros_like(pose) if twist is None else twist
            falling = falling + self.applied.on(pose, np.broadcast_to(twist, np.shape(pose))) / inertias
        return self.reactions_of(pose, np.asarray(acceleration) - falling, inertias)

    def reactions_of(self, pose: Array, excess: Array, inertias: Array) -> Array:
        """Reactions (..., rows) that cause an `excess` acceleration (..., bodies, 3) with inertias (bodies, 3)."""
        if self.row_count >= MANY_ROWS and np.ndim(pose) == np.ndim(excess) == 2:
            return self.reactions_of(pose[None], excess[None], inertias)[0]
        if self.row_count >= MANY_ROWS and np.ndim(pose) == 3:
            out = banded_reaction(self.joint_rows, pose, excess, inertias)
            dependent = np.isnan(out).any(axis=1)
            if dependent.any():
                out[dependent] = self._dense_reaction(pose[dependent], excess[dependent], inertias)
            return out
        return self._dense_reaction(pose, excess, inertias)

    def _dense_reaction(self, pose: Array, excess: Array, inertias: Array) -> Array:
        size = np.where(self.is_angular, self.length_scale, 1.0)
        stacked = excess.reshape((*excess.shape[:-2], 3 * len(self.bodies)))
        return reactions(self.rows(pose), inertias.reshape(-1), stacked, size, self.length_scale)

    @validated
    def degrees_of_freedom(self, pose: Annotated[Array, of_shape("bodies", 3)] | None = None) -> tuple[int, int]:
        """The numbers of configuration and velocity freedoms, from the rank of the rows at a pose or the start.

        A skate removes only a freedom of velocity; a drive removes a freedom of velocity and a freedom of configuration
        (box 18.3). The cost is O(bodies^3). Raises InvalidMechanism if the rows take more than LARGEST_RANK, or if a
        row is not finite, such as the row of a rod whose points coincide.
        """
        return self._freedoms_at_start if pose is None else self._freedoms(pose)

    @cached_property
    def _freedoms_at_start(self) -> tuple[int, int]:
        return self._freedoms(self.pose)

    def _freedoms(self, pose: Array) -> tuple[int, int]:
        shape = (self.row_count, 3 * len(self.bodies))
        require_room("mechanism: the rank of rows", shape, largest=LARGEST_RANK)
        rows = self.rows(pose)
        finite = np.isfinite(rows).all(axis=-1)
        if not finite.all():
            name = self.row_names[int(np.argmin(finite))]
            raise InvalidMechanism(f"mechanism: the row {name!r} is not finite at this pose; give another pose")
        coordinates = rows.shape[-1]
        length = self.length_scale
        return coordinates - rank(rows[self.holonomic], length), coordinates - rank(rows, length)

    @cached_property
    def length_scale(self) -> float:
        return length_scale(self.bodies, self.joints, self.forces)

    @cached_readonly
    def pose_unit(self) -> Array:
        """The units (3,) [m, m, rad] of a pose are the length scale, the length scale and 1."""
        return np.array([self.length_scale, self.length_scale, 1.0])

    @cached_property
    def time_scale(self) -> float:
        return time_scale(self.length_scale, self.gravity, self.bodies, self.joints, self.forces)


# Allowed violation of a row at the start, relative to the mechanism's length or speed. This tolerance is far above
# rounding errors and far below mistakes in the input.
START_TOLERANCE = 1e-9
# Rounding error of coordinates of bodies and joints, in units of the last digit.
PLACEMENT_ROUNDINGS = 64


def refuse_a_bad_start(mechanism: Mechanism) -> None:
    """Raise InvalidMechanism if no engine can begin with the start; the message names the row, body or force."""
    with np.errstate(over="ignore"):
        energies = 0.5 * np.sum(mechanism.inertias * mechanism.twist**2, axis=-1)
    for body, energy in zip(mechanism.bodies, energies.tolist(), strict=True):
        if not np.isfinite(energy):
            raise InvalidMechanism(
                f"body {body.name!r}: its kinetic energy at t = 0 is {energy} J, which is not finite: its twist is "
                f"{body.twist}, its mass {body.mass:g} kg and its inertia {body.inertia:g} kg m^2"
            )
    if mechanism.joints:
        start = mechanism.pose, mechanism.twist
        gap, slip = mechanism.gap(mechanism.pose, 0.0), mechanism.slip(*start)
        if sentence := open_joint(mechanism, gap, slip, *start, mechanism.length_scale):
            raise InvalidMechanism(f"mechanism: {sentence}")
    at_rest = np.zeros_like(mechanism.pose)
    for element in mechanism.forces:
        alone = AppliedForces.of((element,), mechanism._index)
        if not np.isfinite(alone.on(mechanism.pose, at_rest)).all():
            raise InvalidMechanism(
                f"force {element.name!r}: at t = 0 its two points coincide, so it has no direction; move one of them"
            )


def open_joint(mechanism: Mechanism, gap: Array, slip: Array, pose: Array, twist: Array, size: float) -> str | None:
    """A sentence about the row with the largest violation at the start, or None if all violations are allowed.

    gap and slip are (rows,), pose and twist (bodies, 3); size [m] is the mechanism's length.
    """
    speed = np.abs(twist[:, :2]).max() + size * np.abs(twist[:, 2]).max()
    # The tolerance is relative to the mechanism's length and speed, and above the rounding of a pose far from the
    # origin.
    rounding = PLACEMENT_ROUNDINGS * np.finfo(float).eps * np.abs(pose).max(axis=0)
    allowed_gap = START_TOLERANCE * size + max(rounding[:2]), START_TOLERANCE + rounding[2]
    for violation, (length, angle), (unit, angular), verb in (
        (gap, allowed_gap, ("m", "rad"), "open by"),
        (slip, (START_TOLERANCE * speed, START_TOLERANCE * speed / size), ("m/s", "rad/s"), "moving apart at"),
    ):
        value, allowed = np.nan_to_num(np.abs(violation)), np.where(mechanism.is_angular, angle, length)
        row = int(np.argmax(value - allowed))
        if value[row] > allowed[row]:
            return (
                f"at t = 0 row {mechanism.row_names[row]!r} is {verb} {value[row]:.3g} "
                f"{angular if mechanism.is_angular[row] else unit}; the start must satisfy it to {allowed[row]:.1g}"
            )
    return None
