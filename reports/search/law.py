"""What accelerations, or velocities after an impulse, a mechanism's own rows allow: the judge at one instant.

Gauss's principle: of all that satisfy the rows it is the nearest to the free motion, in the metric of the masses. Rows
may give way to their forces, as an engine says that its own do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism

Array = NDArray[np.float64]
ROUNDINGS = 10.0  # of a place or a velocity
ESTIMATED = 10.0  # times its own estimate an error may be
REFINED = 3


class NotAsked(Exception):
    """A law that can't be asked of an engine here; the message is one sentence that says why."""


class Fault(Exception):
    """Something is not there that has to be; the message is one sentence that says what."""


@dataclass(frozen=True, eq=False)
class Constrained:
    """Accelerations or velocities (bodies, 3), and the forces or impulses of the rows (rows,)."""

    motion: Array
    force: Array


def constrained(rows: Array, right: Array, inertias: Array, free: Array, give: Array | None = None) -> Constrained:
    """J a = right - give give^T f with M (a - free) = J^T f, for rows (rows, 3 bodies) and `give` (rows, any number).

    By the SVD of J M^(-1/2), never through its square. That is right to rounding of the largest part of M^(1/2) a, in
    which a light body's is small: so what both equations leave is solved for again (iterative refinement; Skeel 1980).
    """
    if not len(rows):
        return Constrained(free, np.zeros(0))
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:  # further coordinates of unit mass, which the forces move
        matrix = np.hstack([matrix, give])
    left, sizes, turned = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    own, motion, force = free.reshape(-1), np.zeros(len(root)), np.zeros(len(rows))
    for _ in range(1 + REFINED):
        pushed = own - motion + (rows.T @ force) / root**2
        short = right - rows @ motion - (0.0 if give is None else give @ (give.T @ force))
        lacking = left.T @ ((short - rows @ pushed) / norm)
        motion = motion + pushed + (turned.T @ (lacking / sizes))[: len(root)] / root
        force = force + left @ (lacking / sizes**2) / norm
    return Constrained(motion.reshape(-1, 3), force)


def ideal(mechanism: Mechanism, pose: Array, twist: Array) -> Constrained:
    """Accelerations and forces of a mechanism whose rows do not give way."""
    free = mechanism.unconstrained(pose, twist)
    return constrained(mechanism.rows(pose), mechanism.bias(pose, twist), mechanism.inertias, free)


@dataclass(frozen=True, eq=False)
class Response:
    """What joints make of rows that miss by so much: motions M^-1 J^T A^-1 (3 bodies, rows), and forces A^-1 (rows,
    rows), with A = J M^-1 J^T + give give^T."""

    motion: Array
    force: Array


def response(rows: Array, inertias: Array, give: Array | None = None) -> Response:
    """By the SVD of J M^(-1/2), as in `constrained`: the larger the more nearly rows depend on each other, and the
    farther masses are apart."""
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if not len(rows):
        return Response(np.zeros((len(root), 0)), np.zeros((0, 0)))
    given = matrix if give is None else np.hstack([matrix, give])
    left, sizes, turned = np.linalg.svd(given / norm[:, None], full_matrices=False)
    motion = (turned.T[: len(root)] / sizes) @ left.T / norm / root[:, None]
    return Response(motion, (left / sizes**2) @ left.T / norm / norm[:, None])


def lost_in_products(mechanism: Mechanism, pose: Array) -> float:
    """Which part of forces, or of what closes a gap, rounding of A = J M^-1 J^T may change, whoever forms it.

    Its sums are rounded by dA = eps |J| M^-1 |J^T|, in which a body that is far from its joint, beside its radius of
    gyration, leaves nothing of its mass. So f of A f = b changes by |A^-1| dA |f| (Higham 2002, theorem 7.4), beside
    the largest of f sqrt(diag A), in which rows of any unit are alike. Bodies move as forces do.
    """
    rows, light = mechanism.rows(pose), 1 / mechanism.inertias.reshape(-1)
    if not len(rows):
        return 0.0
    size = np.sqrt(rows**2 @ light)
    inverse = np.abs(response(rows, mechanism.inertias).force) * np.outer(size, size)
    products = (np.abs(rows) * light) @ np.abs(rows.T) / np.outer(size, size)
    return float(np.finfo(float).eps * (inverse @ products).sum(axis=1).max())


def carried(mechanism: Mechanism, pose: Array, wrong: Array, gap: Array | float = 0.0) -> Constrained:
    """What numbers that are `wrong` (bodies, 3) by so much, and a `gap` (rows,), leave in motions (bodies, 3), and in
    impulses (rows,).

    Each row then misses by e, the sum of its sizes times these, and joints that set it right move bodies (`response`).
    Rounding has no sign, so squares are added. A motion is wrong by its numbers at least.
    """
    rows = mechanism.rows(pose)
    back = response(rows, mechanism.inertias)
    missed = np.linalg.norm(rows * wrong.reshape(-1), axis=1) + gap
    moved = np.linalg.norm(back.motion * missed, axis=1).reshape(-1, 3)
    return Constrained(np.maximum(wrong, moved), np.linalg.norm(back.force * missed, axis=1))


def rounded(
    rows: Array,
    law: Constrained,
    right: Array,
    inertias: Array,
    free: Array,
    give: Array,
    doubt: tuple[Array, Array],
) -> Constrained:
    """What rounding of everything that enters `constrained` leaves in its motion and its forces, `law`.

    `doubt` (rows,) and (bodies, 3): by how much `right`, and M a, may be wrong beside their own rounding.

    With e the unit of rounding, dJ = e |J|, M, J, f and a as there and G = give give^T, the first order of
    M a - J^T f = M free and J a + G f = right is

        M da - J^T df = u, u = e (|J^T f| + |M free|) + doubt;  J da + G df = w, w = e (|J a| + |right|) + doubt
        da = S M^-1 u + M^-1 J^T A^-1 w,  df = A^-1 (w - J M^-1 u),  A = J M^-1 J^T + G,  S = 1 - M^-1 J^T A^-1 J

    where products of absolute values are meant. Rounding has no sign, so squares are added.
    """
    unit = ROUNDINGS * np.finfo(float).eps
    inverse, motion, back = 1 / inertias.reshape(-1), law.motion.reshape(-1), response(rows, inertias, give)
    pushed = unit * np.sqrt((rows**2).T @ law.force**2 + (free.reshape(-1) / inverse) ** 2) + doubt[1].reshape(-1)
    lacking = unit * np.sqrt(rows**2 @ motion**2 + right**2) + doubt[0]
    moved = np.hstack([back.motion * lacking, (np.eye(len(motion)) - back.motion @ rows) * inverse * pushed])
    pulled = np.hstack([back.force * lacking, back.motion.T * pushed])
    return Constrained(np.linalg.norm(moved, axis=1).reshape(-1, 3), np.linalg.norm(pulled, axis=1))


def written(mechanism: Mechanism, away: float = 0.0) -> Array:
    """How large the numbers (bodies, 3) are in which it is written [m, m, and 1 for a cosine]; at least `away` [m]."""
    out = np.ones_like(mechanism.pose)
    far = np.abs(mechanism.pose[:, :2]).max(axis=1)
    out[:, :2] = np.maximum(far, max(mechanism.length_scale, away))[:, None]
    return out


def difference(mechanism: Mechanism, found: Array, expected: Array, others: tuple[Array, ...] = ()) -> float:
    """The largest difference of two motions (bodies, 3), beside the largest of them and of `others`; NaN is infinite.

    Rotations count as the arcs that they make at the mechanism's own length.
    """
    size = np.array([1.0, 1.0, mechanism.length_scale])
    largest = max(float(np.abs(each * size).max()) for each in (expected, *others))
    error = float(np.abs((found - expected) * size).max())
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def force_difference(mechanism: Mechanism, found: Array, expected: Array, others: tuple[float, ...] = ()) -> float:
    """The same of forces (rows,): torques count as the forces that they need at the mechanism's own length.

    Rows whose force is NaN, since the engine can't tell it, are left out. `others` [N] are sizes to compare with.
    """
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    told = ~np.isnan(found)
    if not told.any():
        return 0.0
    largest = max(float(np.abs(expected * size).max()), *others, 0.0)
    error = float(np.abs((found - expected) * size)[told].max())
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def turned_in_a_step(mechanism: Mechanism, dt: float, pose: Array, twist: Array) -> float:
    """By how much the fastest body, or the direction of a row, turns in a step of dt [s] from a state on: rad.

    A row turns at about the rate |J' v| / (|J| |v|), with the velocities of its bodies: a short rod, say, whose ends
    move apart. Above a radian no integrator follows, and what comes of the motion is rounding.
    """
    rows, bias = mechanism.rows(pose), mechanism.bias(pose, twist)
    size = np.array([1.0, 1.0, mechanism.length_scale])
    parts = np.abs(rows.reshape(len(rows), *twist.shape) / size).max(axis=-1, initial=0.0)  # (rows, bodies)
    moving = parts.max(axis=1, initial=0.0) * ((parts > 0) @ np.abs(twist * size).max(axis=-1))
    spin = np.abs(twist[:, 2]).max() * dt + np.abs(ideal(mechanism, pose, twist).motion[:, 2]).max() * dt**2
    return float(max(spin, dt * (np.abs(bias) / np.where(moving > 0, moving, np.inf)).max(initial=0.0)))


def driving_force(mechanism: Mechanism, twist: Array) -> float:
    """A force [N] that acts in the mechanism: of gravity, of its motion, or of its force elements at the start."""
    rate = np.abs(twist[:, 2]).max()
    speed = np.hypot(twist[:, 0], twist[:, 1]).max()
    pull = np.hypot(*mechanism.gravity) + rate * rate * mechanism.length_scale + speed / mechanism.time_scale
    acting = mechanism.inertias * mechanism.unconstrained(mechanism.pose, mechanism.twist)
    acting = np.abs(acting / np.array([1.0, 1.0, mechanism.length_scale])).max()
    return float(max(mechanism.inertias[:, 0].max() * pull, acting))
