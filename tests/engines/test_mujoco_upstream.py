"""Tests of properties of MuJoCo that the adapter needs: time constants, impedance, friction, sparse factorisation."""

from __future__ import annotations

import copy
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import TUNED, Shipped
from reference.scenes.catalogue import scene

EQUALITY_AND_CONTACT = """
<mujoco>
  <option timestep="1e-3" integrator="{integrator}"><flag refsafe="{refsafe}"/></option>
  <worldbody>
    <geom name="ground" type="plane" size="1 1 1"/>
    <body pos="0 0 0.0999"><joint type="slide" axis="0 0 1"/><geom name="ball" size="0.1"/></body>
    <body name="held" pos="3 0 1"><joint type="slide" axis="0 0 1"/><geom size="0.1" conaffinity="0"/></body>
  </worldbody>
  <contact><pair geom1="ground" geom2="ball" solref="{constant} 1" solimp="0.9 0.9 0.001"/></contact>
  <equality>
    <connect body1="world" body2="held" anchor="3 0 1" solref="{constant} 1" solimp="{impedance}"/>
  </equality>
</mujoco>
"""


def one_of_each(
    integrator="Euler", refsafe="enable", constant=0.02, impedance="0.9 0.9 0.001", gap=0.0
) -> tuple[Any, Any]:
    """MuJoCo's parameters `efc_KBIP` (stiffness, damping, impedance) for the rows of an equality and of a contact."""
    text = EQUALITY_AND_CONTACT.format(integrator=integrator, refsafe=refsafe, constant=constant, impedance=impedance)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qpos[1] = gap
    mujoco.mj_forward(model, data)
    equality = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return data.efc_KBIP[equality], data.efc_KBIP[~equality]


@pytest.mark.parametrize("integrator", ["Euler", "RK4", "implicit", "implicitfast", "discrete"])
def test_upstream_the_smallest_time_constants_of_equalities_and_contacts(integrator: str) -> None:
    for refsafe in ("enable", "disable"):
        of_equality = of_contact = 2e-3
        if integrator == "discrete":
            of_equality, of_contact = 1e-4, 1e-3 / 0.9**0.5  # The stiffness of the contact is 1 / dt^2.
        if refsafe == "disable":
            of_equality = of_contact = 1e-4
        # The damping of a row is 2 / (dmax timeconst).
        for rows, wanted in zip(one_of_each(integrator, refsafe, 1e-4), (of_equality, of_contact), strict=True):
            assert len(rows)
            assert 2 / 0.9 / rows[:, 1] == pytest.approx(wanted)


def test_upstream_the_default_impedance_grows_with_the_gap_from_nine_tenths() -> None:
    impedance = " ".join(map(str, Shipped().impedance))
    grown = [one_of_each(impedance=impedance, gap=gap)[0][:, 2].max() for gap in (0.0, 5e-4, 1e-3, 1e-2)]
    assert grown == pytest.approx([0.9, 0.925, 0.95, 0.95])


@pytest.mark.parametrize(("cone", "rates"), [("pyramidal", {20.0}), ("elliptic", {20.0, 500.0})])
def test_upstream_friction_has_a_rate_of_its_own_in_the_elliptic_cone_only(cone: str, rates: set[float]) -> None:
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option cone="{cone}"/><worldbody>
        <geom name="ground" type="plane" size="1 1 1"/>
        <body pos="0 0 0.0999"><freejoint/><geom name="ball" size="0.1"/></body></worldbody><contact>
        <pair geom1="ground" geom2="ball" condim="3" solref="-100 -20" solreffriction="-1e-9 -500"/>
        </contact></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    # MuJoCo divides both damping constants by dmax. The default of dmax is 0.95.
    assert set(np.round(data.efc_KBIP[:, 1] * 0.95, 9)) == rates


# For some trees with branches, the Newton solver of release 4.0.0 computed wrong accelerations without a warning. The
# sparse Cholesky factor of the Hessian was wrong (changelog of 4.0.1, github.com/google-deepmind/mujoco/issues/3767).

# Largest difference of dense and sparse accelerations due to rounding, relative to the largest acceleration.
AGREEMENT = 1e-8
STATE_SPREAD = (
    0.3  # Distance of the random states from the initial state [rad or m], so that no symmetry hides an error.
)
# The smallest tree with the error in 4.0.0 has five links and two loops. Three links are at the tip of the first link.
PARENTS = (-1, 0, 0, 0, 2)
CROSSING = ((2, 1), (3, 1))


def branching_tree() -> Any:
    def link(index: int) -> str:
        carried = "".join(link(child) for child, parent in enumerate(PARENTS) if parent == index)
        position = "0 0 0" if index == 0 else "1 0 0"
        return (
            f'<body name="link {index}" pos="{position}"><joint axis="0 0 1"/>'
            f'<inertial pos="0.5 0 0" mass="1" diaginertia="0.1 0.1 0.1"/>{carried}</body>'
        )

    loops = "".join(f'<connect body1="link {a}" body2="link {b}" anchor="1 0 0"/>' for a, b in CROSSING)
    return mujoco.MjModel.from_xml_string(
        '<mujoco><option gravity="0 -9.81 0"><flag contact="disable"/></option>'
        f"<worldbody>{link(0)}</worldbody><equality>{loops}</equality></mujoco>"
    )


def disagreement(model: Any, states: int = 5) -> float:
    """The largest relative difference of dense and sparse accelerations in the initial state and in random states."""
    random, worst, pairs = np.random.default_rng(0), 0.0, []
    for kind in (mujoco.mjtJacobian.mjJAC_DENSE, mujoco.mjtJacobian.mjJAC_SPARSE):
        changed = copy.copy(model)
        changed.opt.jacobian, changed.opt.tolerance = kind, min(model.opt.tolerance, 1e-20)
        pairs.append((changed, mujoco.MjData(changed)))
    for state in range(states):
        step, rates = random.normal(size=(2, model.nv)) * [[STATE_SPREAD * (state > 0)], [1.0]]
        for changed, data in pairs:
            mujoco.mj_resetData(changed, data)
            mujoco.mj_integratePos(changed, data.qpos, step, 1.0)
            data.qvel[:] = rates
            mujoco.mj_forward(changed, data)
        dense, sparse = (data.qacc for _, data in pairs)
        worst = max(worst, float(np.abs(dense - sparse).max() / np.abs(dense).max()))
    return worst


def test_this_release_has_the_same_accelerations_dense_and_sparse() -> None:
    person = TUNED.model(scene("person_two_feet").mechanism(), 1e-3).compiled
    assert max(map(disagreement, (branching_tree(), person))) < AGREEMENT
