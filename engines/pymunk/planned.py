"""How many sweeps each part of a motion needs: few on the way, and many where it comes near a singular position.

The sweeps of a whole run are counted for the worst pose that is expected (`engines.pymunk.expected`). That is the pose
of a moment: on the rest of the way a hundredth may be enough. Where a coarser run of the same motion has told the way,
every interval between two samples is swept as its own poses need. The intervals begin and end at the same times
whatever the step, so what the sweeps leave is as smooth in the step as before.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines.pymunk.contraction import DENSE, Whole, contractions, sweeps
from engines.pymunk.expected import TORN
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reference.validation import Count, validated

Array = NDArray[np.float64]

BUSY = 2000  # sweeps times joints, 25 us a step: below, to plan costs as much as it brings
# As many as LEFT asks for. Near a dead centre, at steps from 1e-3 to 1e-2 s, errors with 4 were up to twice those of
# the most sweeps throughout, and with 6 the same to two digits.
TIMES = 6
POSES, FINER = 128, 4  # poses that are looked at first, and into how many an interval is divided where sweeps rise
RISEN = 1.5  # times the fewest: there a singular position may be near, and between two poses

# All levels of an extrapolation follow the same run.
_latest: list[tuple[Trajectory, Mechanism, tuple[int, int, int], tuple[int, ...] | None]] = []


@validated
def planned(
    mechanism: Mechanism, coarser: Trajectory, most: Count, fewest: Count, work: Whole
) -> tuple[int, ...] | None:
    """Sweeps (samples,) in a step between a sample and the next, `most` of them at most; None if nothing is won.

    `coarser` is a run of the same motion with the same samples.
    """
    counts = (most, fewest, work)
    if not (_latest and _latest[0][0] is coarser and _latest[0][1] is mechanism and _latest[0][2] == counts):
        _latest[:] = [(coarser, mechanism, counts, _planned(mechanism, coarser, *counts))]
    return _latest[0][3]


def _planned(mechanism: Mechanism, coarser: Trajectory, most: int, fewest: int, work: int) -> tuple[int, ...] | None:
    joints, samples = len(mechanism.joints), len(coarser.t) - 1
    if most * joints <= BUSY or mechanism.row_count > DENSE or not _is_sound(mechanism, coarser):
        return None

    def needed(poses: Array) -> Array:
        found = contractions(mechanism, poses).tolist()
        return np.array([min(most, TIMES * sweeps(rho, joints, fewest, work)) for rho in found])

    stride = -(-samples // POSES)
    known = np.unique(np.append(np.arange(0, samples, stride), samples))
    try:
        count = needed(coarser.pose[known])
        risen = count > RISEN * count.min()
        between = np.flatnonzero((risen[:-1] | risen[1:]) & ((count[:-1] < most) | (count[1:] < most)))
        most_between = np.maximum(count[:-1], count[1:])
        if len(between):
            inside = needed(_between(coarser, known[between], known[between + 1])).reshape(len(between), FINER - 1)
            most_between[between] = np.maximum(most_between[between], inside.max(axis=1))
    except np.linalg.LinAlgError:  # masses so far apart that no number is left
        return None
    # The neighbours' too: the other run may be somewhat early or late.
    padded = np.pad(most_between, 1, mode="edge")
    widened = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    return tuple(np.repeat(widened, np.diff(known)).tolist())


def _is_sound(mechanism: Mechanism, run: Trajectory) -> bool:
    if not np.isfinite([run.pose, run.twist]).all():
        return False
    with np.errstate(all="ignore"):
        return bool((np.abs(np.nan_to_num(mechanism.gap(run.pose, run.t))) <= TORN * mechanism.length_scale).all())


def _between(run: Trajectory, begin: NDArray[np.intp], end: NDArray[np.intp]) -> Array:
    """Poses (intervals (FINER - 1), bodies, 3) inside intervals between samples, by cubic polynomials."""
    share = (np.arange(1, FINER) / FINER)[None, :, None, None]
    spacing = (run.t[end] - run.t[begin])[:, None, None, None]
    one, other = run.pose[begin][:, None], run.pose[end][:, None]
    leaving, arriving = spacing * run.twist[begin][:, None], spacing * run.twist[end][:, None]
    rest = 1 - share
    poses = (
        rest**2 * (1 + 2 * share) * one
        + share**2 * (1 + 2 * rest) * other
        + share * rest * (rest * leaving - share * arriving)
    )
    return poses.reshape(-1, *run.pose.shape[1:])
