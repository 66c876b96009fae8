"""MuJoCo's sparse factorisation against its dense one: the same accelerations.

Release 4.0.0's Newton solver had others, without a warning, for some trees that branch: its Hessian's sparse Cholesky
factor was wrong (changelog of 4.0.1, github.com/google-deepmind/mujoco/issues/3767).
"""

from __future__ import annotations

import copy
from typing import Any

import mujoco
import numpy as np

from engines import mujoco as adapter
from reference.scenes.catalogue import scene

# Of the largest acceleration: the two differ in the order of their sums alone, so by rounding times a condition.
AGREEMENT = 1e-8
SPREAD = 0.3  # rad or m: how far the states stand from the model's own, so that no symmetry hides an entry
# Three links on the tip of the first, a fifth on one of them, two loops across: the smallest that 4.0.0 gets wrong.
PARENTS = (-1, 0, 0, 0, 2)
CROSSING = ((2, 1), (3, 1))


def branching_tree() -> Any:
    def link(index: int) -> str:
        carried = "".join(link(child) for child, parent in enumerate(PARENTS) if parent == index)
        place = "0 0 0" if index == 0 else "1 0 0"
        return (
            f'<body name="link {index}" pos="{place}"><joint axis="0 0 1"/>'
            f'<inertial pos="0.5 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>{carried}</body>'
        )

    loops = "".join(f'<connect body1="link {a}" body2="link {b}" anchor="1 0 0"/>' for a, b in CROSSING)
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option gravity="0 -9.81 0"><flag contact="disable"/></option>'
        f"<worldbody>{link(0)}</worldbody><equality>{loops}</equality></mujoco>"
    )


def disagreement(model: Any, states: int = 5) -> float:
    """The largest relative difference of accelerations in the model's own state and random ones."""
    random, worst, pairs = np.random.default_rng(0), 0.0, []
    for kind in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE):
        own = copy.copy(model)
        own.opt.jacobian, own.opt.tolerance = kind, min(model.opt.tolerance, 1e-20)
        pairs.append((own, mujoco.MjData(own)))
    for state in range(states):
        step, rates = random.normal(size=(2, model.nv)) * [[SPREAD * (state > 0)], [1.0]]
        for own, data in pairs:
            mujoco.mj_resetData(own, data)
            mujoco.mj_integratePos(own, data.qpos, step, 1.0)
            data.qvel[:] = rates
            mujoco.mj_forward(own, data)
        dense, sparse = (data.qacc for _, data in pairs)
        worst = max(worst, float(np.abs(dense - sparse).max() / np.abs(dense).max()))
    return worst


def test_this_release_has_the_same_accelerations_dense_and_sparse() -> None:
    own = adapter.TUNED.model(scene("person_two_feet").mechanism(), 1e-3).compiled
    assert max(map(disagreement, (branching_tree(), own))) < AGREEMENT
