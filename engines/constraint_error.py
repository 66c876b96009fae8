"""The error of a motion that shows in its joints: poses by their gaps, and reactions by these poses.

What an engine's regularisation, or the iterations that its solver lacks, leave open is much the same at every step, so
that runs agree on it. Near a singular position a small gap is a large displacement: J M^-1 J^T has an eigenvalue near
zero, and forces R f of a compliance R as small release its direction. The gap is there to be measured, though: the
smallest motion that closes it, in the metric of the masses, is that displacement.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.rows import RANK_TOLERANCE
from reference.trajectory import RunWarning

Array = NDArray[np.float64]

# Instants of a motion at which gaps are looked at. Those that matter build up while it stays near a singular position.
INSTANTS = 100
# Rows times rows times coordinates, up to which an instant costs less than some hundred steps: beyond, there are fewer
# of them, and none of a chain of a hundred links, which would take seconds.
WORK = 20_000_000
# Reactions whose estimated error is above this part of the largest force are reported.
FORCES = 1e-3
# Of the loads on bodies and of what turns them: smaller reactions are differences of larger forces, and where nothing
# is held they are rounding: velocities divided by a step leave 1e-9 of these forces, in estimates twenty times that.
LEAST_FORCE = 1e-4


def some(mechanism: Mechanism, sound: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Places of up to INSTANTS of the `sound` (times,) times, evenly spread; none where rows take more than WORK."""
    places, rows = np.flatnonzero(sound), mechanism.row_count
    most = min(INSTANTS, WORK // (rows * rows * 3 * len(mechanism.bodies))) if rows else 0
    if most < 2 or not len(places):
        return places[:0]
    return places[np.unique(np.linspace(0, len(places) - 1, most).round().astype(int))]


def closing(mechanism: Mechanism, t: Array, pose: Array, at: Array | None = None) -> Array:
    """The displacements (instants, bodies, 3) [m, m, rad] that close the gaps of a motion at the instants `at` [s].

    Poses (times, bodies, 3) are those at times t [s], which are the instants unless others are given. With B = J M^-1/2
    it is -M^-1/2 B^+ gap, whose condition is that of J and not of J M^-1 J^T. Rows that depend on others to
    RANK_TOLERANCE ask for nothing, and rows that hold velocities have no gap. Worked out at `some` of the times, and
    linear in between; zero if the first pose is not finite, and constant from where one is not.
    """
    at = t if at is None else at
    looks = some(mechanism, np.logical_and.accumulate(np.isfinite(pose).all(axis=(1, 2))))
    if not len(looks):
        return np.zeros((len(at), *pose.shape[1:]))
    seen, when, root = pose[looks], t[looks], np.sqrt(mechanism.inertias.reshape(-1))
    rows = mechanism.rows(seen) / root
    size = np.linalg.norm(rows, axis=-1)
    size[size == 0] = 1.0
    inverse = -np.linalg.pinv(rows / size[..., None], rcond=RANK_TOLERANCE) / root[:, None]
    moved = (inverse @ (np.nan_to_num(mechanism.gap(seen, when)) / size)[..., None])[..., 0]
    between = [np.interp(at, when, column) for column in moved.T]
    return np.stack(between, axis=1).reshape(len(at), *pose.shape[1:])


def displaced_reaction(mechanism: Mechanism, pose: Array, reaction: Array, moved: Array) -> Array:
    """The reactions (times, rows) that give bodies the same accelerations at poses displaced by `moved`.

    pose and moved (times, bodies, 3), reaction (times, rows). Near a singular position small displacements of rows
    change them by much.
    """
    pulled = np.einsum("tr,trc->tc", reaction, mechanism.rows(pose)).reshape(pose.shape)
    return mechanism.reactions_of(pose + moved, pulled / mechanism.inertias, mechanism.inertias)


def largest_force(mechanism: Mechanism, pose: Array, twist: Array, reaction: Array) -> float:
    """The largest of reactions (times, rows) in a motion, poses and twists (times, bodies, 3) [N].

    A torque counts as the force that it is at the mechanism's length. At least LEAST_FORCE of the loads in the motion,
    and of m v^2 / length.
    """
    length = mechanism.length_scale
    arm, sizes = np.where(mechanism.is_angular, length, 1.0), np.array([1.0, 1.0, 1 / length])
    with np.errstate(all="ignore"):
        loads = np.abs(mechanism.inertias * mechanism.unconstrained(pose, twist) * sizes)
        turned = np.sum(mechanism.inertias * np.square(twist), axis=(1, 2)) / length
        least = LEAST_FORCE * np.fmax.reduce([*loads.ravel(), *turned], initial=np.finfo(float).tiny)
        return float(np.fmax.reduce(np.abs(reaction / arm), axis=None, initial=least))


def reaction_doubts(mechanism: Mechanism, pose: Array, twist: Array, reaction: Array, error: Array) -> list[RunWarning]:
    """The warning of reactions (times, rows) whose `error` is above FORCES of the `largest_force`, if it is."""
    if not mechanism.row_count:
        return []
    arm = np.where(mechanism.is_angular, mechanism.length_scale, 1.0)
    with np.errstate(all="ignore"):
        missed = np.fmax.reduce(np.abs(error / arm), axis=None, initial=0.0)
    share = missed / largest_force(mechanism, pose, twist, reaction)
    text = f"ours: reactions are resolved to {share:.0e} of the largest force"
    return [RunWarning(text, "reactions", "adapter")] if share > FORCES else []
