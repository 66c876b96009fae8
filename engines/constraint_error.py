"""The errors of poses and reactions that follow from the gaps of the joints.

Gaps from regularisation, or from too few solver iterations, hardly depend on the step. A comparison of runs at several
steps does not show such gaps. Near a singular position J M^-1 J^T has an eigenvalue near zero, so that a small gap
means a large displacement. The displacement is the smallest one in the norm of the masses that closes the gap.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.reactions import RANK_TOLERANCE
from reference.trajectory import RunWarning

Array = NDArray[np.float64]

# Largest number of instants of a motion at which gaps are evaluated. Few instants are enough, since large displacements
# grow over many steps.
INSTANTS = 100
# Limit on rows * rows * coordinates * instants, since more would take seconds. A chain of a hundred links has no
# instants.
WORK = 20_000_000
# A warning is given if the estimated error of reactions exceeds this share of the largest force.
FORCES = 1e-3
# Lower limit of the largest force, as a share of the loads and inertial forces. A smaller reaction is a difference of
# larger forces. Rounding makes reactions of about 1e-9 of these forces, and estimates of 2e-8.
LEAST_FORCE = 1e-4


def examined_times(mechanism: Mechanism, valid: NDArray[np.bool_]) -> NDArray[np.int_]:
    """Indices of evenly spread `valid` times (times,); INSTANTS and WORK limit the number of indices."""
    places, rows = np.flatnonzero(valid), mechanism.row_count
    most = min(INSTANTS, WORK // (rows * rows * 3 * len(mechanism.bodies))) if rows else 0
    if most < 2 or not len(places):
        return places[:0]
    return places[np.unique(np.linspace(0, len(places) - 1, most).round().astype(int))]


def closing(mechanism: Mechanism, t: Array, pose: Array, at: Array | None = None) -> Array:
    """The displacements (instants, bodies, 3) [m, m, rad] that close the gaps of a motion at the instants `at` [s], by
    default at all times.

    The motion has the poses (times, bodies, 3) at the times t [s]. The displacement is -M^-1/2 B^+ gap with B = J
    M^-1/2. A dependent row (to RANK_TOLERANCE) or a row of velocities adds no displacement. The displacement is
    computed at the `examined_times` and interpolated linearly. The displacement is constant from the first pose that is
    not finite, and zero without examined times.
    """
    at = t if at is None else at
    examined = examined_times(mechanism, np.logical_and.accumulate(np.isfinite(pose).all(axis=(1, 2))))
    if not len(examined):
        return np.zeros((len(at), *pose.shape[1:]))
    poses, times, root = pose[examined], t[examined], np.sqrt(mechanism.inertias.reshape(-1))
    rows = mechanism.rows(poses) / root
    norm = np.linalg.norm(rows, axis=-1)
    norm[norm == 0] = 1.0
    inverse = -np.linalg.pinv(rows / norm[..., None], rcond=RANK_TOLERANCE) / root[:, None]
    moved = (inverse @ (np.nan_to_num(mechanism.gap(poses, times)) / norm)[..., None])[..., 0]
    interpolated = [np.interp(at, times, column) for column in moved.T]
    return np.stack(interpolated, axis=1).reshape(len(at), *pose.shape[1:])


def displaced_reaction(mechanism: Mechanism, pose: Array, reaction: Array, moved: Array) -> Array:
    """The reactions (times, rows) that give bodies the same accelerations at poses displaced by `moved`.

    pose, moved (times, bodies, 3); reaction (times, rows).
    """
    pulled = np.einsum("tr,trc->tc", reaction, mechanism.rows(pose)).reshape(pose.shape)
    return mechanism.reactions_of(pose + moved, pulled / mechanism.inertias, mechanism.inertias)


def largest_force(mechanism: Mechanism, pose: Array, twist: Array, reaction: Array) -> float:
    """The largest reaction in a motion [N]; a torque is divided by the mechanism's length.

    The result is at least LEAST_FORCE times the largest load or sum of m v^2 / length.
    pose, twist (times, bodies, 3); reaction (times, rows).
    """
    length = mechanism.length_scale
    arm, sizes = np.where(mechanism.is_angular, length, 1.0), np.array([1.0, 1.0, 1 / length])
    with np.errstate(all="ignore"):
        loads = np.abs(mechanism.inertias * mechanism.unconstrained(pose, twist) * sizes)
        turned = np.sum(mechanism.inertias * np.square(twist), axis=(1, 2)) / length
        least = LEAST_FORCE * np.fmax.reduce([*loads.ravel(), *turned], initial=np.finfo(float).tiny)
        return float(np.fmax.reduce(np.abs(reaction / arm), axis=None, initial=least))


def reaction_doubts(mechanism: Mechanism, pose: Array, twist: Array, reaction: Array, error: Array) -> list[RunWarning]:
    """A warning if the `error` of reactions (times, rows) exceeds FORCES times the `largest_force`."""
    if not mechanism.row_count:
        return []
    arm = np.where(mechanism.is_angular, mechanism.length_scale, 1.0)
    with np.errstate(all="ignore"):
        missed = np.fmax.reduce(np.abs(error / arm), axis=None, initial=0.0)
    share = missed / largest_force(mechanism, pose, twist, reaction)
    text = f"ours: reactions are resolved to {share:.0e} of the largest force"
    return [RunWarning(text, "reactions", "adapter")] if share > FORCES else []
