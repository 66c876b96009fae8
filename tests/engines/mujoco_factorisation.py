"""Whether MuJoCo's Newton solver gives the same accelerations with a sparse Jacobian as with a dense one.

Release 4.0.0's did not, without a warning, for some trees that branch: its Hessian's sparse Cholesky factor was wrong
(changelog of 4.0.1, github.com/google-deepmind/mujoco/issues/3767). The inertia and the other solvers were right.

It needs nothing but MuJoCo, so that it can be run beside any release: give it a model's file and it prints the number.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import copy
import sys
from typing import Any

import mujoco
import numpy as np

# Of the largest acceleration: the two differ in the order of their sums alone, so by rounding times a condition.
AGREEMENT = 1e-8
SPREAD = 0.3  # rad or m: how far the states stand from the model's own, so that no symmetry hides an entry


def disagreement(model: Any, states: int = 5, seed: int = 0) -> float:
    """The largest difference of the accelerations by both factorisations, relative to the largest of them.

    `model` is a mujoco.MjModel, left as it is; it is asked in `states` random states about its own, the first among
    them, with its own solver at its tightest. Callbacks take no part: this is about the inertia and the constraints.
    """
    random = np.random.default_rng(seed)
    kinds = [mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE]
    pairs = []
    for kind in kinds:
        own = copy.copy(model)
        own.opt.jacobian, own.opt.tolerance = kind, min(model.opt.tolerance, 1e-20)
        pairs.append((own, mujoco.MjData(own)))
    worst = 0.0
    for state in range(states):
        step = random.normal(size=model.nv) * SPREAD * (state > 0)
        rates = random.normal(size=model.nv)
        answers = []
        for own, data in pairs:
            mujoco.mj_resetData(own, data)
            mujoco.mj_integratePos(own, data.qpos, step, 1.0)
            data.qvel[:] = rates
            mujoco.mj_forward(own, data)
            answers.append(data.qacc.copy())
        dense, sparse = answers
        scale = max(float(np.abs(dense).max(initial=0.0)), 1e-300)
        worst = max(worst, float(np.abs(dense - sparse).max(initial=0.0)) / scale)
        if not np.isfinite(dense).all() or not np.isfinite(sparse).all():
            return float("inf")
    return worst


if __name__ == "__main__":
    print(mujoco.__version__, disagreement(mujoco.MjModel.from_xml_path(sys.argv[1])))
