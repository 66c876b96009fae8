"""A start that satisfies ideal joints, for a model whose own start does not.

In a file whose positions have six digits, joints are open by about a millionth of the length. Newton's method with M^-1
J^T then finds the positions that close all joints.

In most scripts of games the bodies on a motor are at rest at t = 0. Ideal joints then change the velocities v0 to v by
an impulse. By Gauss's principle, v minimises (v - v0)^T M (v - v0) / 2 subject to J v = rate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines.reading import Note
from reference.checks import InvalidMechanism
from reference.forces import ForceElement
from reference.joints import Body, Joint, Vector
from reference.mechanism import START_TOLERANCE, Mechanism, open_joint
from reference.reactions import rank

Array = NDArray[np.float64]
# A message names the rows whose slip exceeds this share of the largest slip. A smaller slip is rounding.
TAKES_PART = 1e-6
MOST_NAMED = 4
# Largest gap that rounding to six digits explains, in rad or relative to the largest coordinate.
PRINTED = 1e-5
FAR = 100.0  # Largest coordinate [mechanism's lengths] to which PRINTED is relative.
MOST_ITERATIONS = 20  # Limit for Newton's method, which needs three iterations at a regular position.
DIGITS = 1e-6  # Largest rounding of an angle [rad]: a hundredth of the usual tolerance.
FASTEST = 1e150  # Largest velocity [m/s, rad/s] whose square is a floating point number.


class OpenStart(InvalidMechanism):
    """A joint is open at t = 0."""


class _AnyStart(Mechanism):
    def _refuse_a_bad_start(self) -> None:
        pass


def closed_positions(
    bodies: Sequence[Body], joints: Sequence[Joint], gravity: Vector, forces: Sequence[ForceElement]
) -> tuple[Array, Note] | None:
    """The nearest poses (bodies, 3) that close all joints, and a note about the change. The result is None if all
    joints are closed, if a joint is open by more than PRINTED, or if Newton's method finds no near poses.
    """
    if not joints:
        return None
    mechanism = _AnyStart(tuple(bodies), tuple(joints), gravity, tuple(forces))
    row_unit = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    still, size = np.zeros(mechanism.row_count), mechanism.length_scale

    def gap_at(pose: Array) -> Array:
        return np.nan_to_num(mechanism.gap(pose, 0.0))

    def is_open(pose: Array) -> bool:
        return open_joint(mechanism, gap_at(pose), still, pose, mechanism.twist, size) is not None

    # A gap is divided by the row's largest derivative; its unit is then rad or the length `far`.
    far = float(np.clip(np.abs(mechanism.pose[:, :2]).max(), size, FAR * size))
    rows = mechanism.rows(mechanism.pose) * np.tile([far, far, 1.0], len(bodies))
    gap = np.abs(gap_at(mechanism.pose)) / np.abs(rows).max(axis=1)
    if not is_open(mechanism.pose) or not gap.max() <= PRINTED:
        return None
    pose, moved = mechanism.pose, np.zeros_like(mechanism.pose)
    for _ in range(MOST_ITERATIONS):
        pose = pose + _least_change(mechanism, gap_at(pose), pose)
        moved = np.abs(pose - mechanism.pose) / [far, far, 1.0]
        if not moved.max() <= 100 * PRINTED:  # in a singular position a small gap needs a large displacement
            return None
        if not np.any(np.abs(gap_at(pose)) > 1e-13 * row_unit):
            break
    if is_open(pose):
        return None
    row = int(np.argmax(gap))
    body, coordinate = np.unravel_index(int(np.argmax(moved)), moved.shape)
    name, moved_by = mechanism.bodies[body].name, np.abs(pose - mechanism.pose)[body, coordinate]
    return pose, Note(
        "the start",
        f"its positions leave {mechanism.row_names[row]} open by {abs(gap_at(mechanism.pose)[row]):.2g} "
        f"{'rad' if mechanism.is_angular[row] else 'm'}, as rounded digits do; both motions begin with the nearest "
        f"positions that close all joints: {name} moves most, by {moved_by:.2g} {'rad' if coordinate == 2 else 'm'}",
    )


def with_consistent_start(
    bodies: Sequence[Body], joints: Sequence[Joint], gravity: Vector, forces: Sequence[ForceElement]
) -> tuple[Mechanism, tuple[Note, ...]]:
    """The mechanism with velocities that satisfy its rows, and a note if the velocities of `bodies` had to change.

    Raises OpenStart for an open joint, and InvalidMechanism if no velocities satisfy all rows.
    """
    elements = tuple(joints), gravity, tuple(forces)
    _refuse_without_digits(bodies)
    if not joints:
        return Mechanism(tuple(bodies), *elements), ()
    own = _AnyStart(tuple(bodies), *elements)
    slip, size = own.slip(own.pose, own.twist), own.length_scale
    if gap := open_joint(own, own.gap(own.pose, 0.0), np.zeros_like(slip), own.pose, own.twist, size):
        raise OpenStart(f"mechanism: {gap}")
    if open_joint(own, np.zeros_like(slip), slip, own.pose, own.twist, size) is None:
        return Mechanism(tuple(bodies), *elements), ()
    twist = own.twist + _least_change(own, slip, own.pose)
    missed = own.slip(own.pose, twist)
    speed = np.where(own.is_angular, 1.0, own.length_scale) * float(
        max(np.abs(own.twist[:, 2]).max(), np.abs(own.twist[:, :2]).max() / size, np.abs(_per_length(own, slip)).max())
    )
    if np.any(np.abs(missed) > START_TOLERANCE * speed):
        raise InvalidMechanism(_contradiction(own, missed))
    moved = (replace(body, twist=tuple(after)) for body, after in zip(bodies, twist.tolist(), strict=True))
    return Mechanism(tuple(moved), *elements), (_note(own, slip, twist),)


def _refuse_without_digits(bodies: Sequence[Body]) -> None:
    rounded = "floating point numbers of that size tell no angle to a millionth of a radian; give a smaller one"
    infinite = "its square, an energy, is no floating point number; give a smaller one"
    for body in bodies:
        x, y, rate = map(abs, body.twist)
        if np.spacing(abs(body.pose[2])) > DIGITS:
            raise InvalidMechanism(f"{body.name}: its angle at t = 0 is {body.pose[2]:.3g} rad; {rounded}")
        for value, unit in ((max(x, y), "m/s"), (rate, "rad/s")):
            if value > FASTEST:
                raise InvalidMechanism(f"{body.name}: its velocity at t = 0 is {value:.3g} {unit}; {infinite}")


def _least_change(own: Mechanism, slip: Array, pose: Array) -> Array:
    """The change of velocities (bodies, 3) that removes a slip (rows,) and is least in the norm of the masses. If
    `slip` is a gap, the result is the change of positions that closes it to first order.
    """
    rows, root = own.rows(pose), np.sqrt(own.inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    scale = 1 / np.where(norm > 0, norm, 1.0)
    left, sizes, right = np.linalg.svd(matrix * scale[:, None], full_matrices=False)
    count = rank(rows, own.length_scale)  # masses do not change the rank
    change = np.zeros_like(root)
    for _ in range(2):  # the second iteration reduces the rounding error
        wanted = -(slip + rows @ change) * scale
        change += right[:count].T @ (left[:, :count].T @ wanted / sizes[:count]) / root
    return change.reshape(-1, 3)


def _per_length(own: Mechanism, slip: Array) -> Array:
    return np.where(own.is_angular, slip, slip / own.length_scale)


def _contradiction(own: Mechanism, missed: Array) -> str:
    sizes = np.abs(_per_length(own, missed))
    joints = [joint.name for joint in own.joints for _ in range(joint.size)]
    driven = [name for name, rate in zip(joints, own.rate, strict=True) if rate]
    taking = [name for name, size in zip(joints, sizes, strict=True) if size > TAKES_PART * sizes.max()]
    names = list(dict.fromkeys(sorted(taking, key=lambda name: name not in driven)))
    worst = int(np.argmax(sizes))
    unit = "rad/s" if own.is_angular[worst] else "m/s"
    more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
    return (
        f"no velocities satisfy {', '.join(names[:MOST_NAMED])}{more} together: at best {own.row_names[worst]!r} is "
        f"moving apart at {abs(missed[worst]):.3g} {unit}; change a rate, or leave one of them out"
    )


def _note(own: Mechanism, slip: Array, twist: Array) -> Note:
    change = twist - own.twist
    rates = np.abs(_per_length(own, slip))
    broken = [name for name, rate in zip(own.row_names, rates, strict=True) if rate > TAKES_PART * rates.max()]
    more = f" and {len(broken) - MOST_NAMED} more rows" if len(broken) > MOST_NAMED else ""
    energies = 0.5 * np.sum(own.inertias * change**2, axis=1)
    most = int(np.argmax(energies))
    before, after = own.twist[most], twist[most]
    worst = int(np.argmax(rates))
    unit = "rad/s" if own.is_angular[worst] else "m/s"
    return Note(
        "the start",
        f"its velocities do not satisfy {', '.join(broken[:MOST_NAMED])}{more} (by {abs(slip[worst]):.3g} {unit}), so "
        f"the ideal motion begins after the impulse that satisfies all joints with the least change of kinetic energy "
        f"({energies.sum():.3g} J in the change of velocities): {own.bodies[most].name} changes most, from "
        f"{np.hypot(*before[:2]):.3g} to {np.hypot(*after[:2]):.3g} m/s and from {before[2]:.3g} to {after[2]:.3g} "
        f"rad/s; your model is run from the start that it has",
    )
