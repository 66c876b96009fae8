"""A motion at sampled times, with functions for energy, gaps, slips and joint points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np

from reference.checks import Numbers, Valid, validated
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.validators import NOT_FINITE, Array, of_shape

# Number of rows in a notebook's table of a motion.
TABLE_ROWS = 6
# A warning about an adapter of this suite begins with this text. Stored rows contain only the text of warnings.
ADAPTER_PREFIX = "ours:"
KNOWN_WRONG = "known to be wrong"  # The warning about a faulty release contains these words.

WarningKind = Literal[
    "contact",  # A contact is lost, or a body rotates too far in a step.
    "gap",  # A joint is open.
    "known fault",  # This engine or release computes wrong motions in known cases.
    "lost",  # The motion ends by numbers that are not finite, an unsatisfied joint, or a failed solver.
    "rank",  # Rows of joints are nearly dependent, so that rounding is amplified.
    "rate limit",  # A velocity was limited.
    "reactions",  # Reactions are unknown or have a large error.
    "residual",  # A solver left a residual.
    "start reactions",  # The reactions at the start are wrong, and all other values are right.
    "stiff",  # The steps are limited by stability and not by accuracy.
    "unconverged",  # The solver's slowest mode does not converge within a step.
    "unresolved",  # The error may exceed the method's claim.
    "other",
]


class RunWarning(str):
    """A warning of a run: a text with fields for its kind, origin and time.

    kind: one of WarningKind. origin: "engine" for messages of the engine, "upstream" for faults of the engine that this
    suite reports, "adapter" for findings about this suite's adapter or method. time [s]: the time from which the
    warning holds, or None if unknown.

    A warning is a string, and two warnings with the same text are equal. Plain strings have the origin "adapter" if
    they begin with "ours:", else "engine".
    """

    kind: WarningKind
    origin: Literal["engine", "upstream", "adapter"]
    time: float | None

    def __new__(
        cls,
        text: str,
        kind: WarningKind = "other",
        origin: Literal["engine", "upstream", "adapter"] = "engine",
        time: float | None = None,
    ) -> Self:
        warning = super().__new__(cls, text)
        warning.kind, warning.origin, warning.time = kind, origin, time
        return warning

    def __getnewargs__(self) -> tuple[str, WarningKind, str, float | None]:  # type: ignore[override]
        return str(self), self.kind, self.origin, self.time

    @classmethod
    def of(cls, warning: str) -> RunWarning:
        """Convert a plain string to a warning of the kind "other"; return a `RunWarning` unchanged."""
        if isinstance(warning, RunWarning):
            return warning
        return cls(warning, origin="adapter" if warning.startswith(ADAPTER_PREFIX) else "engine")


@dataclass(frozen=True)
class Trajectory(Valid):
    """Poses, twists and reactions at times t, in the order of the mechanism's bodies and rows.

    The first sample is at t = 0. Only engines' runs have the last five fields.

    t (times,) [s].
    pose (times, bodies, 3) [m, m, rad]. Angles are not wrapped.
    twist (times, bodies, 3) [m/s, m/s, rad/s], at the times of the poses.
    reaction (times, rows) [N or N m] by M a = f + J^T reaction; NaN if unknown.
    stepping [s] is the CPU time of the stepping loop, recording included.
    warnings of the engine and of our adapter are a `RunWarning` or plain strings.
    reset_at [s] is the time at which the engine reset its state; later samples are NaN.
    estimate (times, bodies, 3) is the method's estimate of its error in the poses.
    unresolved_at [s] is the time after which the estimate exceeds the method's claim.
    """

    _copies: ClassVar[bool] = False  # arrays may be large

    t: Annotated[Array, of_shape("times")]
    pose: Annotated[Numbers, of_shape("times", "bodies", 3)]
    twist: Annotated[Numbers, of_shape("times", "bodies", 3)]
    reaction: Annotated[Numbers, of_shape("times", "rows")]
    stepping: Annotated[float, NOT_FINITE] = float("nan")
    warnings: tuple[RunWarning | str, ...] = ()
    reset_at: float | None = None
    estimate: Annotated[Numbers, of_shape("times", "bodies", 3)] | None = None
    unresolved_at: float | None = None

    def warnings_of(self, kind: WarningKind) -> tuple[RunWarning, ...]:
        """The warnings of this kind."""
        return tuple(warning for warning in map(RunWarning.of, self.warnings) if warning.kind == kind)

    @property
    def has_engine_warning(self) -> bool:
        """Whether a warning has the origin "engine" or "upstream"."""
        return any(RunWarning.of(warning).origin != "adapter" for warning in self.warnings)

    def table(self) -> dict[str, Array]:
        """Columns (times,) by name, which are "t" [s] and, for body 0, "x 0", "y 0" [m] and "angle 0" [rad].

        For pandas: `pandas.DataFrame(trajectory.table())`.
        """
        bodies = range(self.pose.shape[1])
        names = [(f"{name} {body}", body, index) for body in bodies for index, name in enumerate(("x", "y", "angle"))]
        return {"t": self.t, **{name: self.pose[:, body, index] for name, body, index in names}}

    def _repr_html_(self) -> str:
        columns = self.table()
        samples = np.unique(np.linspace(0, len(self.t) - 1, TABLE_ROWS).round().astype(int))
        head = "".join(f"<th>{name}</th>" for name in columns)
        rows = ("".join(f"<td>{column[sample]:.6g}</td>" for column in columns.values()) for sample in samples)
        caption = f"{len(self.t)} instants, {self.pose.shape[1]} bodies (s, m, rad)"
        return f"<p>{caption}</p><table><tr>{head}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


@validated
def energy(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """The kinetic energy plus `Mechanism.potential` (times,) [J].

    The energy is constant without drives and dampers.
    """
    kinetic = 0.5 * np.sum(mechanism.inertias * trajectory.twist**2, axis=(-2, -1))
    return kinetic + mechanism.potential(trajectory.pose)


@validated
def joint_gap(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """The position violation of every row (times, rows) [m or rad], or NaN if the row constrains velocity only."""
    return mechanism.gap(trajectory.pose, trajectory.t)


@validated
def slip(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """The velocity violation J v - rate of every row (times, rows) [m/s or rad/s]."""
    return mechanism.slip(trajectory.pose, trajectory.twist)


def body_points(mechanism: Mechanism, pose: Array) -> dict[str, Array]:
    """World points (points, 2) [m] of each body's joints, in the order of the joints, for one pose (bodies, 3)."""
    by_body: dict[str, list[tuple[float, float]]] = {body.name: [] for body in mechanism.bodies}
    for joint in mechanism.joints:
        for name, point in joint.points:
            if name is not None and point not in by_body[name]:
                by_body[name].append(point)
    out = {}
    for name, points in by_body.items():
        x, y, angle = pose[mechanism.body_index(name)]
        out[name] = np.array([x, y]) + rotated(angle, np.array(points, dtype=float).reshape(-1, 2))
    return out


def ground_points(mechanism: Mechanism) -> Array:
    """World points (points, 2) [m] of joints at the ground, without points of slots."""
    points = [point for joint in mechanism.joints for name, point in joint.fixed_points if name is None]
    return np.array(list(dict.fromkeys(points)), dtype=float).reshape(-1, 2)
