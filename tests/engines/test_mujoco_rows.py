"""Tests that user rows in MuJoCo agree with the rows of the mechanism, with and without numba."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import EXTENDED, Shipped
from engines.mujoco.builder import UserRowJoint
from engines.mujoco.user_rows import RowWriter
from engines.rolling_table import rolled
from engines.tree import spanning_tree
from reference.joints import Joint, Pin, Rod, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import SlottedLever
from reference.scenes.wheels.vehicles import Cart
from tests import ROOT
from tests.mechanisms import bar

CHAPLYGIN_SLEIGH = ChaplyginSleigh()
STIFFNESS, DAMPING = 5.0, 3.0


def jumble() -> Mechanism:
    """A mechanism with an arm, a block that slides in the arm, a bar on the block, a free body, and skates."""
    bodies = (
        bar("arm", (0.0, 0.0), (1.0, 0.4)),
        Body("block", 0.7, 0.05, (0.5, 0.2, 0.3)),
        bar("tail", (0.5, 0.2), (0.9, -0.5)),
        Body("flyer", 1.1, 0.2, (2.0, 1.0, -0.4)),
    )
    half = bodies[0].mass / 2
    joints: tuple[Joint, ...] = (
        Pin("A", None, "arm", (0.0, 0.0), (-half, 0.0)),
        Slot("slot", "arm", "block", (0.0, 0.0), 0.0, (0.0, 0.0)),
        Pin("B", "block", "tail", (0.0, 0.0), (-bodies[2].mass / 2, 0.0)),
        Skate("tail skate", None, "tail", (0.1, 0.05), 0.3),
        Skate("arm skate", None, "arm", (-half, 0.0), 0.2),
        Skate("between", "tail", "flyer", (0.3, -0.2), -0.5),
        Skate("other", "flyer", "block", (0.2, 0.1), 1.5),
    )
    return Mechanism(bodies, joints, (0.0, -9.81))


# A slot and rods between bodies that are not neighbours in the tree.
CROSS = Slot("cross", "tail", "flyer", (0.1, 0.2), 0.4, (0.3, -0.1))
RODS = (
    Rod("rod", "block", "flyer", (0.1, 0.0), (-0.2, 0.3), 0.5),
    Rod("stay", None, "tail", (3.0, 1.0), (0.1, 0.2), 2.0),
)


def written(joint: Any) -> UserRowJoint:
    ends = joint.first, joint.second
    match joint:
        case Skate():
            return UserRowJoint("skate", *ends, (*joint.second_point, joint.angle, DAMPING))
        case Slot():
            numbers = (*joint.first_point, *joint.second_point, joint.line_angle, STIFFNESS, DAMPING)
            return UserRowJoint("slot", *ends, numbers)
        case _:
            numbers = (*joint.first_point, *joint.second_point, joint.length, STIFFNESS, DAMPING)
            return UserRowJoint("rod", *ends, numbers)


def test_user_rows_are_the_rows_of_the_mechanism_in_tree_coordinates() -> None:
    mechanism, random = jumble(), np.random.default_rng(0)
    tree = spanning_tree(mechanism)
    assert [link.kind for link in tree.links] == ["hinge", "slot", "hinge", "free"]
    assert tree.loops == ()
    joints = [*(joint for joint in mechanism.joints if isinstance(joint, Skate)), CROSS, *RODS]
    ahead = 0.01
    late, writer = (RowWriter(tree, range(tree.coordinates), list(map(written, joints)), 0, by) for by in (ahead, 0.0))
    for _ in range(5):
        q, v, a = random.normal(size=(3, tree.coordinates))
        jacobian, right = writer.rows(q, v)
        for predicted, expected in zip(late.rows(q - ahead * v, v), (jacobian, right), strict=True):
            assert np.abs(predicted - expected).max() < 1e-12 * np.abs(expected).max()
        index = dict(zip((None, *(body.name for body in mechanism.bodies)), range(5), strict=True))
        # The first body is the ground.
        pose, twist, change = (np.vstack([np.zeros(3), values[0]]) for values in tree.motion(q[None], v[None], a[None]))
        # The mechanism's rows are in maximal coordinates. A complex step computes the time derivatives of these rows.
        for row, joint in enumerate(joints):
            ends = [index[joint.first], index[joint.second]]
            poses, twists, velocity, step = pose[ends], twist[ends], twist[ends].ravel(), 1e-100
            line = joint.rows(*poses)[0]
            line_rate = joint.rows(*(poses + 1j * step * twists))[0].imag / step
            slip = line @ velocity
            wanted = -line_rate @ velocity - DAMPING * slip
            if not isinstance(joint, Skate):
                wanted -= STIFFNESS * joint.gap(*poses, 0.0)[0]
            assert jacobian[row] @ v == pytest.approx(slip, rel=1e-12, abs=1e-12)
            # The residual J a - right is equal in both kinds of coordinates. Accelerations of bodies contain velocity
            # terms.
            expected = line @ change[ends].ravel() - wanted
            assert jacobian[row] @ a - right[row] == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_user_rows_of_a_roll_are_those_of_the_joint_with_its_velocity_term() -> None:
    gears = EllipticGears()
    roll = next(joint for joint in gears.mechanism().joints if isinstance(joint, Roll))
    mechanism = Mechanism(gears.mechanism().bodies, (roll,))
    joint = UserRowJoint("roll", roll.first, roll.second, (100.0, 20.0), rolled(roll.rolling))
    writer = RowWriter(spanning_tree(mechanism), range(6), [joint])
    pose, twist, _ = gears.placement(np.linspace(0.0, 1.7, 12))
    # The joint's rows are along e_t and e_n, and the user rows are along x and y.
    contact = roll.rolling.contact(pose[:, 1, 2] - pose[:, 0, 2])
    angle = contact.tangent_angle + pose[:, 0, 2]
    for i in range(len(pose)):
        ours, right = writer.rows((pose[i] - mechanism.pose).ravel(), twist[i].ravel())
        basis = np.array([[np.cos(angle[i]), np.sin(angle[i])], [np.sin(angle[i]), -np.cos(angle[i])]])
        # The exact motion has no gap and no slip. So the springs add only rounding times their stiffness of 100 / s^2.
        assert np.abs(basis @ ours - mechanism.rows(pose[i])).max() < 1e-13
        assert np.abs(basis @ right - mechanism.bias(pose[i], twist[i])).max() < 1e-11


def moved() -> list[list[Any]]:
    """Motions with rows of each kind, and a motion that diverges."""
    scenes = Cart(), RollingEllipse(), SlottedLever()
    motions = [EXTENDED.build(scene.mechanism(), 1e-3)(2, 10) for scene in scenes]
    wild = Body("sleigh", 1.0, 1.0, (0.0, 0.0, 0.0), (9e4, 0.0, 9e4))
    skate = Skate("skate", None, "sleigh", (0.0, 0.0))
    motions.append(EXTENDED.build(Mechanism((wild,), (skate,)), 0.1)(5, 10))
    return [[run.pose.tolist(), run.reaction.tolist(), run.reset_at, run.warnings] for run in motions]


WITHOUT_NUMBA = """
import json, sys
sys.modules["numba"] = None
from tests.engines.test_mujoco_rows import moved
print(json.dumps(moved()))
"""


def test_without_numba_python_writes_the_same_rows() -> None:
    command = [sys.executable, "-c", WITHOUT_NUMBA]
    plain = json.loads(subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout)
    fast = moved()
    for (pose, reaction, reset, warnings), same in zip(fast, plain, strict=True):
        # The results with and without numba differ by one or two roundings.
        np.testing.assert_allclose(pose, same[0], rtol=0, atol=1e-13)
        np.testing.assert_allclose(reaction, same[1], rtol=0, atol=1e-11 * np.nanmax(np.abs(reaction)))
        assert [reset, list(warnings)] == same[2:]
    assert fast[-1][2] is not None


def test_the_previous_callback_is_restored_after_a_failure() -> None:
    run = EXTENDED.build(CHAPLYGIN_SLEIGH.mechanism(), 1e-2)
    with pytest.raises(RuntimeError, match="on purpose"), run.model.callback_installed():  # noqa: PT012
        assert mujoco.get_mjcb_control() is not None
        raise RuntimeError("on purpose")
    assert mujoco.get_mjcb_control() is None
    run(2, 1)
    assert mujoco.get_mjcb_control() is None


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
