"""What a planar mechanism is: rigid bodies, and joints written as velocity rows J(q) v = rate.

Maximal coordinates: every body has a pose (x, y, angle) of its centre of mass and a twist (vx, vy, omega), and the
mechanism's vectors q and v stack them in the order of `Mechanism.bodies`. Nothing here knows a scene or an engine.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.banded_reactions import MANY_ROWS, banded_reaction
from reference.joints import Drive, Joint, Vector
from reference.kinds import Floats
from reference.memory import require_room
from reference.row_system import rank, reactions
from reference.validation import AnyComplexes, InvalidMechanism, Name, Numbers, Positive, Valid, validated

Triple = tuple[float, float, float]
States = AnyComplexes  # (..., bodies, 3)

# A start that misses a row by more than this fraction of the mechanism's own length or speed is refused: far above
# rounding, far below a mistake.
START_TOLERANCE = 1e-9
ROUNDINGS = 64  # of a coordinate: what placing a body and its joints may take
# The rank of dense rows takes a minute at this size [bytes], and eight at twice the bodies.
LARGEST_RANK = 2**28


@dataclass(frozen=True)
class Body(Valid):
    """A rigid body in the plane, described at its centre of mass.

    mass [kg]; inertia [kg m^2] about the centre of mass; pose (x, y, angle) [m, m, rad] and twist (vx, vy, omega)
    [m/s, m/s, rad/s] at t = 0. Raises InvalidMechanism for a non-positive mass or inertia, or a number not finite.
    """

    name: Name
    mass: Positive
    inertia: Positive
    pose: Triple
    twist: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class _Group:
    """Joints of one kind, stacked so that one numpy expression serves them all."""

    joint: Any  # of the kind, each numeric field an array with the joints along its first axis
    first: NDArray[np.intp]  # (joints,) index of the body; the ground is the index after the last body
    second: NDArray[np.intp]
    rows: NDArray[np.intp]  # (joints, size) where their rows stand in the mechanism


def _stack(joints: Sequence[Any]) -> Any:
    """One joint that stands for several of its kind: every numeric field becomes an array."""
    if not getattr(joints[0], "stackable", True):
        return joints[0]
    numeric = [f.name for f in fields(joints[0]) if f.name not in ("name", "first", "second")]
    stacked = copy(joints[0])  # not made anew: arrays are no valid fields of one joint
    stacked.__dict__.update({name: np.array([getattr(joint, name) for joint in joints]) for name in numeric})
    return stacked


@dataclass(frozen=True)
class Mechanism(Valid):
    """Bodies, the joints between them, and gravity [m/s^2].

    Raises InvalidMechanism for a repeated or unknown name, a joint of a body with itself, or a start that does not
    satisfy the joints: an engine that begins with a gap would be blamed for ours.
    """

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    gravity: Vector = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.bodies:
            raise InvalidMechanism("mechanism: it has no bodies; give at least one")
        for kind, names in (("bodies", [b.name for b in self.bodies]), ("joints", [j.name for j in self.joints])):
            for name, count in Counter(names).items():
                if count > 1:
                    raise InvalidMechanism(f"mechanism: two {kind} are called {name!r}; names must differ")
        for joint in self.joints:
            for name in (joint.first, joint.second):
                if name is not None and name not in self._index:
                    raise self._unknown(f"joint {joint.name!r}", name)
            if joint.first == joint.second:
                raise InvalidMechanism(f"joint {joint.name!r}: it joins {joint.first!r} with itself; name two bodies")
        self._refuse_a_start_off_the_joints()

    def _refuse_a_start_off_the_joints(self) -> None:
        if not self.joints:
            return
        gap = np.nan_to_num(np.abs(self.gap(self.pose, 0.0)))
        slip = np.abs(self.slip(self.pose, self.twist))
        size = self.length_scale
        place, turn = (float(np.abs(part).max()) for part in (self.pose[:, :2], self.pose[:, 2]))
        speed = float(np.abs(self.twist[:, :2]).max()) + size * float(np.abs(self.twist[:, 2]).max())
        # Relative to the mechanism's own size and speed, and above the rounding of a place far from the origin.
        far = ROUNDINGS * np.finfo(float).eps
        for value, (length, angle), (unit, angular), what in (
            (gap, (START_TOLERANCE * size + far * place, START_TOLERANCE + far * turn), ("m", "rad"), "open by"),
            (slip, (START_TOLERANCE * speed, START_TOLERANCE * speed / size), ("m/s", "rad/s"), "moving apart at"),
        ):
            allowed = np.where(self.turning, angle, length)
            worst = int(np.argmax(value - allowed))
            if value[worst] > allowed[worst]:
                raise InvalidMechanism(
                    f"mechanism: at t = 0 row {self.row_names[worst]!r} is {what} {value[worst]:.3g} "
                    f"{angular if self.turning[worst] else unit}; the start must satisfy it to {allowed[worst]:.1g}"
                )

    @cached_property
    def _index(self) -> dict[str | None, int]:
        return {**{body.name: index for index, body in enumerate(self.bodies)}, None: len(self.bodies)}

    @cached_property
    def _groups(self) -> tuple[_Group, ...]:
        kinds: dict[Any, list[tuple[Any, range]]] = {}  # one that can't stack is a kind of its own
        start = 0
        for joint in self.joints:
            kind = type(joint) if getattr(joint, "stackable", True) else joint.name
            kinds.setdefault(kind, []).append((joint, range(start, start + joint.size)))
            start += joint.size
        return tuple(
            _Group(
                joint=_stack([joint for joint, _ in members]),
                first=np.array([self._index[joint.first] for joint, _ in members]),
                second=np.array([self._index[joint.second] for joint, _ in members]),
                rows=np.array([list(where) for _, where in members]),
            )
            for members in kinds.values()
        )

    @validated
    def body_index(self, name: Name) -> int:
        """Where a body stands in q, v and every trajectory of this mechanism."""
        if name not in self._index:
            raise self._unknown("mechanism", name)
        return self._index[name]

    def _unknown(self, owner: str, name: str) -> InvalidMechanism:
        known = ", ".join(repr(body.name) for body in self.bodies)
        return InvalidMechanism(f"{owner}: no body is called {name!r}; there are {known}")

    @cached_property
    def row_names(self) -> tuple[str, ...]:
        """One name a row, 'B x' for the x row of joint B; reactions stand in this order."""
        return tuple(f"{joint.name} {label}" for joint in self.joints for label in joint.labels)

    @cached_property
    def turning(self) -> NDArray[np.bool_]:
        """Which rows are rotations [rad, rad/s, N m] and not lengths [m, m/s, N] (rows,)."""
        return np.array([label == "torque" for joint in self.joints for label in joint.labels], dtype=bool)

    @cached_property
    def row_count(self) -> int:
        return sum(joint.size for joint in self.joints)

    @cached_property
    def pose(self) -> NDArray[np.float64]:
        """Poses at t = 0 (bodies, 3) [m, m, rad]."""
        return np.array([body.pose for body in self.bodies], dtype=float)

    @cached_property
    def twist(self) -> NDArray[np.float64]:
        """Twists at t = 0 (bodies, 3) [m/s, m/s, rad/s]."""
        return np.array([body.twist for body in self.bodies], dtype=float)

    @cached_property
    def inertias(self) -> NDArray[np.float64]:
        """The diagonal of the mass matrix (bodies, 3) [kg, kg, kg m^2]."""
        return np.array([(body.mass, body.mass, body.inertia) for body in self.bodies], dtype=float)

    @cached_property
    def free_fall(self) -> NDArray[np.float64]:
        """Accelerations without any joint (bodies, 3) [m/s^2, m/s^2, rad/s^2]."""
        return np.array([(*self.gravity, 0.0)] * len(self.bodies), dtype=float)

    @cached_property
    def rate(self) -> NDArray[np.float64]:
        """The prescribed right-hand side of J v = rate (rows,), zero but for drives."""
        return np.array([value for joint in self.joints for value in joint.rate], dtype=float)

    @cached_property
    def holonomic(self) -> NDArray[np.bool_]:
        """Which rows are derivatives of a position (rows,)."""
        return np.array([joint.holonomic for joint in self.joints for _ in range(joint.size)], dtype=bool)

    def require_room(self, samples: int) -> None:
        """Raise InvalidMechanism if the poses of a trajectory of so many samples take more than memory.LARGEST."""
        require_room("mechanism: a trajectory", (samples + 1, len(self.bodies), 3))

    def _with_ground(self, pose: NDArray[Any]) -> NDArray[Any]:
        if pose.shape[-2:] != (len(self.bodies), 3):
            raise InvalidMechanism(
                f"mechanism: poses have the shape {pose.shape}; they must be of (..., {len(self.bodies)}, 3), "
                "x, y and angle of every body"
            )
        return np.concatenate([pose, np.zeros((*pose.shape[:-2], 1, 3), dtype=pose.dtype)], axis=-2)

    @validated
    def gap(self, pose: States, t: ArrayLike) -> NDArray[Any]:
        """How far every joint is open (..., rows) [m, rad for a drive]; NaN in rows that constrain velocity only.

        pose (..., bodies, 3) and times t (...) [s].
        """
        everything = self._with_ground(pose)
        out = np.full((*everything.shape[:-2], self.row_count), np.nan, dtype=everything.dtype)
        for group in self._groups:
            if group.joint.holonomic:
                first, second = everything[..., group.first, :], everything[..., group.second, :]
                out[..., group.rows] = group.joint.gap(first, second, np.asarray(t)[..., None])
        return out

    @validated
    def rows(self, pose: States) -> NDArray[Any]:
        """The velocity rows J (..., rows, 3 bodies) at poses (..., bodies, 3); analytic, so a complex step passes.

        Dense, though each row has two bodies: raises InvalidMechanism where that would take more than memory.LARGEST.
        """
        everything = self._with_ground(pose)
        leading, count = everything.shape[:-2], everything.shape[-2]
        kind = np.result_type(everything, float)
        require_room("mechanism: dense rows", (*leading, self.row_count, count, 3), kind.itemsize)
        out = np.zeros((*leading, self.row_count, count, 3), dtype=kind)
        for group in self._groups:
            block = group.joint.rows(everything[..., group.first, :], everything[..., group.second, :])
            out[..., group.rows, group.first[:, None], :] += block[..., 0:3]
            out[..., group.rows, group.second[:, None], :] += block[..., 3:6]
        return out[..., :-1, :].reshape((*leading, self.row_count, 3 * (count - 1)))

    @validated
    def slip(self, pose: States, twist: States) -> NDArray[Any]:
        """J v - rate (..., rows) [m/s, rad/s for a drive]: how fast every joint is violated."""
        return self._velocities(pose, twist) - self.rate

    @validated
    def bias(self, pose: Numbers, twist: Numbers) -> NDArray[np.float64]:
        """-(dJ/dt) v (..., rows): the right-hand side of J a = bias, exact by a complex step along the motion."""
        step = 1e-100
        return -np.imag(self._velocities(pose + 1j * step * twist, twist)) / step

    def _velocities(self, pose: NDArray[Any], twist: NDArray[Any]) -> NDArray[Any]:
        """J v (..., rows) joint by joint: O(joints), where J alone is O(joints bodies)."""
        poses, twists = self._with_ground(pose), self._with_ground(twist)
        leading = np.broadcast_shapes(poses.shape[:-2], twists.shape[:-2])
        out = np.zeros((*leading, self.row_count), dtype=np.result_type(poses, twists, float))
        for group in self._groups:
            block = group.joint.rows(poses[..., group.first, :], poses[..., group.second, :])
            ends = np.concatenate([twists[..., group.first, :], twists[..., group.second, :]], axis=-1)
            out[..., group.rows] = (block @ ends[..., None])[..., 0]
        return out

    @validated
    def reaction(
        self,
        pose: Numbers,
        acceleration: Numbers,
        inertias: Numbers | None = None,
        gravity: Numbers | None = None,
    ) -> NDArray[np.float64]:
        """The joints' reactions (..., rows) [N, N m] that these accelerations need: M a = f + J^T reaction.

        pose and acceleration (..., bodies, 3). This is Newton's law read backwards, so it tells what any engine must
        have applied. `inertias` (bodies, 3) [kg, kg, kg m^2] and `gravity` (2,) [m/s^2] are the mechanism's unless an
        engine gives those of its own model (NaN for what it has none of): then the reactions are the forces that the
        engine has applied, and a wrong mass in it shows even where the motion is prescribed. Unique when the rows are
        independent; of redundant rows it gives the smallest.
        """
        inertias = self.inertias if inertias is None else np.where(np.isnan(inertias), self.inertias, inertias)
        falling = self.free_fall if gravity is None else np.append(gravity, 0.0)
        return self.forces(pose, np.asarray(acceleration) - falling, inertias)

    def forces(
        self, pose: NDArray[np.float64], excess: NDArray[np.float64], inertias: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Reactions (..., rows) that move masses (bodies, 3) by `excess` (..., bodies, 3) other than in free fall."""
        if self.row_count >= MANY_ROWS and np.ndim(pose) == np.ndim(excess) == 2:
            return self.forces(pose[None], excess[None], inertias)[0]
        if self.row_count >= MANY_ROWS and np.ndim(pose) == 3:
            found = banded_reaction(self, pose, excess, inertias)
            dependent = np.isnan(found).any(axis=1)
            if dependent.any():
                found[dependent] = self._dense_reaction(pose[dependent], excess[dependent], inertias)
            return found
        return self._dense_reaction(pose, excess, inertias)

    def _dense_reaction(
        self, pose: NDArray[np.float64], excess: NDArray[np.float64], inertias: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        size = np.where(self.turning, self.length_scale, 1.0)
        return reactions(self.rows(pose), inertias.reshape(-1), _column(excess)[..., 0], size)

    @validated
    def degrees_of_freedom(self, pose: Floats | None = None) -> tuple[int, int]:
        """(configuration, velocity) freedoms by the rank of the rows at a pose, the start unless given (box 18.3).

        A skate takes a freedom of velocity and none of configuration; a drive takes one of both. Dense linear algebra,
        O(bodies^3): raises InvalidMechanism where the rows take more than LARGEST_RANK.
        """
        shape = (self.row_count, 3 * len(self.bodies))
        require_room("mechanism: the rank of rows", shape, largest=LARGEST_RANK)
        rows = self.rows(self.pose if pose is None else pose)
        coordinates = rows.shape[-1]
        length = self.length_scale
        return coordinates - rank(rows[self.holonomic], length), coordinates - rank(rows, length)

    @cached_property
    def length_scale(self) -> float:
        """The largest distance between two joint points of one body, or of one and the centre of mass [m]."""
        points: dict[str, list[Vector]] = {body.name: [(0.0, 0.0)] for body in self.bodies}
        for joint in self.joints:
            for name, point in ((joint.first, "first_point"), (joint.second, "second_point")):
                if name is not None and hasattr(joint, point):
                    points[name].append(getattr(joint, point))
        return max((math.dist(p, q) for own in points.values() for p in own for q in own), default=0.0) or 1.0

    @cached_property
    def time_scale(self) -> float:
        """One radian of the fastest motion that the description promises [s]: the scale for an engine's settings.

        The inverse of the largest of: a body's rotation rate, a drive's rate, speed over length, and the pendulum
        frequency sqrt(g / length); 1 s when nothing moves or pulls.
        """
        length = self.length_scale
        rates = [math.sqrt(math.hypot(*self.gravity) / length)]
        rates += [abs(body.twist[2]) for body in self.bodies]
        rates += [math.hypot(*body.twist[:2]) / length for body in self.bodies]
        rates += [abs(joint.turning_rate) for joint in self.joints if isinstance(joint, Drive)]
        return 1 / max(rates) if max(rates) > 0 else 1.0


def _column(per_body: NDArray[Any]) -> NDArray[Any]:
    """(..., bodies, 3) as columns (..., 3 bodies, 1)."""
    per_body = np.asarray(per_body)
    return per_body.reshape((*per_body.shape[:-2], 3 * per_body.shape[-2], 1))
