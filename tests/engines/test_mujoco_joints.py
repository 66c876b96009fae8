"""Tests of rolls, skates and drives in MuJoCo as contacts, tendons and user rows, and tests of extreme scales.

`test_matrix` tests the order and the error of each construction.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
import pytest

from engines import NotDeclared
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.methods import ROLLS, SKATES
from reference.forces import Spring, Torque
from reference.joints import Drive, Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Placed, Ring, Side
from reference.rolling.kinematics import Rolling
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingDisc, RollingDownhill, RollingEllipse, RollingOnCircle
from reference.scenes.skates import ChaplyginSleigh
from reference.trajectory import Trajectory
from reports.search.mechanisms import mechanism as drawn
from reports.search.parts import ALL_KINDS
from tests.engines.test_matrix import SOFT
from tests.mechanisms import rolling_disc

ELLIPSE, DISC = RollingEllipse(), RollingDisc()
(EULER,) = ROLLS
CHAPLYGIN_SLEIGH = ChaplyginSleigh()
(BLADE,) = SKATES


def run(engine: MuJoCo, scene: Any, dt: float) -> tuple[Trajectory, Trajectory]:
    every = max(1, round(scene.spacing / dt))
    motion = engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)
    return motion, scene.motion(motion.t)


def disc_in_ring(clearance: float, rate: float = 1.0) -> Mechanism:
    """A disc that turns steadily in a ring without gravity. clearance: relative difference of the radii."""
    rolling = Rolling.at_angle(Circle(1 - clearance), Placed(Ring(1.0), turn=-math.pi / 2))
    disc, roll = rolling_disc(rolling, rate)
    return Mechanism((disc,), (roll,), (0.0, 0.0))


@pytest.mark.parametrize("engine", [DEFAULT, TUNED], ids=lambda engine: engine.variant)
def test_reactions_by_newtons_law_are_the_contact_forces(engine: MuJoCo) -> None:
    built = engine.build(RollingDownhill().mechanism(), 1e-3)
    motion = built(3, 10)
    force = np.zeros(6)  # In the frame of the contact. The first component is normal, from the ground to the body.
    mujoco.mj_contactForce(built.model.compiled, built.data, 0, force)
    tangent, normal = motion.reaction[-1]
    # `data` has the state of the last sample. A slip of 1e-3 m changes directions by 1e-3 rad.
    assert normal == pytest.approx(force[0], rel=5e-3)
    assert abs(tangent) == pytest.approx(float(np.hypot(force[1], force[2])), abs=5e-3 * normal)


def test_a_contact_differs_from_ideal_rolling_only_after_the_hop() -> None:
    hill = RollingOnCircle()
    assert hill.hop is not None
    motion, truth = run(TUNED, hill, dt=1e-3)
    error = np.abs(motion.pose - truth.pose)[:, 0, :2].max(axis=1)
    # In MuJoCo, friction at a vanishing normal force prolongs the contact of the body by about 0.06 s.
    assert error[motion.t < hill.hop].max() < 2e-3
    assert error[-1] > 0.05
    assert any("was lost" in warning for warning in motion.warnings)
    ideal, truth = run(EXTENDED, hill, dt=1e-3)
    assert np.abs(ideal.pose - truth.pose).max() < 1e-8
    assert ideal.warnings == ()


def test_a_nearly_conformal_contact_causes_a_warning_above_a_tenth_of_a_radian_in_a_step() -> None:
    for step, error, doubted in ((2e-4, 1e-8, False), (5e-4, 1e-6, False), (4e-3, 1e-2, True)):
        motion = EXTENDED.build(disc_in_ring(0.01), step)(20, round(0.02 / step))
        assert np.abs(motion.pose[:, 0, 2] - motion.t).max() < error
        assert any("along its curves" in warning for warning in motion.warnings) == doubted
    wrong = EXTENDED.build(disc_in_ring(1e-4), 2e-3)(20, 10)
    assert any("along its curves" in warning for warning in wrong.warnings)
    assert not np.abs(wrong.pose[:, 0, 2] - wrong.t).max() < 1e-2


def test_a_body_that_reaches_a_corner_ends_the_run() -> None:
    rolling = Rolling.at_angle(Circle(0.1), Placed(Side(0.08), turn=math.pi))
    disc, roll = rolling_disc(rolling, 4.0)
    motion = EXTENDED.build(Mechanism((disc,), (roll,)), 1e-3)(12, 10)
    # At 4 rad/s the disc reaches the end of the side after 0.1 s. The distance is 0.04 m.
    assert motion.reset_at == pytest.approx(0.1, abs=2e-3)
    assert np.all(np.isfinite(motion.pose[motion.t < 0.095]))
    assert np.all(np.isnan(motion.pose[motion.t > 0.105]))


# Skates and slots


@pytest.mark.parametrize(("mass", "length"), [(1.0, 1.0), (1e5, 1.0), (1.0, 1e-3)])
def test_a_blade_touches_the_ground_at_one_end_for_any_weight(mass: float, length: float) -> None:
    """If the blade touched the ground at two points, it could not turn."""
    sled = Body("sled", 1.0, 0.1 * length**2, (0.0, 0.0, 0.0))
    load = Body("load", mass, 0.1 * mass, (0.0, 2 * length, 0.0))
    mechanism = Mechanism((sled, load), (Skate("blade", None, "sled", (0.0, length), 0.0),))
    data = DEFAULT.model(mechanism, 1e-2).start()
    assert data.ncon == 1
    assert data.contact.pos[0, :2] == pytest.approx((0.0, length), abs=1e-12 * length)
    assert data.efc_force[0] == pytest.approx(9.81 * data.model.body_mass.sum(), rel=1e-9)


def test_the_slip_of_a_user_row_agrees_with_its_declared_regularisation():
    engine, mechanism = SOFT, CHAPLYGIN_SLEIGH.mechanism()
    soft = engine.regularisation(mechanism, 1e-3)
    assert soft is not None
    motion = engine.build(mechanism, 1e-3)(CHAPLYGIN_SLEIGH.samples, 10)
    rows = mechanism.rows(mechanism.pose)
    inverse = float(((rows / mechanism.inertias.reshape(-1)) @ rows.T)[0, 0])
    # The slip satisfies slip' + damping slip = compliance A F. The force varies, so slip reaches only half of its
    # limit.
    limit = soft.compliance * inverse * np.abs(motion.reaction).max() / soft.damping
    assert 0.3 * limit < np.abs(mechanism.slip(motion.pose, motion.twist)).max() < limit


# Extreme scales


def test_a_spring_at_an_arm_of_a_tenth_of_a_micrometre_turns_its_body() -> None:
    """If a site is within 1e-6 m of the origin of its body, MuJoCo's compiler moves the site to the origin."""
    text = """<mujoco><worldbody><body><joint type="hinge" axis="0 0 1"/><inertial pos="0 0 0" mass="1"
        diaginertia="1 1 1"/><site pos="0 {} 0"/></body></worldbody></mujoco>"""
    as_compiled = [mujoco.MjModel.from_xml_string(text.format(arm)).site_sameframe[0] for arm in (0.99e-6, 1.01e-6)]
    assert as_compiled == [mujoco.mjtSameFrame.mjSAMEFRAME_BODY, mujoco.mjtSameFrame.mjSAMEFRAME_BODYROT]

    pin = Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0))
    spring = Spring("spring", None, "body", (1.0, 0.0), (0.0, 1e-7), 1.0, 0.0)
    mechanism = Mechanism((Body("body", 1.0, 1e-7, (0.0, 0.0, 0.0)),), (pin,), (0.0, 0.0), (spring,))
    for engine in (DEFAULT, EXTENDED):
        data = engine.build(mechanism, 1e-3).data
        assert abs(data.qacc[0] + 1.0) < 1e-12  # -1 N * 1e-7 m / (1e-7 kg m^2)


def test_the_compliance_of_a_drive_does_not_depend_on_the_size_of_the_wheels() -> None:
    """In SI units the row's inverse inertia would be so small that MuJoCo would use a larger compliance."""
    missed = []
    for size in (1.0, 1e6):
        bodies = tuple(
            Body(name, 1.0, inertia * size**2, (x * size, 0.0, 0.0), (0.0, 0.0, rate))
            for name, inertia, x, rate in (("large", 1.0, 0.0, -1.0), ("small", 1e-3, 3.0, -3.0))
        )
        pin = Pin("pin", None, "large", (-0.5 * size, 0.0), (-0.5 * size, 0.0))
        bodies = (replace(bodies[0], twist=(0.0, -0.5 * size, -1.0)), bodies[1])
        drive = Drive("drive", "large", "small", -2.0, 0.0)
        torque = Torque("torque", "small", "large", -10.0 * size**2)
        run = EXTENDED.build(Mechanism(bodies, (pin, drive), (0.0, 0.0), (torque,)), 1e-3)(10, 10)
        missed.append(np.abs(run.pose[:, 1, 2] - run.pose[:, 0, 2] + 2.0 * run.t).max())
    assert missed[0] < 1e-10
    assert missed[1] < 1e-10


def test_the_first_accelerations_of_light_bodies_are_converged_in_extended() -> None:
    """If Newton's method starts at zero, it ends with a relative error of 1e-5 for light bodies."""
    mechanism = drawn(1199539626, 2, ALL_KINDS, 4)
    dt = 0.01 * mechanism.time_scale
    run, once = EXTENDED.build(mechanism, dt), EXTENDED.model(mechanism, dt)
    first = once.start().qacc.copy()
    with run.model.callback_installed():
        mujoco.mj_forward(run.model.compiled, run.data)
    solved = run.data.qacc.copy()
    run.data.qacc_warmstart[:] = solved
    with run.model.callback_installed():
        mujoco.mj_forward(run.model.compiled, run.data)
    assert np.abs(first - run.data.qacc).max() > 1e-7 * np.abs(first).max()
    assert np.abs(solved - run.data.qacc).max() < 1e-12 * np.abs(first).max()


def test_dependent_rows_of_a_joint_declare_no_law_of_an_instant() -> None:
    """Both wheels turn on fixed pins, so one of the two rows of their contact is zero."""
    mechanism = EllipticGears().mechanism()
    answer = EXTENDED.instants(mechanism, 1e-3 * mechanism.time_scale, 2)
    assert answer == NotDeclared("the rows of joint 'mesh' depend on one another in the coordinates of the tree")
