"""A motion at sampled times, and what can be said of it without a reference: energy, joint gap, slip, joint points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Numbers, Valid, validated
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.validators import NOT_FINITE, of_shape

Array = NDArray[np.float64]
SHOWN = 6  # instants in a notebook's table


@dataclass(frozen=True)
class Trajectory(Valid):
    """Poses, twists and reactions at times t, in the order of the mechanism's bodies and rows.

    The truth and every engine give one of these, the first sample at t = 0. An engine also says what it cost
    (`stepping`), what it warned of, whether it reset itself, and its own estimate of its error if its method has one.
    """

    _copies: ClassVar[bool] = False  # nothing is kept that follows from its arrays, and they may be large

    t: Annotated[Array, of_shape("times")]  # (times,) s
    pose: Annotated[Numbers, of_shape("times", "bodies", 3)]  # (times, bodies, 3) m, m, rad; angles not wrapped
    twist: Annotated[
        Numbers, of_shape("times", "bodies", 3)
    ]  # (times, bodies, 3) m/s, m/s, rad/s, at the same instants as the poses
    reaction: Annotated[
        Numbers, of_shape("times", "rows")
    ]  # (times, rows) N or N m, M a = f + J^T reaction; NaN where unknown
    stepping: Annotated[float, NOT_FINITE] = float(
        "nan"
    )  # s of CPU in the stepping loop, recording included; NaN for a truth
    warnings: tuple[str, ...] = ()  # what the engine itself said
    reset_at: float | None = None  # s, the time at which the engine started anew by itself; samples from there are NaN
    estimate: Annotated[Numbers, of_shape("times", "bodies", 3)] | None = (
        None  # (times, bodies, 3) the method's own estimate of its error in the poses
    )
    unresolved_at: float | None = None  # s, from when on that estimate is above what the method claims

    def table(self) -> dict[str, Array]:
        """Times and every coordinate (times,) by a name, "t" [s], "x 0", "y 0" [m], "angle 0" [rad] and so on.

        As pandas takes it: `pandas.DataFrame(trajectory.table())`.
        """
        numbers = range(self.pose.shape[1])
        names = [(f"{name} {body}", body, place) for body in numbers for place, name in enumerate(("x", "y", "angle"))]
        return {"t": self.t, **{name: self.pose[:, body, place] for name, body, place in names}}

    def _repr_html_(self) -> str:
        """Poses at a few instants, for a notebook."""
        columns = self.table()
        looks = np.unique(np.linspace(0, len(self.t) - 1, SHOWN).round().astype(int))
        head = "".join(f"<th>{name}</th>" for name in columns)
        rows = ("".join(f"<td>{column[look]:.6g}</td>" for column in columns.values()) for look in looks)
        said = f"{len(self.t)} instants, {self.pose.shape[1]} bodies (s, m, rad)"
        return f"<p>{said}</p><table><tr>{head}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


@validated
def energy(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """Kinetic energy and the potential (`Mechanism.potential`) of gravity and forces (times,) [J].

    It stays where no drive and no damper takes part.
    """
    kinetic = 0.5 * np.sum(mechanism.inertias * trajectory.twist**2, axis=(-2, -1))
    return kinetic + mechanism.potential(trajectory.pose)


@validated
def joint_gap(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """How far every joint is open (times, rows) [m, rad for a drive]; NaN in rows that constrain velocity only."""
    return mechanism.gap(trajectory.pose, trajectory.t)


@validated
def slip(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """J v - rate (times, rows) [m/s, rad/s]: how fast every joint is violated."""
    return mechanism.slip(trajectory.pose, trajectory.twist)


def body_points(mechanism: Mechanism, pose: Array) -> dict[str, Array]:
    """World points (points, 2) [m] of each body's joints, in the order of the joints, for one pose (bodies, 3)."""
    own: dict[str, list[tuple[float, float]]] = {body.name: [] for body in mechanism.bodies}
    for joint in mechanism.joints:
        for name, point in joint.points:
            if name is not None and point not in own[name]:
                own[name].append(point)
    out = {}
    for name, points in own.items():
        x, y, angle = pose[mechanism.body_index(name)]
        out[name] = np.array([x, y]) + rotated(angle, np.array(points, dtype=float).reshape(-1, 2))
    return out


def ground_points(mechanism: Mechanism) -> Array:
    """World points (points, 2) [m] at which joints hold to the ground; a slot holds to a line, which has none."""
    points = [point for joint in mechanism.joints for name, point in joint.fixed_points if name is None]
    return np.array(list(dict.fromkeys(points)), dtype=float).reshape(-1, 2)
