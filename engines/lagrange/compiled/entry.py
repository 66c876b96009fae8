"""The one function that Python calls, compiled when this module is imported, or read from the cache.

All tasks are in one function, because what several compiled functions share is compiled anew for each of them.
"""

from __future__ import annotations

from numba import njit, types

from engines.lagrange import arrays as ix
from engines.lagrange.compiled.adaptive import adaptive_steps
from engines.lagrange.compiled.inner import straight
from engines.lagrange.compiled.steps import accelerations, fixed_steps

WHOLE, CELLS = types.int64[::1], types.complex128[:, ::1]
LIST, TABLE = types.float64[::1], types.float64[:, ::1]
SIGNATURE = types.int64(
    *(types.int64, WHOLE, LIST, CELLS, TABLE, LIST, LIST, LIST, LIST, TABLE),
    *(types.int64, types.float64, types.float64, types.int64, types.int64, TABLE, TABLE, TABLE),
)


def run(
    task, whole, real, cells, stages, weights, nodes, third, fifth, dense,
    project, tolerance, dt, every, begin, poses, twists, out,
):  # fmt: skip
    """MARCH: `fixed_steps`. ix.CONTROL: `adaptive_steps`, `dt` between samples. REACT: fill `out` (samples, rows) and
    `out`'s last columns with the reactions and accelerations at samples `dt` apart."""
    whole, real = straight(whole), straight(real)
    if task == ix.MARCH:
        return fixed_steps(whole, real, cells, stages, weights, nodes, project, dt, every, begin, poses, twists)
    if task == ix.CONTROL:
        return adaptive_steps(
            whole,
            real,
            cells,
            stages,
            weights,
            nodes,
            third,
            fifth,
            dense,
            project,
            tolerance,
            dt,
            begin,
            poses,
            twists,
        )
    columns, rows, pose, twist, acceleration = (
        whole[ix.COLUMNS], whole[ix.ROWS], whole[ix.POSE], whole[ix.TWIST], whole[ix.ACCELERATION]
    )  # fmt: skip
    for sample in range(begin, len(poses)):
        for k in range(columns):
            real[pose + k], real[twist + k] = poses[sample, k], twists[sample, k]
        accelerations(whole, real, cells, pose, twist, sample * dt, acceleration)
        if real[whole[ix.STATUS] + ix.WANTED_ROLL] >= 0:
            return sample
        for row in range(rows):
            out[sample, row] = real[whole[ix.REACTION] + row]
        for k in range(columns):
            out[sample, rows + k] = real[acceleration + k]
    return len(poses) - 1


run = njit(SIGNATURE, cache=True, nogil=True, error_model="numpy")(run)
