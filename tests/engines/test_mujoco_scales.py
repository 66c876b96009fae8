"""Arms of a tenth of a micrometre, wheels as large as a town, and bodies of no weight, in MuJoCo extended."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np

from engines.mujoco import DEFAULT, EXTENDED
from reference.forces import Spring, Torque
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reports.search.mechanisms import mechanism as drawn
from reports.search.parts import EVERY


def test_a_spring_at_an_arm_of_a_tenth_of_a_micrometre_turns_its_body() -> None:
    """MuJoCo takes a site within 1e-6 m for its body's origin when it compiles, so that there is no arm."""
    text = """<mujoco><worldbody><body><joint type="hinge" axis="0 0 1"/><inertial pos="0 0 0" mass="1"
        diaginertia="1 1 1"/><site pos="0 {} 0"/></body></worldbody></mujoco>"""
    as_compiled = [mujoco.MjModel.from_xml_string(text.format(arm)).site_sameframe[0] for arm in (0.99e-6, 1.01e-6)]
    assert as_compiled == [mujoco.mjtSameFrame.mjSAMEFRAME_BODY, mujoco.mjtSameFrame.mjSAMEFRAME_BODYROT]

    pin = Pin("pin", None, "body", (0.0, 0.0), (0.0, 0.0))
    spring = Spring("spring", None, "body", (1.0, 0.0), (0.0, 1e-7), 1.0, 0.0)
    mechanism = Mechanism((Body("body", 1.0, 1e-7, (0.0, 0.0, 0.0)),), (pin,), (0.0, 0.0), (spring,))
    for engine in (DEFAULT, EXTENDED):
        data = engine.build(mechanism, 1e-3).data
        assert abs(data.qacc[0] + 1.0) < 1e-12  # 1 N at 1e-7 m of 1e-7 kg m^2, backwards


def test_a_drive_of_wheels_as_large_as_a_town_is_no_softer_than_that_of_small_ones() -> None:
    """Its row's inverse inertia is so small a number of 1 / (kg m^2) that MuJoCo would not take its compliance."""
    missed = []
    for size in (1.0, 1e6):
        bodies = tuple(
            Body(name, 1.0, inertia * size**2, (place * size, 0.0, 0.0), (0.0, 0.0, rate))
            for name, inertia, place, rate in (("large", 1.0, 0.0, -1.0), ("small", 1e-3, 3.0, -3.0))
        )
        pin = Pin("pin", None, "large", (-0.5 * size, 0.0), (-0.5 * size, 0.0))
        bodies = (replace(bodies[0], twist=(0.0, -0.5 * size, -1.0)), bodies[1])
        drive = Drive("drive", "large", "small", -2.0, 0.0)
        torque = Torque("torque", "small", "large", -10.0 * size**2)
        run = EXTENDED.build(Mechanism(bodies, (pin, drive), (0.0, 0.0), (torque,)), 1e-3)(10, 10)
        missed.append(np.abs(run.pose[:, 1, 2] - run.pose[:, 0, 2] + 2.0 * run.t).max())
    assert missed[0] < 1e-10
    assert missed[1] < 1e-10


def test_extended_begins_with_accelerations_of_light_bodies_that_are_solved() -> None:
    """From nothing Newton's method ends where it sees its cost no longer fall: 1e-5 of the light body's are missed."""
    mechanism = drawn(1199539626, 2, EVERY, 4)
    dt = 0.01 * mechanism.time_scale
    run, once = EXTENDED.build(mechanism, dt), EXTENDED.model(mechanism, dt)
    first = once.start().qacc.copy()
    with run.model.hooked():
        mujoco.mj_forward(run.model.compiled, run.data)
    solved = run.data.qacc.copy()
    run.data.qacc_warmstart[:] = solved
    with run.model.hooked():
        mujoco.mj_forward(run.model.compiled, run.data)
    assert np.abs(first - run.data.qacc).max() > 1e-7 * np.abs(first).max()
    assert np.abs(solved - run.data.qacc).max() < 1e-12 * np.abs(first).max()
