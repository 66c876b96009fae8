"""Tests of properties of MuJoCo that the adapter needs: time constants, impedance, friction."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import Shipped

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
